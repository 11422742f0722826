#include <cstdlib>

#include "experiments/command_line/main_job_end.hpp"
#include "experiments/command_line/study_options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/questions/failure_map.hpp"
#include "experiments/report/run_answer.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::run {

namespace {

struct Options {
  std::vector<std::string> studies, values, steps;
  std::string preset, shard, only, out, build;
  int jobs = 1;
  Limits limits;
  bool no_report = false, json = false, verbose = false;
};

std::string command_line(const Options& options) {
  std::string text = "taut run";
  for (const std::string& study : options.studies) text += " " + shell_word(study);
  if (!options.preset.empty()) text += " --preset " + options.preset;
  if (!options.shard.empty()) text += " --shard " + options.shard;
  if (!options.only.empty()) text += " --only " + options.only;
  for (const std::string& step : options.steps) text += " --dt " + step;
  if (!options.build.empty()) text += " --build-id " + shell_word(options.build);
  return text;
}

void print_next(const Options& options, const Study& leading, bool bare) {
  std::string which;
  for (const std::string& study : options.studies)
    if (!bare) which += " " + shell_word(study);
  const std::string first = shell_word(options.studies.front());
  const std::string more = options.preset.empty() ? "" : " --preset " + options.preset;
  const std::string in =
      options.out == default_results() ? "" : " --out " + shell_word(options.out);
  progress() << "next: "
             << (bare && !options.no_report ? "open report.html"
                                            : "taut report" + which + more + in)
             << "\n      taut plot " << first << more
             << (leading.plots.empty() ? " --kind series" : "") << in << "\n      taut export "
             << first << more << in << " -o table.csv\n";
}

int run(Options options) {
  const bool bare = options.studies.empty();
  const MainJob job = bare ? main_job() : MainJob{};
  if (bare) {
    options.studies = job.studies_to_run();
    if (options.preset.empty()) options.preset = job.preset;
  }
  const Shard shard = Shard::parse(options.shard);
  if (!options.build.empty()) setenv("TAUT_BUILD_ID", options.build.c_str(), 1);
  given_build();  // throws InputError if the text names no valid build
  const std::vector<Study> studies =
      load_studies_to_plot(options.studies, options.preset, options.steps);
  const std::vector<StudyCases> cases = cases_of_each(studies);
  if (std::ranges::all_of(cases, [](const StudyCases& one) { return one.cases.empty(); })) {
    std::cerr << "these studies have no case: their exclusions leave out all\n";
    return kNothing;
  }
  tell_remarks(remarks_of(cases));
  Store store(options.out);
  store.prepare();
  if (bare && !options.no_report) tell_main_job(cases);
  const CampaignProgress campaign = run_missing(cases, store, command_line(options),
                                                {.jobs = options.jobs,
                                                 .limits = options.limits,
                                                 .shard = shard,
                                                 .only_failed = options.only == "failed"},
                                                options.verbose);
  const int ended = exit_code(campaign, store);
  if (campaign.interrupted)
    std::cerr << "interrupted; the same command goes on where this one stopped\n";
  progress() << "store " << store.digest() << '\n';
  if (ended != kPass) return ended;
  if (campaign.cases == 0 && options.only == "failed")
    progress() << "no stored failure to run again\n";
  for (const Study& study : studies) progress() << report::ends_of(study, store) << '\n';
  const std::string found = bare && !options.no_report
                                ? end_main_job(job, {.preset = options.preset,
                                                     .results = options.out,
                                                     .jobs = options.jobs,
                                                     .print_check = !options.json})
                                : "";
  if (!options.values.empty() || options.json)
    print(report::run_answer(campaign, studies, options.values, store), {.json = options.json});
  else if (!bare || options.no_report)
    std::cout << options.out << '\n';
  print_next(options, studies.front(), bare);
  if (!options.json) std::cout << found;
  return kPass;
}

void add_options(Arguments& args, Options& options) {
  args.add_option("STUDY", options.studies,
                  "Names or paths of studies; none: the main job, preset quick, with its report");
  add_preset(args, options.preset);
  add_jobs(args, options.jobs);
  args.add_option(
      "--shard", options.shard,
      "Only part i of n of the cases, as i/n (default: this task's part of a Slurm array, else "
      "all)");
  args.add_option("--only", options.only, "failed: run stored failures again, nothing else")
      .check(only("failed"));
  add_results(args, options.out);
  args.add_option(
      "--build-id", options.build,
      "Names this build of taut and of the external programs for taut history: ID or ID@TIME, as "
      "1.2.0@2026-05-04; a program's results then belong to this build, not to its files");
  add_limits(args, options.limits);
  args.add_option(
          "--dt", options.steps,
          "Time step [s], such as 1/30, in place of the study's own; repeat it to compare several "
          "with --table")
      .one_each()
      .needs("STUDY");
  args.add_option(
          "--table", options.values,
          "Then print a table, settings by scenes, of this metric value; or failure_map: which "
          "solver is right at which stiffness; repeat it for each")
      .one_each()
      .check(either(metric_value(), only(report::kFailureMap)));
  args.add_flag("--verbose", options.verbose, "A line for each case as it ends");
  args.add_flag("--no-report", options.no_report, "Run the main job without its report");
  add_json(args, options.json, "how the cases ended, and the tables,");
}

}  // namespace
}  // namespace taut::verb::run

TAUT_VERB(run) = {.name = "run",
                  .group = VerbGroup::studies,
                  .summary = "Runs studies, one process per case; resumes what was interrupted",
                  .example =
                      "taut run\n  taut run iterations --preset quick -j 2\n"
                      "  taut run default-setting --table stretch.rms --table stretch.max\n"
                      "  taut run default-setting --dt 1/30 --dt 1/60 --table stretch.rms\n"
                      "  taut run my/study.toml --shard 1/4 --out results/shard1",
                  .answer = {{"facts", "results store cases ran stored"},
                             {"statuses", "status cases"},
                             {"failure_map", "solver *"},
                             {"*", "setting *"}},
                  .bind = taut::bind_verb<taut::verb::run::add_options, taut::verb::run::run>};
