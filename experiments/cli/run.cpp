#include <algorithm>
#include <iostream>
#include <memory>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/command_line/invoke.hpp"
#include "experiments/command_line/progress.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/plot.hpp"
#include "experiments/study/campaign.hpp"

namespace taut::verb::run {

namespace {

/// What a bare `taut run` answers.
const std::vector<std::string> kMainJob{"iterations", "time-steps", "penetration"};
constexpr const char* kMainPreset = "quick";
constexpr const char* kMainBench = "trade";

struct Options {
  std::vector<std::string> studies;
  std::string preset, shard, only, out = default_results();
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  double seconds = Limits{}.seconds;
  double megabytes = static_cast<double>(Limits{}.bytes >> 20);
  bool no_report = false;
};

std::string command_line(const Options& options) {
  std::string text = "taut run";
  for (const std::string& study : options.studies) text += " " + study;
  if (!options.preset.empty()) text += " --preset " + options.preset;
  if (!options.shard.empty()) text += " --shard " + options.shard;
  if (!options.only.empty()) text += " --only " + options.only;
  return text;
}

/// What no figure could draw, said before anything runs.
void judge_plots(const Study& study, std::vector<Diagnostic>& wrong) {
  std::vector<std::string> known = report::quantity_names();
  known.emplace_back("setting");
  for (const Sweep& sweep : study.sweeps) known.push_back(sweep.name);
  const auto report = [&](std::size_t i, const std::string& text) {
    wrong.push_back({study.file, 0, 0, "[[plot]] " + std::to_string(i + 1) + ": " + text});
  };
  for (std::size_t i = 0; i < study.plots.size(); ++i) {
    try {
      report::find_plot_kind(study.plots[i].kind);
    } catch (const InputError& error) {
      report(i, error.diagnostics().front().text());
    }
    for (const char* axis : {"x", "y", "along"})
      if (const auto at = study.plots[i].options.find(axis);
          at != study.plots[i].options.end() && std::ranges::count(known, at->second) == 0)
        report(i, "unknown value '" + at->second + "' for " + axis + suggestion(at->second, known) +
                      " (`taut list metrics`)");
  }
}

std::vector<Study> load_studies(const Options& options) {
  std::vector<Study> studies;
  std::vector<Diagnostic> wrong;
  for (const std::string& name : options.studies) try {
      Study study = load_study(name, options.preset);
      if (!options.preset.empty() && study.preset.empty())
        wrong.push_back({study.file, 0, 0,
                         "study '" + study.name + "' has no preset '" + options.preset + "'" +
                             suggestion(options.preset, study.presets)});
      judge_plots(study, wrong);
      studies.push_back(std::move(study));
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics()) wrong.push_back(d);
    }
  if (!wrong.empty()) throw InputError(wrong);
  return studies;
}

std::vector<Case> all_cases(const std::vector<Study>& studies) {
  std::vector<Case> cases;
  std::vector<Diagnostic> wrong;
  for (const Study& study : studies) try {
      for (Case& one : cases_of(study)) cases.push_back(std::move(one));
    } catch (const InputError& error) {
      for (const Diagnostic& d : error.diagnostics()) wrong.push_back(d);
    }
  if (!wrong.empty()) throw InputError(wrong);
  std::stable_sort(cases.begin(), cases.end(),
                   [](const Case& a, const Case& b) { return a.key < b.key; });
  const auto same = [](const Case& a, const Case& b) { return a.key == b.key; };
  cases.erase(std::unique(cases.begin(), cases.end(), same), cases.end());
  return cases;
}

int exit_code(const Tally& tally) {
  if (tally.interrupted) return kInterrupted;
  if (tally.conflicts > 0) return kConflict;
  return kPass;
}

/// Where solvers break.
void maps(const Options& options) {
  if (!options.no_report && has_verb("map"))
    invoke("map", {"--quiet", "--jobs", std::to_string(options.jobs), "--out", options.out});
}

/// What accuracy costs: exclusive, so after everything else has ended. A machine too noisy to judge
/// still gives numbers; the report shows how noisy.
void bench(const Options& options) {
  if (!options.no_report && has_verb("bench"))
    invoke("bench", {kMainBench, "--preset", kMainPreset, "--seconds", "0.015", "--quiet", "--out",
                     options.out});
}

/// Truths and baselines: what the report says besides the studies. It says which one failed, too,
/// so the run goes on.
void prove(const Options& options) {
  if (options.no_report || !has_verb("report")) return;
  const std::string jobs = std::to_string(options.jobs);
  std::cerr << "holding solvers to closed forms and published numbers\n";
  invoke("verify", {"--quiet", "-j", jobs, "--out", options.out + "/verify.json"});
  std::cerr << "comparing with the committed baselines\n";
  invoke("check", {"--record", "-j", jobs, "--out", options.out});
}

int report(const Options& options) {
  if (options.no_report || !has_verb("report")) {
    std::cout << options.out << '\n';
    return kPass;
  }
  std::vector<std::string> arguments{"--results", options.out};  // none named: the main job's
  if (options.preset != kMainPreset)
    arguments.insert(arguments.end(), {"--preset", options.preset});
  return invoke("report", arguments);
}

int run(Options options) {
  const bool bare = options.studies.empty();
  if (bare) {
    options.studies = kMainJob;
    if (options.preset.empty()) options.preset = kMainPreset;
  }
  const Shard shard = Shard::parse(options.shard);
  const std::vector<Case> cases = all_cases(load_studies(options));
  if (cases.empty()) {
    std::cerr << "these studies have no case: their exclusions leave out all\n";
    return kNothing;
  }
  const Store store(options.out);
  store.prepare();
  const Session session(store, command_line(options), cases, shard);
  Progress progress;
  const Tally tally = run_cases(
      cases, store, session,
      {.jobs = options.jobs,
       .limits = {options.seconds, static_cast<std::size_t>(options.megabytes) << 20},
       .shard = shard,
       .only_failed = options.only == "failed",
       .progress = [&](const Tally& t, const Record* record) { progress.show(t, record); }});
  progress.finish(tally);
  if (tally.conflicts > 0)
    std::cerr << tally.conflicts << " cases gave another result than the one stored: see "
              << (store.root() / "conflicts").string() << '\n';
  if (tally.interrupted)
    std::cerr << "interrupted; the same command goes on where this one stopped\n";
  std::cerr << "store " << store.digest() << '\n';
  if (const int code = exit_code(tally); code != kPass) return code;
  if (tally.cases == 0 && options.only == "failed") std::cerr << "no stored failure to run again\n";
  if (!bare) {
    std::cout << options.out << '\n';
    return kPass;
  }
  maps(options);
  bench(options);
  prove(options);
  return report(options);
}

std::function<int()> bind(Arguments& arguments) {
  const auto options = std::make_shared<Options>();
  arguments.option("STUDY", options->studies,
                   "Names or paths of studies; none: the main job, preset quick, with its report");
  arguments.option("--preset", options->preset,
                   "A smaller or larger version that the study defines");
  arguments.option("-j,--jobs", options->jobs, "Cases at a time (default: one per core)")
      .range(1, 1024);
  arguments.option("--shard", options->shard,
                   "Only part i of n of the cases, as i/n (default: a Slurm array's, else all)");
  arguments.option("--only", options->only, "failed: run stored failures again, nothing else")
      .one_of({"failed"});
  arguments.option("--out", options->out, "Results folder (default: " + options->out + ")");
  arguments
      .option("--timeout", options->seconds,
              "CPU time limit of a case [s] (default: 120); wall time: five times that")
      .positive();
  arguments.option("--memory", options->megabytes, "Memory limit of a case [MB] (default: 2048)")
      .range(64.0, 1e9);
  arguments.flag("--no-report", options->no_report, "Run the main job without its report");
  return [options] { return run(*options); };
}

}  // namespace
}  // namespace taut::verb::run

TAUT_VERB(run) = {.name = "run",
                  .summary = "Runs studies, one process per case; resumes what was interrupted",
                  .example =
                      "taut run\n  taut run iterations --preset quick -j 2\n"
                      "  taut run my/study.toml --shard 1/4 --out results/shard1",
                  .bind = taut::verb::run::bind};
