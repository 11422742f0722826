#include <algorithm>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/predict/prediction.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/judge.hpp"

namespace taut::verb::prediction {

namespace {

struct Options {
  std::string scene, error;
  std::vector<std::string> solvers;
  SceneChanges changes;
  double stiffness = 0, budget = 0;  ///< N/m, ms per frame; 0: not given
  double fps = 1 / kFrame;
  bool as_stiffness = false;
  Format format;
};

constexpr const char* kDomain =
    "At rest, under gravity, without contact: most runs are within 5 %, nearly all within 15 %. "
    "The time is that of the first steps";

PredictionWanted wanted_of(const Options& o, const Scene& scene) {
  if (!o.error.empty() + (o.stiffness > 0) + (o.budget > 0) > 1)
    throw InputError("predict needs at most one of --error, --stiffness and --budget");
  PredictionWanted wanted{.as_stiffness = o.as_stiffness};
  if (!o.error.empty()) wanted.error = error_of(o.error, unit_of_value("stretch.rms"));
  if (o.stiffness > 0) wanted.stiffness = o.stiffness;
  if (o.budget > 0) wanted.budget = o.budget * 1e-3 * o.fps * scene.dt;
  return wanted;
}

Answer answer_of(const Options& o, const Scene& scene, const std::vector<PredictedStrain>& all) {
  Answer answer{"predict", o.scene};
  const auto settings = join(o.changes.settings(), " ", &SceneSetting::text);
  answer.add(Column("settings").in_detail(), settings.empty() ? Cell() : Cell(settings));
  Table table{"predictions",
              "",
              {Column("setting").of_commands(),
               {"rms", "RMS stretch", kErrorShare},
               {"largest", "largest stretch", kErrorShare},
               {"sag", "", kLength},
               {"cost", "CPU time", frame_cost(o.fps), 2}}};
  table.caption = kDomain;
  const Unit newton_per_metre{Unit::Kind::other, "N/m", "N/m"};
  Column stiffness("stiffness", "", newton_per_metre);
  table.columns.push_back(o.as_stiffness ? stiffness : stiffness.in_detail());
  for (const char* name : {"found", "s", "share", "correction"})
    table.columns.push_back(Column(name).in_detail());
  Table refused{"refused", "not predicted:", {Column("setting").of_commands(), {"why"}}};
  for (const PredictedStrain& one : all) {
    const std::string setting = one.choice.brief();
    for (const std::string& why : one.refused) refused.rows.push_back({setting, why});
    if (!one.refused.empty()) continue;
    table.rows.push_back({setting, one.strain.rms, one.strain.largest, one.strain.sag,
                          one.cpu / scene.dt, one.stiffness, one.found, one.strain.s,
                          one.strain.share, one.correction});
  }
  answer.add(std::move(table));
  answer.add(std::move(refused));
  return answer;
}

int run(const Options& o) {
  check_solvers(o.solvers);
  const Scene scene = load_scene(find_scene(o.scene), o.changes.settings());
  const PredictionWanted wanted = wanted_of(o, scene);
  std::vector<PredictedStrain> all;
  for (const std::string& solver : o.solvers) {
    const std::vector<PredictedStrain> some = predict(scene, parse_solver(solver), wanted);
    all.insert(all.end(), some.begin(), some.end());
  }
  print(answer_of(o, scene, all), o.format);
  return std::ranges::any_of(all, [](const PredictedStrain& p) { return p.refused.empty(); })
             ? kPass
             : kNothing;
}

void add_options(Arguments& args, Options& o) {
  add_scene(args, o.scene).required();
  args.add_option("SOLVER", o.solvers, "name or name:key=value,...; several").required();
  o.changes.bind(args);
  args.add_option("--error", o.error,
                  "Find the fewest sweeps, and the fewest substeps, with this RMS stretch (0.01 or "
                  "1%)");
  args.add_option("--stiffness", o.stiffness,
                  "Find those whose cloth stretches like links of this stiffness [N/m]")
      .check(above_zero());
  args.add_option(
          "--budget", o.budget,
          "Find the most sweeps, and the most substeps, within this CPU time per frame [ms]")
      .check(above_zero());
  args.add_option("--fps", o.fps,
                  "Frames in a second; costs are those of one (default: " + as_typed(o.fps) + ")")
      .check(above_zero());
  args.add_flag("--as-stiffness", o.as_stiffness,
                "Also find the stiffness [N/m] of links that stretch like each setting");
  add_format(args, o.format, "Print the law's numbers, too");
}

}  // namespace
}  // namespace taut::verb::prediction

TAUT_VERB(predict) = {
    .name = "predict",
    .group = VerbGroup::cost,
    .summary = "Predicts stretch, sag and cost of a cloth at rest without running the scene",
    .example =
        "taut predict hang jakobsen xpbd vbd:start=inertia\n"
        "  taut predict hang jakobsen:projection=exact --error 1%\n"
        "  taut predict hang jakobsen:projection=exact --stiffness 2000 --set 'cloth.grid=[64, "
        "64]'\n"
        "  taut predict hang jakobsen:iterations=8,substeps=15 --as-stiffness --json\n"
        "  taut predict drape xpbd --budget 0.2\n"
        "Exit: 0 predicted; 4 nothing: not at rest, in contact, or outside of the law",
    .answer = {{"facts", "settings"},
               {"predictions", "setting rms largest sag cost stiffness found s share correction"},
               {"refused", "setting why"}},
    .bind = taut::bind_verb<taut::verb::prediction::add_options, taut::verb::prediction::run>};
