#include "experiments/study/cluster/cluster.hpp"

#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/writer_mark.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::cluster {

namespace {

namespace fs = std::filesystem;
using namespace taut::cluster;

// submit

struct Submit {
  std::string study, preset, folder, on, node_file;
  std::vector<std::string> logins;
  int shards = 0;
  double hours = 0;
  Limits limits;
  bool dry_run = false, json = false;
};

/// The lines of `nodes`: what --sshlogin and --node-file say; "" if neither does.
std::string nodes_of(const Submit& o) {
  std::string nodes = o.node_file.empty() ? "" : read_text(o.node_file);
  for (const std::string& login : o.logins) nodes += login + '\n';
  if (o.on == "slurm" && !nodes.empty())
    throw InputError("--sshlogin and --node-file are for GNU parallel; Slurm knows its nodes");
  return nodes;
}

void share_out_as_asked(Manifest& manifest, const Submit& o) {
  const int cases = static_cast<int>(manifest.cases.size());
  if (o.shards > cases)
    throw InputError("--shards " + std::to_string(o.shards) + ": the study has only " +
                     std::to_string(cases) + " cases");
  manifest.shards = o.shards > 0 ? o.shards : shards_for(manifest, o.hours > 0 ? o.hours : 1);
  share_out(manifest);
}

void start(const fs::path& folder, Scheduler on) {
  const bool slurm = on == Scheduler::slurm;
  const std::string program = slurm ? "sbatch" : "parallel";
  if (!on_path(program))
    throw InputError(program + " is not installed here; the folder is written: start " +
                     (folder / "job.sh").string() + " where it is");
  if (!std::getenv("TAUT")) setenv("TAUT", this_program().c_str(), 1);
  Process job(
      slurm ? std::vector<std::string>{program, "job.sh"} : std::vector<std::string>{"./job.sh"},
      {.output = ProcessOptions::Stream::inherited,
       .errors = ProcessOptions::Stream::inherited,
       .folder = folder});
  const std::optional<ProcessEnd> end = job.wait();
  if (!end || !end->good())
    throw InputError(program + " refused or failed; the folder is written: " + folder.string());
}

int submit(const Submit& o) {
  const Study study = load_study(o.study, o.preset);
  const std::string nodes = nodes_of(o);
  const Scheduler on = o.on == "slurm" ? Scheduler::slurm : Scheduler::parallel;
  const fs::path folder =
      o.folder.empty() ? results_folder() / "cluster" / study.name : fs::path(o.folder);
  if (fs::exists(folder))
    throw InputError(folder.string() + " is already there: `taut cluster status " +
                     folder.string() + "`, or name another with --folder");
  fs::path there = folder.parent_path();  // what exists already of the folder's path
  while (!there.empty() && !fs::exists(there)) there = there.parent_path();
  make_folder(folder / "log");
  Manifest manifest;
  try {
    manifest = plan(study, o.limits, folder);
    if (manifest.cases.empty()) throw InputError("this study has no case");
    share_out_as_asked(manifest, o);
    write_durably(folder / "study.toml", read_text(study.file));
    write_durably(folder / "README", readme(manifest, on));
    if (!nodes.empty()) write_durably(folder / "nodes", nodes);
    write_durably(folder / "job.sh", job_script(manifest, on));
    fs::permissions(folder / "job.sh", fs::perms::owner_exec | fs::perms::group_exec,
                    fs::perm_options::add);
    write_durably(folder / "manifest.jsonl", manifest_text(manifest));
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    for (fs::path made = folder.parent_path(); made != there; made = made.parent_path())
      fs::remove(made, ignored);
    throw;
  }
  if (o.json)
    print_json({{"folder", folder.string()},
                {"cases", manifest.cases.size()},
                {"shards", manifest.shards},
                {"minutes", shard_minutes(manifest)},
                {"digest", manifest.digest}});
  else
    std::cout << folder.string() << ": " << manifest.cases.size() << " cases in " << manifest.shards
              << " shards of at most " << shard_minutes(manifest) << " minutes\n";
  if (!o.dry_run) start(folder, on);
  return kPass;
}

void add_options_submit(CLI::App& app, Submit& o) {
  app.add_option("STUDY", o.study, "Name or path of a study")->required();
  app.add_option("--on", o.on, "Who starts the shards: slurm or parallel")
      ->required()
      ->check(known("scheduler", {"slurm", "parallel"}));
  auto* shards = app.add_option("--shards", o.shards, "Parts of about equal work")
                     ->check(CLI::Range(1, kMostShards));
  app.add_option("--hours", o.hours, "As few shards as end within that time (default: 1)")
      ->check(above_zero())
      ->excludes(shards);
  add_preset(app, o.preset);
  app.add_option("--folder", o.folder,
                 "A new folder that all nodes see (default: " +
                     (results_folder() / "cluster/STUDY").string() + ")");
  app.add_option("--sshlogin", o.logins, "A node for GNU parallel, as [N/][user@]host; repeat it")
      ->delimiter(',');
  app.add_option("--node-file", o.node_file, "A file with a node on each line")
      ->check(CLI::ExistingFile);
  add_limits(app, o.limits);
  app.add_flag("--dry-run", o.dry_run, "Write the folder and start nothing");
  add_json(app, o.json, "Folder and sizes");
}

// run

struct Run {
  std::string folder, only;
  int shard = 0, jobs = 1;
};

int run(const Run& o) {
  const Manifest manifest = read_manifest(o.folder);
  const std::vector<Case> cases = taut::cluster::cases_of(manifest, o.shard, o.folder);
  const Store store(shard_folder(o.folder, o.shard));
  Attempt attempt(store.root());
  WriterMark::remove(store.file());  // whoever began this shard is gone
  store.prepare();
  store.begin_session("taut cluster run --shard " + std::to_string(o.shard),
                      {{manifest.study, cases}});
  Progress progress;
  const CampaignProgress campaign =
      run_cases(cases, store,
                {.jobs = o.jobs,
                 .limits = manifest.limits,
                 .only_failed = o.only == "failed",
                 .progress = [&](const CampaignProgress& t, const Record* record) {
                   attempt.progress(t);
                   progress.show(t, record);
                 }});
  attempt.end(campaign.interrupted ? "interrupted" : "all cases");
  progress.finish(campaign);
  return exit_code(campaign, store);
}

void add_options_run(CLI::App& app, Run& o) {
  app.add_option("DIR", o.folder, "The folder of `taut cluster submit`")->required();
  app.add_option("--shard", o.shard, "Which part, from 1 on")->required();
  app.add_option("--only", o.only, "failed: run stored failures again, nothing else")
      ->check(CLI::IsMember({"failed"}));
  app.add_option("-j,--jobs", o.jobs, "Cases at a time (default: 1)")->check(CLI::Range(1, 1024));
}

// status

/// The first ten.
void print_list(std::ostream& out, const std::string& word, const std::vector<std::string>& lines) {
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < std::min(kShown, lines.size()); ++i)
    out << word << ": " << lines[i] << '\n';
  if (lines.size() > kShown)
    out << word << ": " << lines.size() - kShown << " more (--json names all)\n";
}

std::string clock_text(double seconds) {
  const auto minutes = static_cast<long>(seconds / 60);
  return minutes < 1    ? "less than a minute"
         : minutes < 90 ? std::to_string(minutes) + " minutes"
                        : std::to_string((minutes + 30) / 60) + " hours";
}

std::string commands_of(const std::vector<int>& shards, const fs::path& folder) {
  const auto list = [&](const char* separator) {
    return join(shards, separator, [](int shard) { return std::to_string(shard); });
  };
  const bool slurm = read_text(folder / "job.sh").find("#SBATCH") != std::string::npos;
  return "cd " + shell_word(folder.string()) + " && " +
         (slurm ? "sbatch --array=" + list(",") + " job.sh" : "./job.sh " + list(" "));
}

Json to_json(const FolderStatus& all, const fs::path& folder) {
  const auto shard = [](const ShardStatus& one) -> Json {
    return {{"shard", one.shard},
            {"state", taut::cluster::to_string(one.state)},
            {"cases", one.cases},
            {"done", one.done},
            {"host", one.host}};
  };
  const auto failed = [](const FailedCase& one) -> Json {
    return {{"shard", one.shard}, {"id", one.id}, {"status", describe(one.status)}};
  };
  return {{"cases", all.cases},
          {"done", all.done},
          {"seconds", all.seconds() ? Json(*all.seconds()) : Json()},
          {"shards", json_array(all.shards, shard)},
          {"failed", json_array(all.failed, failed)},
          {"start", all.to_start()},
          {"command", all.to_start().empty() ? "" : commands_of(all.to_start(), folder)}};
}

void print(const FolderStatus& all, const fs::path& folder) {
  std::cout << all.done << "/" << all.cases << " cases";
  if (const auto seconds = all.seconds()) std::cout << ", left: " << clock_text(*seconds);
  std::cout << '\n';
  for (const ShardStatus& one : all.shards) {
    if (one.state == ShardStatus::State::done) continue;
    std::cout << "shard " << one.shard << ": " << taut::cluster::to_string(one.state) << ", "
              << one.done << "/" << one.cases << (one.host.empty() ? "" : ", on " + one.host)
              << '\n';
  }
  std::vector<std::string> failed;
  for (const FailedCase& one : all.failed)
    failed.push_back(one.id + " (shard " + std::to_string(one.shard) +
                     "): " + describe(one.status));
  print_list(std::cout, "failed", failed);
  if (!all.failed.empty())
    std::cout << "failures again: taut cluster run " << shell_word(folder.string()) << " --shard "
              << all.failed.front().shard << " --only failed\n";
  if (!all.to_start().empty())
    std::cout << "start again: " << commands_of(all.to_start(), folder) << '\n';
}

struct StatusOptions {
  std::string folder;
  bool json = false;
};

int status(const StatusOptions& o) {
  const FolderStatus all = status_of(read_manifest(o.folder), o.folder);
  if (o.json)
    print_json(to_json(all, o.folder));
  else
    print(all, o.folder);
  return all.complete() ? kPass : kIncomplete;
}

void add_options_status(CLI::App& app, StatusOptions& o) {
  app.add_option("DIR", o.folder, "The folder of `taut cluster submit`")->required();
  add_json(app, o.json, "Every shard and every failed case");
}

// merge

struct MergeOptions {
  std::vector<std::string> folders;
  std::string out;
  bool allow_missing = false, json = false;
};

int merge(const MergeOptions& o) {
  const Merge merge({o.folders.begin(), o.folders.end()});
  Store store(o.out);
  const MergePlan plan = merge.look(store);
  std::vector<std::string> missing;
  for (const PlannedKey& one : plan.missing)
    missing.push_back(one.id + " (shard " + std::to_string(one.shard) + ")");
  const bool may = plan.mergeable() && (missing.empty() || o.allow_missing) && !plan.cases.empty();
  if (may) {
    store.prepare();
    merge.copy(plan, store, Countdown("merging"));
    if (!missing.empty()) store.mark_missing(plan.missing);
  }
  print_list(std::cerr, "foreign", plan.foreign);
  print_list(std::cerr, "conflict", plan.conflicts);
  print_list(std::cerr, "missing", missing);
  if (o.json)
    print_json({{"cases", plan.cases.size()},
                {"there", plan.cases.size() - missing.size()},
                {"merged", may},
                {"missing", missing},
                {"foreign", plan.foreign},
                {"conflicts", plan.conflicts},
                {"store", store.digest()}});
  else
    std::cout << plan.cases.size() - missing.size() << "/" << plan.cases.size() << " cases"
              << (may ? "" : "; nothing was merged") << "\nstore " << store.digest() << '\n';
  if (!plan.foreign.empty()) return kUsage;
  if (!plan.conflicts.empty()) return kConflict;
  if (plan.cases.empty()) return kNothing;
  return missing.empty() ? kPass : kIncomplete;
}

void add_options_merge(CLI::App& app, MergeOptions& o) {
  app.add_option("DIR", o.folders,
                 "Folders of `taut cluster submit`, or results folders of `taut run --shard`")
      ->required();
  add_results(app, o.out);
  app.add_flag("--allow-missing", o.allow_missing,
               "Merge although planned cases are missing; reports say so");
  add_json(app, o.json, "What is there, what is missing, foreign or in conflict");
}

}  // namespace
}  // namespace taut::verb::cluster

TAUT_VERB(cluster) = {.name = "cluster",
                      .group = VerbGroup::studies,
                      .summary = "Runs a study on many machines: submit, status, merge",
                      .example =
                          "taut cluster submit iterations --on slurm --shards 8\n"
                          "  taut cluster status results/cluster/iterations\n"
                          "  taut cluster merge results/cluster/iterations"};

TAUT_VERB(cluster_submit) = {
    .name = "cluster submit",
    .summary = "Writes a folder with all that the nodes need, and starts its shards",
    .example =
        "taut cluster submit iterations --on slurm --hours 2\n  taut cluster submit "
        "my/study.toml --on parallel --sshlogin a,b --shards 8 --dry-run",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_submit, taut::verb::cluster::submit>};

TAUT_VERB(cluster_run) = {
    .name = "cluster run",
    .summary = "Runs one shard, or goes on with it: what the job scripts call",
    .example = "taut cluster run results/cluster/iterations --shard 3",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_run, taut::verb::cluster::run>};

TAUT_VERB(cluster_status) = {
    .name = "cluster status",
    .summary = "Done, running, failed and lost shards, and the command that starts them again",
    .example = "taut cluster status results/cluster/iterations",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_status, taut::verb::cluster::status>};

TAUT_VERB(cluster_merge) = {
    .name = "cluster merge",
    .summary = "Unites results, if none is missing, foreign or in conflict; else says which",
    .example =
        "taut cluster merge results/cluster/iterations\n"
        "  taut cluster merge results/shard1 results/shard2 --out results/runs",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_merge, taut::verb::cluster::merge>};
