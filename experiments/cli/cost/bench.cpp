#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/bench_answer.hpp"
#include "experiments/timing/beside.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/two_builds.hpp"

namespace taut::verb::bench {

namespace {

struct Options {
  std::vector<std::string> what, solvers;
  SceneSettings settings;
  std::vector<double> levels;
  std::string preset, metric, out, against, keep_build, beside;
  TimingOptions timing;
  double tolerance = kTolerance;
  bool worker = false;
  Format format;
};

StudyBench bench(const StudyCases& study, const std::string& name, const Options& options,
                 Store& store) {
  return bench_study(name, run_and_collect(study, store, "taut bench"),
                     tell_timing(options.timing));
}

StudyBench timed(const std::string& name, const Options& options, Store& store) {
  if (std::ranges::count(shipped("scenes"), name) > std::ranges::count(shipped("studies"), name))
    throw InputError("'" + name + "' is a scene; --solver says what to time on it");
  const Study study = load_study(name, options.preset);
  StudyBench result = bench({study.name, cases_of(study)}, study.name, options, store);
  keep(store, result);
  return result;
}

StudyBench compared(const std::string& scene, const Options& options, Store& store) {
  check_solvers(options.solvers);
  std::vector<Case> cases;
  CaseMaker maker;
  for (const std::string& solver : options.solvers)
    cases.push_back(maker.make({scene, options.settings, parse_solver(solver).canonical()}));
  return bench({"", cases}, scene, options, store);
}

/// Times this build against another one, case by case. Returns whether it is slower anywhere.
bool against(const std::string& name, const Options& options, Store& store) {
  folder_of_build(options.out, options.against);  // reports errors before anything runs
  const Study study = load_study(name, options.preset);
  const auto records = run_and_collect({study.name, cases_of(study)}, store, "taut bench");
  const std::vector<TwoBuilds> found =
      compare_with_build(study.name, records, options.against, store,
                         {options.timing.rounds, options.timing.seconds, Countdown("case")});
  Answer answer{"bench", name};
  answer.add({"machine"}, machine_name());
  answer.add(table_of(found, "against", options.against));
  print(answer, options.format);
  return any_slower(found);
}

/// Serves samples of the case that the scene and the solver name.
int serve(const Options& options) {
  if (options.what.size() != 2) throw InputError("bench --worker takes a scene and a solver");
  const Case one = make_case({options.what[0], options.settings, options.what[1]});
  return serve_timing(*one.scene, one.choice);
}

int run(const Options& options) {
  if (options.worker) return serve(options);
  require_one_quiet_host();
  if (!options.beside.empty()) {
    if (!options.what.empty()) throw InputError("bench --beside takes no study or scene");
    print(bench_beside(options.beside, options.timing.rounds), options.format);
    return kPass;
  }
  if (!options.keep_build.empty()) {
    const std::string kept = keep_build(options.out, options.keep_build).string();
    if (options.what.empty()) {
      print_files({kept}, options.format.json);
      return kPass;
    }
    progress() << kept << '\n';
  }
  if (options.what.empty()) throw InputError("bench needs a study, or a scene with --solver");
  Store store(options.out);
  bool slower = false;
  for (const std::string& name : options.what)
    if (!options.against.empty())
      slower = against(name, options, store) || slower;
    else
      print(bench_answer(
                options.solvers.empty() ? timed(name, options, store)
                                        : compared(name, options, store),
                {options.levels, options.metric, options.tolerance, options.solvers.empty()}),
            options.format);
  return slower ? kRegression : kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("WHAT", o.what, "Studies; or scenes, with --solver");
  args.add_option("--solver", o.solvers, "A solver to time on the scene; repeat it for each");
  args.add_option(
      "--beside", o.beside,
      "A checkout of public code, timed beside ours of its method (experiments/beside/README.md)");
  add_settings(args, o.settings);
  add_preset(args, o.preset);
  add_judgement(args, o.metric, o.tolerance);
  args.add_option("--at", o.levels,
                  "Errors to be reached (default: " + join(kErrorLevels, ",", shortest) +
                      "; by strain alone: " + join(kStrainLevels, ",", shortest) + "; 0.01 is 1 %)")
      .delimiter(',')
      .check(above_zero());
  add_samples(args, o.timing.rounds, o.timing.seconds);
  add_results(args, o.out);
  args.add_option(
          "--against", o.against,
          "Another build of taut, a folder or the name of a kept one, timed in turns with this "
          "one; exit 1 if this one is slower")
      .excludes("--solver");
  args.add_option("--keep-build", o.keep_build, "Keep this program under a name, for --against");
  add_format(args, o.format, "Print every case and every sample, too");
  args.add_flag(own_words::kWorker, o.worker,
                "Serve samples of one case over stdin and stdout (internal)")
      .hidden();
}

}  // namespace
}  // namespace taut::verb::bench

TAUT_VERB(bench) = {
    .name = own_words::kBench,
    .group = VerbGroup::cost,
    .summary = "Measures cost: CPU time of Solver::step alone, with intervals",
    .example =
        "taut bench trade\n"
        "  taut bench equal-error --at 0.004\n"
        "  taut bench hang --solver jakobsen:iterations=1,substeps=16 --solver bullet\n"
        "  taut bench --keep-build before && taut bench regression --against before\n"
        "  taut bench effects\n  taut bench scaling\n  taut bench --beside ../ShapeOp",
    .answer = {{"facts", "machine host build times"},
               {"scenes", "scene control verdict"},
               {"recommended", "scene target solver setting error cost times answer"},
               {"cases",
                "scene case solver cost cpu wall peak_bytes error status times verdict remark"},
               {"samples", "scene case sample cpu wall"},
               {"iterations", "code each sweeps differs"},
               {"against", "case ratio control verdict wall wall_control"}},
    .bind = taut::bind_verb<taut::verb::bench::add_options, taut::verb::bench::run>};
