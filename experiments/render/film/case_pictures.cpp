#include "experiments/render/film/case_pictures.hpp"

#include "experiments/render/picture/figure.hpp"
#include "experiments/report/chart/wording.hpp"

namespace taut {

namespace {

Image panel(const TitledCase& titled, const Store& store) {
  const Case one = make_case(titled.spec);
  RecordedRun run = recorded_run(*one.scene, store.motion(one.key));
  run.title = titled.title;
  run.settings = report::brief_settings(one.choice);
  run.colour = kInk;
  const PageLayout layout = PageLayout::page(800, 720, 1);
  SceneRendererOptions look;
  look.width = layout.panel_width;
  look.height = layout.panel_height;
  look.quality = RenderQuality::video();
  look.from = look.to = one.scene->duration();
  const std::vector<RecordedRun> runs{std::move(run)};
  return compose(SceneRenderer(*one.scene, runs, look), layout, {one.scene->duration()});
}

}  // namespace

void draw_side_by_side(const std::vector<TitledCase>& cases, const Store& store,
                       const std::filesystem::path& file) {
  std::vector<Image> panels;
  int width = 0;
  for (const TitledCase& one : cases) {
    panels.push_back(panel(one, store));
    width += panels.back().width();
  }
  Image all(width, panels.front().height());
  int left = 0;
  for (const Image& one : panels) {
    all.paste(one, left, 0);
    left += one.width();
  }
  write_png(file, all);
}

}  // namespace taut
