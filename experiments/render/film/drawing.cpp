#include "experiments/render/film/drawing.hpp"

#include "core/model/text.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/render/picture/media.hpp"

namespace taut {

namespace {

namespace fs = std::filesystem;

using Progress = std::function<void(std::size_t done, std::size_t all)>;

SceneRendererOptions look_of(const Drawing& drawing, const RenderQuality& quality, int width,
                             int height) {
  SceneRendererOptions look;
  look.width = width;
  look.height = height;
  look.theme = drawing.dark ? Theme::dark() : Theme::paper();
  look.quality = drawing.quality.value_or(quality);
  look.view = drawing.view;
  look.colour_by = drawing.colour_by;
  look.range = drawing.range / ColourScale{look.colour_by}.shown();
  return look;
}

Drawn draw_stills(const RunSet& set, const Drawing& drawing, const fs::path& out,
                  const Progress& progress) {
  const auto [width, height] = drawing.size.value_or(std::pair(1920, 1080));
  const auto layout = PageLayout::page(width, height, static_cast<int>(set.runs.size()));
  SceneRendererOptions look =
      look_of(drawing, RenderQuality::still(), layout.panel_width, layout.panel_height);
  look.frame = FitRegion::beside_inset();
  look.from = drawing.times.front();
  look.to = drawing.times.back();
  const SceneRenderer renderer(set.scene, set.runs, look);
  Drawn drawn;
  for (const double time : drawing.times) {
    fs::path file = out;
    if (drawing.times.size() > 1)
      file.replace_filename(out.stem().string() + "-t" + decimal(time, 2) +
                            out.extension().string());
    write_png(file, compose(renderer, layout, {time}));
    drawn.files.push_back(file.string());
    progress(drawn.files.size(), drawing.times.size());
  }
  return drawn;
}

Drawn draw_sheet(const RunSet& set, const Drawing& drawing, const fs::path& out) {
  const auto [width, height] = drawing.size.value_or(std::pair(480, 400));
  SceneRendererOptions look = look_of(drawing, RenderQuality::video(), width, height);
  look.from = drawing.times.front();
  look.to = drawing.times.back();
  const SceneRenderer renderer(set.scene, set.runs, look);
  const auto layout = PageLayout::sheet(width, height, static_cast<int>(set.runs.size()),
                                        static_cast<int>(drawing.times.size()));
  write_png(out, compose(renderer, layout, drawing.times));
  return {{out.string()}, ""};
}

Drawn draw_video(const RunSet& set, const Drawing& drawing, const fs::path& out,
                 const Progress& progress) {
  const auto [width, height] = drawing.size.value_or(std::pair(1280, 720));
  const auto layout = PageLayout::page(width, height, static_cast<int>(set.runs.size()));
  SceneRendererOptions look =
      look_of(drawing, RenderQuality::video(), layout.panel_width, layout.panel_height);
  look.frame = FitRegion::beside_inset();
  const SceneRenderer renderer(set.scene, set.runs, look);
  const auto times = frame_times(set.scene, set.runs, 1.0 / 30, set.scene.duration());
  const std::string why = write_video(out, renderer, layout, times, 1, 22, progress);
  if (why.empty()) return {{out.string()}, ""};
  fs::path poster = out;
  write_png(poster.replace_extension(".png"), compose(renderer, layout, {set.scene.duration()}));
  return {{poster.string()}, why};
}

}  // namespace

Drawn draw(const RunSet& set, const Drawing& drawing, const fs::path& file,
           const Progress& progress) {
  switch (drawing.kind) {
    case Drawing::Kind::sheet:
      return draw_sheet(set, drawing, file);
    case Drawing::Kind::video:
      return draw_video(set, drawing, file, progress);
    case Drawing::Kind::stills:
      break;
  }
  return draw_stills(set, drawing, file, progress);
}

}  // namespace taut
