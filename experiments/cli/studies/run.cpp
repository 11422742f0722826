#include <cstdlib>
#include <iterator>
#include <map>

#include "core/model/text.hpp"
#include "experiments/baseline/check.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/page.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/steps/one_step.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/main_job.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/study_bench.hpp"
#include "experiments/truths/verify.hpp"

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

/// The study at these time steps, under a name that says so: its own results stay as planned.
Study at_time_steps(Study study, const std::vector<std::string>& steps) {
  if (steps.empty()) return study;
  const auto is_step = [](const std::string& setting) { return setting.starts_with("time.dt="); };
  std::erase_if(study.settings, is_step);
  std::erase_if(study.axes, [](const StudyAxis& axis) { return axis.name == "time.dt"; });
  StudyAxis axis{.name = "time.dt", .values = {}};
  for (const std::string& step : steps) axis.values.push_back('"' + step + '"');
  study.axes.insert(study.axes.begin(), std::move(axis));
  study.name += " dt=" + join(steps, ",");
  return study;
}

std::vector<Study> load_studies(const Options& options) {
  std::vector<Study> studies;
  read_all(options.studies, [&](const std::string& name) {
    studies.push_back(at_time_steps(load_study_to_plot(name, options.preset), options.steps));
  });
  return studies;
}

std::vector<StudyCases> all_cases(const std::vector<Study>& studies) {
  std::vector<StudyCases> all;
  read_all(studies, [&](const Study& study) { all.push_back({study.name, cases_of(study)}); });
  return all;
}

/// The main job's six parts, the first of them the cases.
void say_part(int part, const std::string& what) {
  progress() << "part " << part << " of 6: " << what << '\n';
}

/// What accuracy costs: exclusive, so after everything else has ended. A machine too noisy to judge
/// still gives numbers; the report shows how noisy. Then truths and baselines: what the report says
/// besides the studies. It says which one failed, too, so the run goes on. Returns the answer in a
/// few lines, and where the page is.
std::string finish_main_job(const MainJob& job, const Options& options) {
  Store store(options.out);
  say_part(2, "what accuracy costs, one case at a time");
  require_one_quiet_host();
  const Study trade = load_study(job.bench, job.preset);
  keep(store,
       bench_study(trade.name, run_and_collect({trade.name, cases_of(trade)}, store, "taut bench"),
                   [](const std::string& scene, std::size_t cases) {
                     progress() << scene << ": timing " << cases << " cases\n";
                     return TimingOptions{.seconds = 0.015, .progress = Countdown("timing round")};
                   }));
  for (const std::string& scene : job.steps) {
    say_part(3, "inside one step of " + scene);
    const StudyScene chosen = parse_scene(scene);
    store.keep(one_step({.scene = chosen.name,
                         .settings = chosen.settings,
                         .solvers = load_study(job.studies.front(), options.preset).solvers}));
  }
  say_part(4, "solvers beside closed forms and published numbers");
  store.keep(answer_of(taut::verify(
      {.truths = truths_in_order(), .jobs = options.jobs, .progress = Countdown("truth")})));
  say_part(5, "the committed baselines");
  BaselineOptions baselines = baseline_options();
  baselines.baselines = results_folder() / "baselines";
  baselines.out = options.out;
  baselines.jobs = options.jobs;
  const Check compared = check_studies({}, baselines);
  if (compared.end == CheckEnd::interrupted) throw Interrupted();
  if (compared.cases > 0) store.keep(compared.answer);
  if (!options.json) print(compared.answer, {});
  say_part(6, "the page and its films");
  const std::filesystem::path file = std::filesystem::absolute("report.html").lexically_normal();
  const Page page = make_page({.preset = options.preset == job.preset ? "" : options.preset,
                               .results = options.out,
                               .output = file.string()});
  write_file(file.string(), page.text);
  return join(page.in_few_lines, "", [](const std::string& line) { return line + "\n"; }) +
         file.string() + "\n";
}

/// What tells the cases of one scene apart: "jakobsen:iterations=4 dt=1/120".
std::string setting_of(const Case& one, const Study& study) {
  std::vector<std::string> shared = study.settings;
  for (const std::string& scene : study.scenes)
    std::ranges::copy(parse_scene(scene).settings, std::back_inserter(shared));
  std::string text = one.choice.brief();
  for (const std::string& change : one.spec.overrides)
    if (std::ranges::find(shared, change) == shared.end()) text += " " + change;
  return text;
}

/// A failure, and an extreme, is its status; a value of an unsettled case has a note.
Cell cell(const Record& record, const std::string& value) {
  if (!completed(record.status)) return to_string(record.status.kind);
  Cell number(record.value(value));
  number.key = record.key;
  return record.status.kind == Status::Kind::unsettled ? number.with("~") : number;
}

/// A metric's value: a row per setting, a column per scene, both in the order of the study.
Table table_of(const Study& study, const Store& store, const std::string& value,
               const std::string& name) {
  const std::vector<Case> cases = cases_of(study);
  Table table{name, "", {{"setting", value}}};
  const auto scenes = distinct(cases, [](const Case& c) { return c.scene->name; });
  for (const std::string& scene : scenes)
    table.columns.emplace_back(scene, scene, unit_of_value(value));
  const auto settings = distinct(cases, [&](const Case& c) { return setting_of(c, study); });
  for (const std::string& setting : settings) {
    table.rows.emplace_back(scenes.size() + 1);
    table.rows.back()[0] = setting;
  }
  for (const Case& one : cases)
    if (const auto record = store.find(one)) {
      const auto row = std::ranges::find(settings, setting_of(one, study)) - settings.begin();
      const auto column = std::ranges::find(scenes, one.scene->name) - scenes.begin();
      table.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column) + 1] =
          cell(*record, value);
    }
  return table;
}

/// How the cases ended, and the values that were asked for of every study.
Answer answer_of(const CampaignProgress& campaign, const std::vector<Study>& studies,
                 const Options& options, const Store& store) {
  Answer answer{"run", ""};
  answer.add(Column("results").in_detail(), options.out);
  answer.add(Column("store").in_detail(), store.digest());
  answer.add(Column("cases").in_detail(), campaign.cases);
  answer.add(Column("ran").in_detail(), campaign.ran);
  answer.add(Column("stored").in_detail(), campaign.reused);
  Table statuses{"statuses", "", {{"status"}, {"cases"}}};
  for (const auto& [kind, count] : campaign.by_status)
    statuses.rows.push_back({to_string(kind), count});
  statuses.detail = true;
  answer.add(std::move(statuses));
  for (const Study& study : studies)
    for (const std::string& value : options.values)
      answer.add(
          table_of(study, store, value, studies.size() > 1 ? study.name + " " + value : value));
  return answer;
}

/// A line for each study: how many cases it has and how they ended.
void print_studies(const std::vector<Study>& studies, const Store& store) {
  for (const Study& study : studies) {
    const std::vector<Record> records = collect(study, store).records;
    std::map<Status::Kind, std::size_t> ends;
    for (const Record& r : records) ++ends[r.status.kind];
    const std::string unequal = report::unequal_work(records);
    progress() << study.name << ": " << records.size() << " cases: "
               << join(ends, ", ",
                       [](const auto& end) {
                         return std::string(to_string(end.first)) + " " +
                                std::to_string(end.second);
                       })
               << (unequal.empty() ? "" : "; unequal work: " + unequal) << '\n';
  }
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

/// On the files of all scenes, each once.
std::vector<std::string> remarks_of(const std::vector<StudyCases>& studies) {
  std::vector<std::string> all;
  for (const StudyCases& study : studies)
    for (const Case& one : study.cases)
      for (const std::string& remark : one.remarks) push_unique(all, remark);
  return all;
}

int run(Options options) {
  const bool bare = options.studies.empty();
  const MainJob job = bare ? main_job() : MainJob{};
  if (bare) {
    options.studies = job.studies;
    options.studies.insert(options.studies.end(), job.maps.begin(), job.maps.end());
    if (options.preset.empty()) options.preset = job.preset;
  }
  const Shard shard = Shard::parse(options.shard);
  if (!options.build.empty()) setenv("TAUT_BUILD_ID", options.build.c_str(), 1);
  given_build();  // is one
  const std::vector<Study> studies = load_studies(options);
  const std::vector<StudyCases> cases = all_cases(studies);
  if (std::ranges::all_of(cases, [](const StudyCases& one) { return one.cases.empty(); })) {
    std::cerr << "these studies have no case: their exclusions leave out all\n";
    return kNothing;
  }
  tell_remarks(remarks_of(cases));
  Store store(options.out);
  store.prepare();
  if (bare && !options.no_report) {
    std::size_t all = 0;
    for (const StudyCases& study : cases) all += study.cases.size();
    progress()
        << "the main job: " << all << " cases of " << cases.size()
        << " studies, then their costs, closed forms, baselines and films; five to six minutes on "
           "two idle cores, and it may be interrupted\n";
    say_part(1, "cases of the studies");
  }
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
  print_studies(studies, store);
  const std::string found = bare && !options.no_report ? finish_main_job(job, options) : "";
  if (!options.values.empty() || options.json)
    print(answer_of(campaign, studies, options, store), {.json = options.json});
  else if (!bare || options.no_report)
    std::cout << options.out << '\n';
  print_next(options, studies.front(), bare);
  if (!options.json) std::cout << found;
  return kPass;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("STUDY", options.studies,
                 "Names or paths of studies; none: the main job, preset quick, with its report");
  add_preset(app, options.preset);
  add_jobs(app, options.jobs);
  app.add_option("--shard", options.shard,
                 "Only part i of n of the cases, as i/n (default: a Slurm array's, else all)");
  app.add_option("--only", options.only, "failed: run stored failures again, nothing else")
      ->check(CLI::IsMember({"failed"}));
  add_results(app, options.out);
  app.add_option(
      "--build-id", options.build,
      "Which build this is of taut and of the external programs, for taut history: ID or "
      "ID@TIME, as 1.2.0@2026-05-04; programs' results are addressed by it in place of "
      "their files");
  add_limits(app, options.limits);
  app.add_option("--dt", options.steps,
                 "Time step [s] in place of those of the study, as 1/30; repeat it to compare two, "
                 "with --table")
      ->allow_extra_args(false)
      ->needs("STUDY");
  app.add_option("--table", options.values,
                 "Then print this value of a metric, settings by scenes; repeat it for each")
      ->allow_extra_args(false)
      ->check(metric_value());
  app.add_flag("--verbose", options.verbose, "A line for each case as it ends");
  app.add_flag("--no-report", options.no_report, "Run the main job without its report");
  add_json(app, options.json, "How the cases ended, and the tables,");
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
                  .answer =
                      "results store cases ran stored; "
                      "statuses: status cases; "
                      "*: setting *",
                  .bind = taut::bind_verb<taut::verb::run::add_options, taut::verb::run::run>};
