#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/render/image/video.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/text.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut::verb::render {

namespace {

namespace fs = std::filesystem;

struct Options {
  RunRequest what;
  std::vector<std::string> at;
  std::string duration, dt, view = "three-quarter", colour = "strain", output;
  std::string size, quality;
  double range = 0;
  bool sheet = false, video = false, dark = false, json = false;
};

std::pair<int, int> parse_size(const std::string& text) {
  int width = 0, height = 0;
  char end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &end) != 2 || width < 320 ||
      height < 240 || width > 7680 || height > 4320 || width % 2 != 0 || height % 2 != 0)
    throw InputError("--size '" + text + "': WIDTHxHEIGHT, even, 320x240 to 7680x4320");
  return {width, height};
}

RenderQuality parse_quality(const std::string& name) {
  if (name == "draft") return RenderQuality::draft();
  if (name == "video") return RenderQuality::video();
  return RenderQuality::still();
}

SceneRendererOptions look_of(const Options& options, const std::string& quality, int width,
                             int height) {
  SceneRendererOptions look;
  look.width = width, look.height = height;
  look.theme = options.dark ? Theme::dark() : Theme::paper();
  look.quality = parse_quality(options.quality.empty() ? quality : options.quality);
  look.view = parse_view(options.view);
  look.colour_by = parse_colour_by(options.colour);
  look.range = options.range / ColourScale{look.colour_by}.shown();
  return look;
}

using Files = std::vector<std::string>;

/// Files of several moments get the time into their names: ball-t0.50.png.
Files draw_stills(const Options& options, const RunSet& set, const std::vector<double>& times,
                  const fs::path& out) {
  const auto [width, height] = parse_size(options.size.empty() ? "1920x1080" : options.size);
  const auto layout = PageLayout::page(width, height, static_cast<int>(set.runs.size()));
  SceneRendererOptions look = look_of(options, "still", layout.panel_width, layout.panel_height);
  look.frame = FitRegion::beside_inset();
  look.from = times.front(), look.to = times.back();
  const SceneRenderer renderer(set.scene, set.runs, look);
  const Countdown countdown("still");
  Files files;
  for (std::size_t k = 0; k < times.size(); ++k) {
    fs::path file = out;
    if (times.size() > 1)
      file.replace_filename(out.stem().string() + formatted("-t%.2f", times[k]) +
                            out.extension().string());
    write_png(file, compose(renderer, layout, {times[k]}));
    countdown(k + 1, times.size());
    files.push_back(file.string());
  }
  return files;
}

Files draw_sheet(const Options& options, const RunSet& set, const std::vector<double>& times,
                 const fs::path& out) {
  const auto [width, height] = parse_size(options.size.empty() ? "480x400" : options.size);
  SceneRendererOptions look = look_of(options, "video", width, height);
  look.from = times.front(), look.to = times.back();
  const SceneRenderer renderer(set.scene, set.runs, look);
  const auto layout = PageLayout::sheet(width, height, static_cast<int>(set.runs.size()),
                                        static_cast<int>(times.size()));
  write_png(out, compose(renderer, layout, times));
  return {out.string()};
}

/// Without ffmpeg: a picture of the last frame.
Files draw_video(const Options& options, const RunSet& set, const fs::path& out) {
  const auto [width, height] = parse_size(options.size.empty() ? "1280x720" : options.size);
  const auto layout = PageLayout::page(width, height, static_cast<int>(set.runs.size()));
  SceneRendererOptions look = look_of(options, "video", layout.panel_width, layout.panel_height);
  look.frame = FitRegion::beside_inset();
  const SceneRenderer renderer(set.scene, set.runs, look);
  const double dt = set.scene.dt;
  const int stride = std::max(1, static_cast<int>(1 / (30 * dt) + 0.5));
  const int frames = set.scene.steps / stride + 1;
  VideoWriter video(out, {width, height, frame_rate(stride * dt), 22});
  const Countdown countdown("frame");
  for (int k = 0; k < frames && video.write(compose(renderer, layout, {k * stride * dt})); ++k)
    countdown(static_cast<std::size_t>(k) + 1, static_cast<std::size_t>(frames));
  const std::string why = video.finish();
  if (why.empty()) return {out.string()};
  std::cerr << printable(out.string()) << ": " << why << "; a picture of its end instead\n";
  fs::path poster = out;
  write_png(poster.replace_extension(".png"), compose(renderer, layout, {set.scene.duration()}));
  return {poster.string()};
}

fs::path output_of(const Options& options, const std::string& scene) {
  if (!options.output.empty()) return options.output;
  return scene + (options.video ? ".mp4" : options.sheet ? "-sheet.png" : ".png");
}

/// What is wrong with the name of the output is said before anything is simulated.
void check_output(const Options& options) {
  if (options.video && options.sheet)
    throw InputError("only one of --video (or -o NAME.mp4) and --sheet");
  if (options.output.empty()) return;
  if (fs::is_directory(options.output))
    throw InputError("-o " + options.output + " is a folder; name the file");
  const std::string suffix = options.video ? ".mp4" : ".png";
  if (!options.output.ends_with(suffix))
    throw InputError("-o " + options.output + ": what is drawn here ends in " + suffix);
}

int run(Options options) {
  if (options.output.ends_with(".mp4")) options.video = true;
  check_output(options);
  if (options.what.solvers.empty() || options.what.solvers.size() > std::size_t{kMostPanels})
    throw InputError("one to nine --solver, for example --solver jakobsen --solver bullet");
  check_solvers(options.what.solvers);
  if (!options.dt.empty()) options.what.overrides.push_back("time.dt=\"" + options.dt + "\"");
  if (!options.duration.empty())
    options.what.overrides.push_back("time.duration=\"" + options.duration + "\"");
  std::vector<double> times;
  for (const std::string& at : options.at) times.push_back(parse_number(at));
  std::ranges::sort(times);
  if (!times.empty() && times.front() < 0) throw InputError("--at: times are not negative");
  if (!times.empty()) {
    const Scene scene = load_scene(find_scene(options.what.scene), options.what.overrides);
    if (times.back() > scene.duration() + scene.dt)
      throw InputError("--at " + number_text(times.back()) + " is after the end at " +
                       number_text(scene.duration()) + " s: see --duration");
    const double seen = times.back() + 1e-4;  // nothing later will be seen
    if (!options.video && options.duration.empty() && seen < scene.duration())
      options.what.overrides.push_back("time.duration=" + std::to_string(seen));
  }
  parse_view(options.view), parse_colour_by(options.colour);
  if (!options.size.empty()) parse_size(options.size);
  const RunSet set =
      record_runs(options.what, [](const std::string& text) { progress() << text << '\n'; });
  const fs::path out = output_of(options, set.scene.name);
  const double end = set.scene.duration();
  if (times.empty() && options.sheet)
    times = {0, end / 8, end / 4, end / 2, end};
  else if (times.empty())
    times = {end};
  const std::vector<std::string> files = options.video   ? draw_video(options, set, out)
                                         : options.sheet ? draw_sheet(options, set, times, out)
                                                         : draw_stills(options, set, times, out);
  print_files(files, options.json);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.what.scene, "Name of a shipped scene, or a path")->required();
  app.add_option("--solver", o.what.solvers, "NAME or NAME:key=value,...; one to nine of them")
      ->allow_extra_args(false);
  app.add_option("--at", o.at, "Moments to draw [s]; default: the end")->allow_extra_args(false);
  app.add_flag("--sheet", o.sheet, "One picture, a row for each moment");
  app.add_flag("--video", o.video, "H.264 video in real time (so does -o NAME.mp4)");
  app.add_option("--view", o.view,
                 "three-quarter, front, back, left, right, top, or AZIMUTH,ELEVATION in degrees");
  app.add_option("--colour", o.colour, "strain, penetration or speed");
  app.add_option("--range", o.range, "End of the colour bar, in its unit (%, mm, m/s)")
      ->check(above_zero());
  app.add_option("--duration", o.duration, "Simulated time [s]");
  app.add_option("--dt", o.dt, "Time step [s], a number or a fraction such as 1/120");
  add_settings(app, o.what.overrides);
  app.add_option("--size", o.size, "WIDTHxHEIGHT of the picture; of a panel with --sheet");
  app.add_option("--quality", o.quality, "draft, video or still")
      ->check(known("quality", {"draft", "video", "still"}));
  app.add_flag("--dark", o.dark, "The dark background of the report");
  add_output(app, o.output, "File (.png or .mp4)");
  add_json(app, o.json, "The names of the files");
}

}  // namespace

}  // namespace taut::verb::render

TAUT_VERB(render) = {
    .name = "render",
    .group = VerbGroup::one_case,
    .summary = "Pictures and videos of solvers side by side",
    .example =
        "taut render ball --solver jakobsen --solver bullet:substeps=5 --at 0.6\n"
        "  taut render flag --solver jakobsen --solver bullet:substeps=5 --video --duration 4\n"
        "  taut render ball --solver positions:file=run.npy --solver bullet:substeps=5 --sheet",
    .bind = taut::bind_verb<taut::verb::render::add_options, taut::verb::render::run>};
