#include <cstdlib>
#include <set>
#include <thread>

#include "experiments/case/question.hpp"
#include "experiments/cli/calls.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/distinct.hpp"
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
  bool json = false, worker = false;
};

/// The physics of every case, from the store or run now.
std::vector<Record> physics(const StudyCases& study, const Options& options) {
  const Store store(options.out);
  store.prepare();
  const int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (run_missing({study}, store, "taut bench", {.jobs = jobs}).interrupted) throw Interrupted();
  std::vector<Record> records;
  for (const Case& one : study.cases)
    if (auto record = store.find(one)) records.push_back(std::move(*record));
  return records;
}

void print_control(const SceneBench& bench, double tolerance) {
  if (std::isnan(bench.control.mid)) {
    std::cout << "  no case could be timed\n";
    return;
  }
  const bool noisy = spread(bench.control) > tolerance;
  std::cout << "  the same code against itself: " << interval_text(bench.control) << ", tolerance "
            << number_text(100 * tolerance) << " %"
            << (noisy ? ": THIS MACHINE IS TOO NOISY NOW TO JUDGE" : "") << '\n';
}

/// Who is cheapest for each error, and who is most accurate within each budget.
void print_recommendations(const SceneBench& bench, const Options& options) {
  std::vector<Target> targets;
  for (const double level : options.levels) targets.push_back({level, {}});
  for (const double budget : kFrameBudgets) targets.push_back({{}, budget / kFrame});
  for (const Target& target : targets)
    std::cout << "  "
              << text(recommend(bench, target, options.metric, options.tolerance), bench,
                      options.metric);
}

/// "clearly cheaper", "likely dearer", "no difference", ...
std::string verdict(const Interval& ratio, const Interval& control, double tolerance) {
  const Certainty sure = judge(ratio, control, tolerance);
  if (sure == Certainty::too_noisy) return "too noisy to judge";
  if (sure == Certainty::none) return "no difference";
  return std::string(sure == Certainty::clear ? "clearly " : "likely ") +
         (ratio.mid < 1 ? "cheaper" : "dearer");
}

void print_pairs(const SceneBench& bench, double tolerance) {
  const auto timed = [](const BenchedCase& c) { return c.timing.failure.empty(); };
  const auto first =
      static_cast<std::size_t>(std::ranges::find_if(bench.cases, timed) - bench.cases.begin());
  for (std::size_t i = first + 1; i < bench.cases.size(); ++i)
    if (const auto ratio = bench.ratio(i, first))
      std::cout << "  " << bench.cases[i].record.id << ": " << interval_text(*ratio) << " x "
                << bench.cases[first].record.id << ": " << verdict(*ratio, bench.control, tolerance)
                << '\n';
}

void print_failures(const SceneBench& bench) {
  for (const BenchedCase& c : bench.cases)
    if (!c.timing.failure.empty())
      std::cout << "  not timed: " << c.record.id << ": " << c.timing.failure << '\n';
    else if (!c.timing.remark.empty())
      std::cout << "  doubtful: " << c.record.id << ": " << c.timing.remark << '\n';
}

/// Cases grouped by scene and its settings, in order of appearance. The time step is one of the
/// settings of a solver: a cost is that of a simulated second.
std::vector<std::pair<std::string, std::vector<Record>>> by_scene(
    const std::vector<Record>& records) {
  std::set<Question> asked;
  for (const Record& record : records) asked.insert(question_of(record));
  std::vector<std::pair<std::string, std::vector<Record>>> groups;
  for (const Record& record : records) {
    if (record.status.kind == Status::Kind::unsupported) continue;
    group_of(groups, title_among(question_of(record), asked)).push_back(record);
  }
  return groups;
}

StudyBench bench(const std::string& name, const std::vector<Case>& cases, const Options& options) {
  StudyBench result = StudyBench::here(name);
  for (const auto& [scene, records] : by_scene(physics({name, cases}, options))) {
    progress() << scene << ": timing " << records.size() << " cases\n";
    result.scenes.push_back(bench_scene(scene, records,
                                        {.rounds = options.rounds,
                                         .seconds = options.seconds,
                                         .progress = Countdown("timing round")}));
  }
  return result;
}

std::pair<StudyBench, std::filesystem::path> timed(const std::string& name,
                                                   const Options& options) {
  if (std::ranges::count(shipped("scenes"), name) > std::ranges::count(shipped("studies"), name))
    throw InputError("'" + name + "' is a scene; --solver says what to time on it");
  const Study study = load_study(name, options.preset);
  StudyBench result = bench(study.name, cases_of(study), options);
  return {result, keep(options.out, result)};
}

void bench_study(const std::string& name, const Options& options) {
  const auto [result, file] = timed(name, options);
  if (options.json) {
    std::cout << to_json(result);
    return;
  }
  for (const SceneBench& scene : result.scenes) {
    std::cout << scene.scene << '\n';
    print_control(scene, options.tolerance);
    print_recommendations(scene, options);
    print_failures(scene);
  }
  std::cout << file.string() << '\n';
}

void compare(const std::string& scene, const Options& options) {
  check_solvers(options.solvers);
  std::vector<Case> cases;
  CaseMaker maker;
  for (const std::string& solver : options.solvers)
    cases.push_back(maker.make({scene, options.settings, parse_solver(solver).canonical()}));
  const StudyBench result = bench(scene, cases, options);
  if (options.json) {
    std::cout << to_json(result);
    return;
  }
  for (const SceneBench& one : result.scenes) {
    std::cout << one.scene << '\n';
    print_control(one, options.tolerance);
    for (const BenchedCase& c : one.cases)
      std::cout << "  " << c.record.id << ": " << interval_text(c.cost(), kMilliseconds)
                << " ms per simulated s, " << options.metric << " "
                << number_text(c.record.value(options.metric)) << ", "
                << to_string(c.record.status.kind) << '\n';
    print_pairs(one, options.tolerance);
    print_failures(one);
  }
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
    options.solvers.empty() ? bench_study(name, options) : compare(name, options);
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
  app.add_flag("--json", o.json, "Everything measured, every sample, as JSON");
  app.add_flag("--worker", o.worker, "Serve samples of one case over stdin and stdout (internal)")
      ->group("");
}

}  // namespace

void time_study(const std::string& study, const std::string& preset, double seconds,
                const std::string& results) {
  require_one_quiet_host();
  Options options;
  options.preset = preset, options.seconds = seconds, options.out = results;
  timed(study, options);
}

}  // namespace taut::verb::bench

TAUT_VERB(bench) = {
    .name = "bench",
    .group = VerbGroup::cost,
    .summary = "Measures cost: CPU time of Solver::step alone, with intervals",
    .example =
        "taut bench trade\n  taut bench equal-error --at 0.004\n  taut bench hang --solver "
        "jakobsen:iterations=1,substeps=16 --solver "
        "bullet:iterations=1,substeps=16\n  taut bench kernels\n  taut bench contact",
    .bind = taut::bind_verb<taut::verb::bench::add_options, taut::verb::bench::run>};
