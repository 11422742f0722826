#include "experiments/study/cluster/cluster.hpp"

#include "core/io/text_file.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
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
  bool dry_run = false;
  Format format;
};

/// The lines of `nodes`: what --sshlogin and --node-file say; "" if neither does.
std::string nodes_of(const Submit& o) {
  std::string nodes = o.node_file.empty() ? "" : read_text(o.node_file);
  for (const std::string& login : o.logins) nodes += login + '\n';
  if (o.on == "slurm" && !nodes.empty())
    throw InputError("--sshlogin and --node-file are for GNU parallel; Slurm knows its nodes");
  return nodes;
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
  const std::vector<Case> cases = cases_of(study);
  Plan made;
  try {
    made = plan(study, cases, o.limits, o.shards, o.hours > 0 ? o.hours : 1);
    make_folder(folder / "log"), make_folder(folder / "shards");
    copy_scenes(cases, folder);
    write_durably(folder / (study.name + ".toml"), read_text(study.file));
    write_durably(folder / "README", readme(made, on));
    if (!nodes.empty()) write_durably(folder / "nodes", nodes);
    write_durably(folder / "job.sh", job_script(made, on));
    fs::permissions(folder / "job.sh", fs::perms::owner_exec | fs::perms::group_exec,
                    fs::perm_options::add);
    Store(folder).begin_session("taut cluster submit", {{study.name, cases}}, {1, made.shards});
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    for (fs::path parent = folder.parent_path(); parent != there; parent = parent.parent_path())
      fs::remove(parent, ignored);
    throw;
  }
  Answer answer{"cluster submit", study.name};
  answer.add({"folder"}, folder.string());
  answer.add({"cases"}, made.cases);
  answer.add({"shards"}, made.shards);
  answer.add({"minutes", "limit of a shard", {"min", "min"}}, shard_minutes(made));
  print(answer, o.format);
  if (!o.dry_run) start(folder, on);
  return kPass;
}

void add_options_submit(CLI::App& app, Submit& o) {
  app.add_option("STUDY", o.study, "Name or path of a study")->required();
  app.add_option("--on", o.on, "Who starts the shards: slurm or parallel")
      ->required()
      ->check(known("scheduler", {"slurm", "parallel"}));
  auto* shards = app.add_option("--shards", o.shards, "Parts")->check(CLI::Range(1, kMostShards));
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
  add_json(app, o.format.json, "Folder and sizes");
}

// status

struct StatusOptions {
  std::string folder;
  Format format;
};

int status(const StatusOptions& o) {
  const Answer answer = status_of(o.folder);
  print(answer, o.format);
  return answer.fact("done") == answer.fact("cases") ? kPass : kIncomplete;
}

void add_options_status(CLI::App& app, StatusOptions& o) {
  app.add_option("DIR", o.folder, "The folder of `taut cluster submit`")->required();
  add_format(app, o.format, "Every shard and every failed case");
}

// merge

struct MergeOptions {
  std::vector<std::string> folders;
  std::string out;
  bool allow_missing = false;
  Format format;
};

Table sentences(const char* name, const std::vector<std::string>& lines) {
  Table table{name, name, {{"case"}}};
  for (const std::string& line : lines) table.rows.push_back({line});
  table.most = 10;
  return table;
}

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
  Answer answer{"cluster merge", o.out};
  answer.add({"cases"}, plan.cases.size());
  answer.add({"there"}, plan.cases.size() - missing.size());
  answer.add({"merged"}, may);
  if (store.reading()) answer.add({"store"}, store.digest());
  answer.add(sentences("missing", missing));
  answer.add(sentences("foreign", plan.foreign));
  answer.add(sentences("conflicts", plan.conflicts));
  print(answer, o.format);
  const auto tell = [](const char* what, const std::vector<std::string>& all) {
    std::cerr << "not merged: " << all.size() << ' ' << what << ", the first: " << all.front()
              << '\n';
  };
  if (!plan.foreign.empty()) return tell("foreign", plan.foreign), kUsage;
  if (!plan.conflicts.empty()) return tell("in conflict", plan.conflicts), kConflict;
  if (plan.cases.empty()) return kNothing;
  if (!may) tell("missing", missing);
  return missing.empty() ? kPass : kIncomplete;
}

void add_options_merge(CLI::App& app, MergeOptions& o) {
  app.add_option("DIR", o.folders,
                 "Folders of `taut cluster submit`, or results folders of `taut run --shard`")
      ->required();
  add_results(app, o.out);
  app.add_flag("--allow-missing", o.allow_missing,
               "Merge although planned cases are missing; reports say so");
  add_format(app, o.format, "All that is missing, foreign or in conflict");
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
    .answer = "folder cases shards minutes",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_submit, taut::verb::cluster::submit>};

TAUT_VERB(cluster_status) = {
    .name = "cluster status",
    .summary = "Done and failed cases of every shard, and the command that starts the rest",
    .example = "taut cluster status results/cluster/iterations",
    .answer =
        "cases done start again; "
        "shards: shard state cases done host started; "
        "failed: shard case status",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_status, taut::verb::cluster::status>};

TAUT_VERB(cluster_merge) = {
    .name = "cluster merge",
    .summary = "Unites results, if none is missing, foreign or in conflict; else says which",
    .example =
        "taut cluster merge results/cluster/iterations\n"
        "  taut cluster merge results/shard1 results/shard2 --out results/runs",
    .answer =
        "cases there merged store; "
        "missing: case; "
        "foreign: case; "
        "conflicts: case",
    .bind = taut::bind_verb<taut::verb::cluster::add_options_merge, taut::verb::cluster::merge>};
