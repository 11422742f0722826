#include <iterator>
#include <map>

#include "experiments/case/record_io.hpp"
#include "experiments/cli/calls.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/main_job.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut::verb::run {

namespace {

struct Options {
  std::vector<std::string> studies, values;
  std::string preset, shard, only, out;
  int jobs = 1;
  Limits limits;
  bool no_report = false, json = false;
};

std::string command_line(const Options& options) {
  std::string text = "taut run";
  for (const std::string& study : options.studies) text += " " + shell_word(study);
  if (!options.preset.empty()) text += " --preset " + options.preset;
  if (!options.shard.empty()) text += " --shard " + options.shard;
  if (!options.only.empty()) text += " --only " + options.only;
  return text;
}

std::vector<Study> load_studies(const Options& options) {
  std::vector<Study> studies;
  read_all(options.studies, [&](const std::string& name) {
    studies.push_back(load_study_to_plot(name, options.preset));
  });
  return studies;
}

std::vector<StudyCases> all_cases(const std::vector<Study>& studies) {
  std::vector<StudyCases> all;
  read_all(studies, [&](const Study& study) { all.push_back({study.name, cases_of(study)}); });
  return all;
}

/// What accuracy costs: exclusive, so after everything else has ended. A machine too noisy to judge
/// still gives numbers; the report shows how noisy. Then truths and baselines: what the report says
/// besides the studies. It says which one failed, too, so the run goes on.
int finish_main_job(const MainJob& job, const Options& options) {
  bench::time_study(job.bench, job.preset, 0.015, options.out);
  progress() << "holding solvers to closed forms and published numbers\n";
  Store(options.out).keep(verify::verify_all(options.jobs));
  progress() << "comparing with the committed baselines\n";
  const Answer compared = check::check_all(options.jobs, options.out);
  if (!options.json) print(compared, {});
  const std::string page =
      reporting::report_main_job(options.preset == job.preset ? "" : options.preset, options.out);
  if (!options.json) std::cout << page << '\n';
  return kPass;
}

Json to_json(const CampaignProgress& campaign, const Options& options, const Store& store) {
  Json all{{"results", options.out}, {"store", store.digest()},   {"cases", campaign.cases},
           {"ran", campaign.ran},    {"stored", campaign.reused}, {"statuses", Json::object()}};
  for (const auto& [kind, count] : campaign.by_status) all["statuses"][to_string(kind)] = count;
  return all;
}

/// What tells the cases of one scene apart: "jakobsen:iterations=4 dt=1/120".
std::string setting_of(const Case& one, const Study& study) {
  std::string text = one.choice.brief();
  for (const std::string& change : one.spec.overrides)
    if (std::ranges::find(study.settings, change) == study.settings.end()) text += " " + change;
  return text;
}

std::string cell(const Record& record, const std::string& value) {
  if (!completed(record.status)) return std::string(to_string(record.status.kind));
  return number_text(record.value(value)) +
         (record.status.kind == Status::Kind::unsettled ? " ~" : "");
}

/// The cases of a study by setting and scene.
using ByCell = std::map<std::pair<std::string, std::string>, Record>;

/// A metric's value with three digits: a line per setting, a column per scene, both in the order of
/// the study. A failure, and an extreme, prints its status, a value without a meaning "-", one of
/// an unsettled case a "~".
void print_table(const Study& study, const std::vector<Case>& cases, const ByCell& records,
                 const std::string& value) {
  std::vector<Row> rows{{value}};
  for (const std::string& scene : distinct(cases, [](const Case& c) { return c.scene->name; }))
    rows[0].push_back(scene);
  for (const auto& setting : distinct(cases, [&](const Case& c) { return setting_of(c, study); })) {
    Row row{setting};
    for (std::size_t i = 1; i < rows[0].size(); ++i) {
      const auto at = records.find({row[0], rows[0][i]});
      row.push_back(at == records.end() ? "" : cell(at->second, value));
    }
    rows.push_back(std::move(row));
  }
  print_columns(rows, 1);
  std::cout << '\n';
}

/// The values that were asked for, of every study.
void print_tables(const std::vector<Study>& studies, const Options& options, const Store& store) {
  Json all = Json::array();
  for (const Study& study : studies) {
    ByCell records;
    const std::vector<Case> cases = cases_of(study);
    for (const Case& one : cases)
      if (auto record = store.find(one)) records[{setting_of(one, study), record->scene}] = *record;
    if (!options.json)
      for (const std::string& value : options.values) print_table(study, cases, records, value);
    for (const auto& [where, record] : records) {
      all.push_back({{"setting", where.first},
                     {"scene", where.second},
                     {"status", to_string(record.status.kind)}});
      for (const std::string& value : options.values)
        if (record.values.contains(value))
          all.back()["values"][value] = record.value(value);  // NaN becomes null
    }
  }
  if (options.json) print_json(all);
}

void print_unequal_work(const std::vector<Study>& studies, const Store& store) {
  for (const Study& study : studies) {
    const std::vector<Record> records = collect(study, store).records;
    if (const std::string unequal = report::unequal_work(records); !unequal.empty())
      progress() << study.name << ": unequal work: " << unequal << '\n';
  }
}

void print_next(const Options& options, bool bare) {
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
             << "\n      taut plot " << first << more << in << "\n      taut export " << first
             << more << in << " -o table.csv\n";
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
  const std::vector<Study> studies = load_studies(options);
  const std::vector<StudyCases> cases = all_cases(studies);
  if (std::ranges::all_of(cases, [](const StudyCases& one) { return one.cases.empty(); })) {
    std::cerr << "these studies have no case: their exclusions leave out all\n";
    return kNothing;
  }
  const Store store(options.out);
  store.prepare();
  const CampaignProgress campaign = run_missing(cases, store, command_line(options),
                                                {.jobs = options.jobs,
                                                 .limits = options.limits,
                                                 .shard = shard,
                                                 .only_failed = options.only == "failed"});
  const int ended = exit_code(campaign, store);
  if (campaign.interrupted)
    std::cerr << "interrupted; the same command goes on where this one stopped\n";
  progress() << "store " << store.digest() << '\n';
  if (ended != kPass) return ended;
  if (campaign.cases == 0 && options.only == "failed")
    progress() << "no stored failure to run again\n";
  if (bare && !options.no_report)
    if (const int code = finish_main_job(job, options); code != kPass) return code;
  if (!options.values.empty())
    print_tables(studies, options, store);
  else if (options.json)
    print_json(to_json(campaign, options, store));
  else if (!bare || options.no_report)
    std::cout << options.out << '\n';
  print_unequal_work(studies, store);
  print_next(options, bare);
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
  add_limits(app, options.limits);
  app.add_option("--table", options.values,
                 "Then print this value of a metric, settings by scenes; repeat it for each")
      ->allow_extra_args(false)
      ->check(metric_value());
  app.add_flag("--no-report", options.no_report, "Run the main job without its report");
  add_json(app, options.json, "How the cases ended, or the tables,");
}

}  // namespace
}  // namespace taut::verb::run

TAUT_VERB(run) = {.name = "run",
                  .group = VerbGroup::studies,
                  .summary = "Runs studies, one process per case; resumes what was interrupted",
                  .example =
                      "taut run\n  taut run iterations --preset quick -j 2\n"
                      "  taut run default-setting --table stretch.rms --table energy.drift\n"
                      "  taut run my/study.toml --shard 1/4 --out results/shard1",
                  .bind = taut::bind_verb<taut::verb::run::add_options, taut::verb::run::run>};
