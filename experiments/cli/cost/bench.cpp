#include <cstdlib>

#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/recommendation.hpp"

namespace taut::verb::bench {

namespace {

struct Options {
  std::vector<std::string> what, solvers, settings;
  std::vector<double> levels{std::begin(kErrorLevels), std::end(kErrorLevels)};
  std::string preset, metric = kErrorMetric, out;
  int rounds = 5;
  double seconds = 0.05;
  double tolerance = kTolerance;
  bool worker = false;
  Format format;
};

/// "clearly cheaper", "likely dearer", "no difference", ...
std::string verdict(const Interval& ratio, const Interval& control, double tolerance) {
  const Certainty sure = judge(ratio, control, tolerance);
  if (sure == Certainty::too_noisy) return "too noisy to judge";
  if (sure == Certainty::none) return "no difference";
  return std::string(sure == Certainty::clear ? "clearly " : "likely ") +
         (ratio.mid < 1 ? "cheaper" : "dearer");
}

/// The same code against itself.
Table controls_of(const StudyBench& bench, double tolerance) {
  Table table{"scenes", "", {{"scene"}, {"control", "the same code against itself"}, {"verdict"}}};
  for (const SceneBench& scene : bench.scenes)
    table.rows.push_back({scene.scene, scene.control,
                          std::isnan(scene.control.mid)       ? "no case could be timed"
                          : spread(scene.control) > tolerance ? "this machine is too noisy now"
                                                              : "quiet enough"});
  return table;
}

/// Who is cheapest for each error, and who is most accurate within each budget.
Table recommended_of(const StudyBench& bench, const Options& options) {
  std::vector<Target> targets;
  for (const double level : options.levels) targets.push_back({level, {}});
  for (const double budget : kFrameBudgets) targets.push_back({{}, budget / kFrame});
  Table table = recommendations(options.metric);
  for (const SceneBench& scene : bench.scenes)
    for (const Target& target : targets)
      add(table, recommend(scene, target, options.metric, options.tolerance), scene,
          options.metric);
  return table;
}

/// Every case, beside the first of its scene that was timed.
Table cases_of(const StudyBench& bench, const Options& options) {
  Table table{"cases",
              "what was timed",
              {{"scene"},
               {"case"},
               {"solver"},
               {"cost", "CPU time a simulated s", {"s/s", "ms", 1e3}},
               {"cpu", "CPU time a step", kMilliseconds},
               {"wall", "wall time", kMilliseconds},
               {"peak_bytes", "process", kMegabytes},
               {"error", options.metric, unit_of_value(options.metric)},
               {"status"},
               {"times", "times the first"},
               {"verdict"},
               {"remark"}}};
  for (const SceneBench& scene : bench.scenes) {
    const auto timed = [](const BenchedCase& c) { return c.timing.failure.empty(); };
    const auto first =
        static_cast<std::size_t>(std::ranges::find_if(scene.cases, timed) - scene.cases.begin());
    for (std::size_t i = 0; i < scene.cases.size(); ++i) {
      const auto& [record, timing] = scene.cases[i];
      Cell id(record.id), cost, cpu, wall, bytes;
      id.key = record.key;
      if (timing.failure.empty())
        cost = scene.cases[i].cost(), cpu = bootstrap_median(timing.samples),
        wall = median(timing.wall), bytes = timing.peak_bytes;
      const auto times = i > first ? scene.ratio(i, first) : std::nullopt;
      table.rows.push_back(
          {scene.scene, id, record.solver, cost, cpu, wall, bytes, record.value(options.metric),
           to_string(record.status.kind), times,
           times ? verdict(*times, scene.control, options.tolerance) : "",
           timing.failure.empty() ? timing.remark : "not timed: " + timing.failure});
    }
  }
  return table;
}

Table samples_of(const StudyBench& bench) {
  Table table{"samples",
              "samples of a step",
              {{"scene"},
               {"case"},
               {"round"},
               {"cpu", "CPU time", kMilliseconds},
               {"wall", "wall time", kMilliseconds}}};
  for (const SceneBench& scene : bench.scenes)
    for (const auto& [record, timing] : scene.cases)
      for (std::size_t k = 0; k < timing.samples.size(); ++k)
        table.rows.push_back({scene.scene, record.id, k, timing.samples[k], timing.wall[k]});
  table.detail = true;
  return table;
}

/// `of_study`: people see who is best for what; else the cases.
Answer answer_of(const StudyBench& bench, const Options& options, bool of_study) {
  Answer answer{"bench", bench.study};
  answer.add(Column("machine").in_detail(), bench.machine);
  answer.add(Column("host").in_detail(), bench.host);
  answer.add(Column("build").in_detail(), bench.build);
  answer.add(controls_of(bench, options.tolerance));
  if (of_study) answer.add(recommended_of(bench, options));
  answer.add(cases_of(bench, options)).detail = of_study;
  answer.add(samples_of(bench));
  return answer;
}

StudyBench bench(const StudyCases& study, const std::string& name, const Options& options) {
  Store store(options.out);
  return bench_study(name, run_and_collect(study, store, "taut bench"),
                     [&](const std::string& scene, std::size_t cases) {
                       progress() << scene << ": timing " << cases << " cases\n";
                       return TimingOptions{.rounds = options.rounds,
                                            .seconds = options.seconds,
                                            .progress = Countdown("timing round")};
                     });
}

StudyBench timed(const std::string& name, const Options& options) {
  if (std::ranges::count(shipped("scenes"), name) > std::ranges::count(shipped("studies"), name))
    throw InputError("'" + name + "' is a scene; --solver says what to time on it");
  const Study study = load_study(name, options.preset);
  StudyBench result = bench({study.name, taut::cases_of(study)}, study.name, options);
  Store store(options.out);
  keep(store, result);
  return result;
}

StudyBench compared(const std::string& scene, const Options& options) {
  check_solvers(options.solvers);
  std::vector<Case> cases;
  CaseMaker maker;
  for (const std::string& solver : options.solvers)
    cases.push_back(maker.make({scene, options.settings, parse_solver(solver).canonical()}));
  return bench({"", cases}, scene, options);
}

/// Cores that a case keeps busy.
int threads_of(const SolverChoice& choice) {
  for (const ParamSpec& spec : choice.params.specs())
    if (spec.name == "threads") return std::max(1, choice.params.integer("threads"));
  return 1;
}

int run(const Options& options) {
  if (options.worker) {
    if (options.what.size() != 2) throw InputError("bench --worker takes a scene and a solver");
    const Case one = make_case({options.what[0], options.settings, options.what[1]});
    if (std::getenv("SLURM_JOB_ID")) pin(threads_of(one.choice));
    return serve_timing(*one.scene, one.choice);
  }
  require_one_quiet_host();
  if (options.what.empty()) throw InputError("bench what? A study, or a scene with --solver");
  for (const std::string& name : options.what)
    print(options.solvers.empty() ? answer_of(timed(name, options), options, true)
                                  : answer_of(compared(name, options), options, false),
          options.format);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("WHAT", o.what, "Studies; or scenes, with --solver");
  app.add_option("--solver", o.solvers, "A solver to time on the scene; repeat it for each");
  add_settings(app, o.settings);
  add_preset(app, o.preset);
  add_judgement(app, o.metric, o.tolerance);
  app.add_option("--at", o.levels,
                 "Errors to ask for (default: 0.1,0.01,0.001,0.0001; 0.01 is 1 %)")
      ->delimiter(',')
      ->check(above_zero());
  add_samples(app, o.rounds, o.seconds);
  add_results(app, o.out);
  add_format(app, o.format, "Print every case and every sample, too");
  app.add_flag("--worker", o.worker, "Serve samples of one case over stdin and stdout (internal)")
      ->group("");
}

}  // namespace

}  // namespace taut::verb::bench

TAUT_VERB(bench) = {
    .name = "bench",
    .group = VerbGroup::cost,
    .summary = "Measures cost: CPU time of Solver::step alone, with intervals",
    .example =
        "taut bench trade\n  taut bench equal-error --at 0.004\n  taut bench hang --solver "
        "jakobsen:iterations=1,substeps=16 --solver "
        "bullet:iterations=1,substeps=16\n  taut bench effects\n  taut bench scaling",
    .answer =
        "machine host build; "
        "scenes: scene control verdict; "
        "recommended: scene target solver setting error cost times answer; "
        "cases: scene case solver cost cpu wall peak_bytes error status times verdict remark; "
        "samples: scene case round cpu wall",
    .bind = taut::bind_verb<taut::verb::bench::add_options, taut::verb::bench::run>};
