#include <algorithm>
#include <cmath>

#include "core/io/scene_io.hpp"
#include "core/model/text.hpp"
#include "experiments/advise/advice_answer.hpp"
#include "experiments/advise/searched_study.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/read_all.hpp"

namespace taut::verb::advise {

namespace {

struct Options {
  std::string scene, study, preset, metric, error, out;
  double cpu = 8;     ///< s for each solver on a scene of a study
  double budget = 0;  ///< ms per frame; 0: not given
  double fps = 1 / kFrame;
  std::vector<std::string> solvers, keep;
  SceneSettings settings;
  double patience = 120;
  int rounds = 8;
  double seconds = 0.05, tolerance = kTolerance;
  Format format;
};

Target target_of(const Options& options) {
  if (options.error.empty() == (options.budget <= 0))
    throw InputError(std::string("advise needs one of --error and --budget") +
                     (options.error.empty() ? "" : ", not both"));
  if (!options.error.empty()) return {error_of(options.error, unit_of_value(options.metric)), {}};
  return {{}, options.budget * 1e-3 * options.fps};
}

/// The limits of --keep, or the default limits of the scene. The error is not limited, since it is
/// the target itself.
std::vector<Limit> limits_of(const Options& options, const Scene& scene, const Target& target) {
  std::vector<Limit> limits;
  if (options.keep.empty()) limits = default_limits(scene);
  if (target.error)
    std::erase_if(limits, [&](const Limit& limit) { return limit.name == options.metric; });
  read_all(options.keep, [&](const std::string& asked) {
    if (asked != "nothing") limits.push_back(parse_limit(asked, scene));
  });
  return limits;
}

std::ostream& news(const std::string& line) { return progress() << line << '\n'; }

int search(const Options& options) {
  Store store(options.out);
  const Study study = load_study(options.study, options.preset);
  print(search_study(study, store, options.metric, options.cpu, news), options.format);
  return kPass;
}

int run(Options options) {
  if (options.scene.empty() == options.study.empty())
    throw InputError("advise needs a scene or --study");
  if (!options.study.empty()) return search(options);
  const Scene scene = load_scene(find_scene(options.scene), options.settings);
  if (options.metric.empty()) options.metric = deciding_metric(scene);
  const Target target = target_of(options);
  if (options.solvers.empty()) options.solvers = solvers_to_search();
  check_solvers(options.solvers);
  Store store(options.out);
  const AdviceWanted wanted{.scene = options.scene,
                            .settings = options.settings,
                            .solvers = options.solvers,
                            .target = target,
                            .metric = options.metric,
                            .judged = deciding_metric(scene) == kVerdict,
                            .limits = limits_of(options, scene, target),
                            .fps = options.fps,
                            .patience = options.patience,
                            .rounds = options.rounds,
                            .seconds = options.seconds,
                            .tolerance = options.tolerance,
                            .news = news,
                            .timing_round = Countdown("timing round")};
  const Advice advice = find_advice(wanted, store);
  if (!advice.too_dear && advice.complete() &&
      std::ranges::all_of(advice.tried, [](const Candidate& c) { return std::isnan(c.error); }))
    throw InputError(advice.tried.empty()
                         ? "no solver can run scene '" + options.scene + "'"
                         : options.metric + " has no value on scene '" + options.scene + "'");
  print(answer_of(wanted, advice), options.format);
  if (!advice.recommendation.best) return kNothing;
  if (!advice.same_bits) return kConflict;
  return advice.cut.empty() ? kPass : kIncomplete;
}

void add_options(Arguments& args, Options& o) {
  add_scene(args, o.scene);
  args.add_option(
      "--study", o.study,
      "In place of a scene: search all solvers on all scenes of this study with equal CPU time, "
      "and write the file that the study's key `searched` names");
  add_preset(args, o.preset);
  args.add_option(
          "--cpu", o.cpu,
          "With --study: CPU time of each solver on a scene [s] (default: " + as_typed(o.cpu) + ")")
      .check(above_zero_seconds());
  args.add_option("--error", o.error, "Reach this error (0.01 or 1%) at the least cost");
  args.add_option("--budget", o.budget, "Reach the least error within this CPU time per frame [ms]")
      .check(above_zero());
  args.add_option(
          "--fps", o.fps,
          "Frames in a second; the budget is that of one (default: " + as_typed(o.fps) + ")")
      .check(above_zero());
  args.add_option(
          "--keep", o.keep,
          "VALUE:LIMIT that it must keep, too, in SI units, in the unit shown (:1mm) or in %; "
          "repeat it for each. 'nothing': only the error counts (default: no passage, no crossing, "
          "depths of at most " +
              number_text(100 * kMostDepth) + " % of the cloth, RMS stretch of at most " +
              number_text(100 * kMostStretch) + " %)")
      .repeated();
  args.add_option(
      "--solver", o.solvers,
      "Only this solver, keeping what its text sets; repeat it for each (default: all)");
  add_settings(args, o.settings);
  add_judgement(args, o.metric, o.tolerance);
  args.add_option(
          "--patience", o.patience,
          "Search, time and verify within this time [s] (default: " + as_typed(o.patience) + ")")
      .check(above_zero_seconds());
  add_samples(args, o.rounds, o.seconds, 2);
  add_results(args, o.out);
  add_format(args, o.format, "Print all that was tried, too");
}

}  // namespace
}  // namespace taut::verb::advise

TAUT_VERB(advise) = {
    .name = "advise",
    .group = VerbGroup::cost,
    .summary = "Finds and verifies the best setting for an error or a budget",
    .example =
        "taut advise hang --error 1%\n  taut advise ball --budget 4 --metric "
        "stretch.max\n  taut advise tunnel --error 1% --keep penetration.peak:1mm --keep "
        "tunnelling.count:0\n  taut advise my/scene.toml --error 0.001 --solver jakobsen --json\n"
        "  taut advise --study trade --preset quick\n"
        "Exit: 0 found; 3 found, solvers not searched; 4 not reached; 6 the best does not repeat "
        "bit for bit",
    .answer = {{"facts",
                "best error cost again control same_bits confirmed certainty command searched "
                "seconds patience complete file cheapest cheapest_cost nearest quick_cost"},
               {"solvers", "solver setting error cost times peak_bytes note"},
               {"kept", "value limit best"},
               {"without", "effect share cost fits"},
               {"refused", "setting why"},
               {"not_done", "solver what"},
               {"tried", "setting error quick_cost refused"},
               {"searched", "scene solver tried cpu cut_off"},
               {"missing", "why"}},
    .bind = taut::bind_verb<taut::verb::advise::add_options, taut::verb::advise::run>};
