#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/external/motion_file.hpp"
#include "experiments/render/film/drawing.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::score {

namespace {

constexpr std::size_t kMostBeside = 3;  ///< solvers in one picture with the positions

struct Options {
  std::string scene, series, picture;
  external::MotionOptions motion;
  SceneSettings settings;
  std::vector<std::string> solvers;
  Format format;
};

int run(const Options& o) {
  if (o.solvers.size() > kMostBeside)
    throw InputError("--solver: at most " + std::to_string(kMostBeside) +
                     " are drawn beside the positions");
  if (!o.picture.empty() && !o.picture.ends_with(".png"))
    throw InputError("--picture " + o.picture + ": expected a name that ends in .png");
  check_solvers(o.solvers);
  const std::string solver = external::solver_text(o.motion);
  admit_solver(solver);
  const auto load = [&](const SceneSettings& settings) {
    return load_scene(find_scene(o.scene), settings);
  };
  const SceneSettings settings = fitted(load, o.settings, external::opened(o.motion));
  const Case one = CaseMaker().make({o.scene, settings, solver});
  for (const std::string& why : one.choice.entry->unsupported(*one.scene, one.choice.params))
    throw InputError(why);
  const CaseRun scored = run_case(one, {.series_rows = o.series.empty() ? 0 : kSeriesRows});
  if (!o.series.empty()) write_durably(o.series, to_csv(scored.series));
  Answer answer = answer_of(scored.record, "external score");
  Table read{"read", "what was made of the file", {{"what"}, {"how", "found"}}};
  for (const ResolvedSetting& setting : scored.record.resolved_settings)
    read.rows.push_back({setting.name, setting.text});
  answer.add(std::move(read));
  if (!o.picture.empty()) {
    RunRequest both{.scene = o.scene, .settings = one.spec.settings, .solvers = {one.spec.solver}};
    both.solvers.insert(both.solvers.end(), o.solvers.begin(), o.solvers.end());
    const RunSet set =
        record_runs(both, [](const std::string& news) { progress() << news << '\n'; });
    draw(set, {.times = {set.scene.duration()}}, o.picture, Countdown("still"));
    answer.add({"picture"}, o.picture);
  }
  print(answer, o.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  add_scene(args, o.scene).required();
  args.add_option("POSITIONS", o.motion.file, "A .npy, a .pc2, or one .obj of a sequence")
      .required();
  args.add_option("--fps", o.motion.fps,
                  "Frames in a second, as 24 or 24000/1001 (default: one a step of the scene)")
      .check(above_zero());
  args.add_option(
          "--scale", o.motion.scale,
          "The file's unit [m]: 0.01 for centimetres (default: " + as_typed(o.motion.scale) + ")")
      .check(above_zero());
  args.add_flag("--z-up", o.motion.z_up, "The file's z points up, not its y");
  args.add_option(
      "--rest", o.motion.rest,
      "A file with the cloth at rest in the same order of vertices, if the positions do not "
      "begin as the scene does");
  add_settings(args, o.settings);
  args.add_option("--series", o.series, "Write values over time (CSV)");
  args.add_option("--picture", o.picture, "Draw the end (.png), beside every --solver");
  add_solvers(args, o.solvers,
              "A solver to draw beside them, at most " + std::to_string(kMostBeside));
  add_format(args, o.format);
}

}  // namespace
}  // namespace taut::verb::score

TAUT_VERB(external_score) = {
    .name = "external score",
    .summary = "Computes all metrics of positions in the file of another program",
    .example =
        "taut external score hang blender.pc2 --fps 24 --series blender.csv\n  taut external "
        "score hang houdini.pc2 --scale 0.01 --z-up --solver jakobsen --picture hang.png",
    .answer = {{"facts",
                "status steps dt vertices links projections digest key step vertex picture *"},
               {"read", "what how"}},
    .bind = taut::bind_verb<taut::verb::score::add_options, taut::verb::score::run>};
