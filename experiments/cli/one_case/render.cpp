#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/render/film/drawing.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/system/data.hpp"

namespace taut::verb::render {

namespace {

namespace fs = std::filesystem;

struct Options {
  RunRequest what;
  std::vector<std::string> at;
  SceneChanges changes;
  std::string view = "three-quarter", colour = "strain", output;
  std::string size, quality;
  double range = 0;
  bool sheet = false, video = false, dark = false, json = false;
};

std::pair<int, int> parse_size(const std::string& text) {
  int width = 0, height = 0;
  char end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &end) != 2 || width < 320 ||
      height < 240 || width > 7680 || height > 4320 || width % 2 != 0 || height % 2 != 0)
    throw InputError("--size '" + text +
                     "': expected WIDTHxHEIGHT, both even, 320x240 to 7680x4320");
  return {width, height};
}

RenderQuality parse_quality(const std::string& name) {
  if (name == "draft") return RenderQuality::draft();
  if (name == "video") return RenderQuality::video();
  return RenderQuality::still();
}

fs::path output_of(const Options& options, const std::string& scene) {
  if (!options.output.empty()) return options.output;
  return scene + (options.video ? ".mp4" : options.sheet ? "-sheet.png" : ".png");
}

/// Throws InputError if the name of the output is wrong, before anything is simulated.
void check_output(const Options& options) {
  if (options.video && options.sheet)
    throw InputError("give only one of --video (or -o NAME.mp4) and --sheet");
  if (options.output.empty()) return;
  if (fs::is_directory(options.output))
    throw InputError("-o " + options.output + " is a folder; name the file");
  const std::string suffix = options.video ? ".mp4" : ".png";
  if (!options.output.ends_with(suffix))
    throw InputError("-o " + options.output + ": expected a name that ends in " + suffix);
}

/// The drawing that the options describe, without its moments. Throws InputError before anything is
/// run.
Drawing drawing_of(const Options& options) {
  Drawing drawing;
  if (options.video) drawing.kind = Drawing::Kind::video;
  if (options.sheet) drawing.kind = Drawing::Kind::sheet;
  if (!options.size.empty()) drawing.size = parse_size(options.size);
  if (!options.quality.empty()) drawing.quality = parse_quality(options.quality);
  drawing.view = parse_view(options.view);
  drawing.colour_by = parse_colour_by(options.colour);
  drawing.range = options.range;
  drawing.dark = options.dark;
  return drawing;
}

/// Requested moments in ascending order. If nothing later is shown, the run is shortened to end
/// with the last of them. Throws InputError if one lies outside the scene's time.
std::vector<double> times_of(const Options& options, SceneSettings& settings) {
  std::vector<double> times;
  for (const std::string& at : options.at) times.push_back(parse_number(at));
  if (times.empty()) return times;
  std::ranges::sort(times);
  if (times.front() < 0) throw InputError("--at: expected times of at least 0");
  const Scene scene = load_scene(find_scene(options.what.scene), settings);
  if (times.back() > scene.duration() + scene.dt)
    throw InputError("--at " + number_text(times.back()) + " is after the end at " +
                     number_text(scene.duration()) + " s: see --duration");
  const double seen = times.back() + 1e-4;
  if (!options.video && !options.changes.has_duration() && seen < scene.duration())
    settings.emplace_back("time.duration", decimal(seen, 6));
  return times;
}

int run(Options options) {
  if (options.output.ends_with(".mp4")) options.video = true;
  check_output(options);
  RunRequest& what = options.what;
  if (what.solvers.empty() || what.solvers.size() > std::size_t{kMostPanels})
    throw InputError("expected 1 to " + std::to_string(kMostPanels) +
                     " --solver, for example --solver jakobsen --solver bullet");
  check_solvers(what.solvers);
  what.settings = options.changes.settings();
  Drawing drawing = drawing_of(options);
  drawing.times = times_of(options, what.settings);
  const RunSet set = record_runs(what, [](const std::string& text) { progress() << text << '\n'; });
  const double end = set.scene.duration();
  if (drawing.times.empty())
    drawing.times =
        options.sheet ? std::vector{0.0, end / 8, end / 4, end / 2, end} : std::vector{end};
  const fs::path out = output_of(options, set.scene.name);
  const Drawn drawn = draw(set, drawing, out, Countdown(options.video ? "frame" : "still"));
  if (!drawn.no_video.empty())
    std::cerr << printable(out.string()) << ": " << drawn.no_video
              << "; a picture of its end instead\n";
  print_files(drawn.files, options.json);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  add_scene(args, o.what.scene).required();
  add_solvers(args, o.what.solvers, "A solver to draw, at most " + std::to_string(kMostPanels));
  args.add_option("--at", o.at, "A moment to draw [s]; repeat it for each (default: the end)")
      .one_each();
  args.add_flag("--sheet", o.sheet, "One picture, a row for each moment");
  args.add_flag("--video", o.video, "H.264 video in real time (so does -o NAME.mp4)");
  args.add_option("--view", o.view,
                  "three-quarter, front, back, left, right, top, or AZIMUTH,ELEVATION in degrees");
  args.add_option("--colour", o.colour, "strain, penetration or speed");
  args.add_option("--range", o.range, "End of the colour bar, in its unit (%, mm, m/s)")
      .check(above_zero());
  o.changes.bind(args);
  args.add_option("--size", o.size, "WIDTHxHEIGHT of the picture; of a panel with --sheet");
  args.add_option("--quality", o.quality, "draft, video or still")
      .check(known("quality", {"draft", "video", "still"}));
  args.add_flag("--dark", o.dark, "The dark background of the report");
  add_output(args, o.output, "File (.png or .mp4)");
  add_json(args, o.json, "the names of the files");
}

}  // namespace

}  // namespace taut::verb::render

TAUT_VERB(render) = {
    .name = "render",
    .group = VerbGroup::one_case,
    .summary = "Draws pictures and videos of solvers side by side",
    .example =
        "taut render ball --solver jakobsen --solver bullet:substeps=5 --at 0.6\n"
        "  taut render flag --solver jakobsen --solver bullet:substeps=5 --video --duration 4\n"
        "  taut render ball --solver positions:file=run.npy --solver bullet:substeps=5 --sheet",
    .bind = taut::bind_verb<taut::verb::render::add_options, taut::verb::render::run>};
