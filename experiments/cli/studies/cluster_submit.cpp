#include "core/io/text_file.hpp"
#include "core/model/text.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/process.hpp"

namespace taut::verb::cluster_submit {

namespace {

namespace fs = std::filesystem;
using namespace taut::cluster;

struct Options {
  std::string study, preset, folder, on, node_file;
  std::vector<std::string> logins;
  int shards = 0;
  double hours = FolderRequest{}.hours;
  Limits limits;
  bool dry_run = false;
  Format format;
};

/// The lines of the file `nodes`, from --sshlogin and --node-file; "" without either.
std::string nodes_of(const Options& o, Scheduler on) {
  std::string nodes = o.node_file.empty() ? "" : read_text(o.node_file);
  for (const std::string& login : o.logins) nodes += login + '\n';
  if (on == Scheduler::slurm && !nodes.empty())
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

int run(const Options& o) {
  const Study study = load_study(o.study, o.preset);
  const Scheduler on = scheduler_named(o.on).value();
  const std::string nodes = nodes_of(o, on);
  const fs::path folder =
      o.folder.empty() ? results_folder() / "cluster" / study.name : fs::path(o.folder);
  if (fs::exists(folder))
    throw InputError(folder.string() + " already exists: `taut cluster status " + folder.string() +
                     "`, or name another with --folder");
  const Plan made = write_folder(folder, {.study = study,
                                          .limits = o.limits,
                                          .shards = o.shards,
                                          .hours = o.hours,
                                          .on = on,
                                          .nodes = nodes});
  Answer answer{"cluster submit", study.name};
  answer.add({"folder"}, folder.string());
  answer.add({"cases"}, made.cases);
  answer.add({"shards"}, made.shards);
  answer.add({"minutes", "limit of a shard", {Unit::Kind::time, "min", "min"}},
             shard_minutes(made));
  print(answer, o.format);
  if (!o.dry_run) start(folder, on);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  add_study(args, o.study).required();
  args.add_option("--on", o.on, "Who starts the shards: slurm or parallel")
      .required()
      .check(known("scheduler", {"slurm", "parallel"}));
  args.add_option("--shards", o.shards, "How many shards").check(in_range(1, kMostShards));
  args.add_option(
          "--hours", o.hours,
          "The fewest shards that end within that time (default: " + as_typed(o.hours) + ")")
      .check(above_zero())
      .excludes("--shards");
  add_preset(args, o.preset);
  args.add_option("--folder", o.folder,
                  "A new folder that all nodes see (default: " +
                      (results_folder() / "cluster/STUDY").string() + ")");
  args.add_option("--sshlogin", o.logins, "A node for GNU parallel, as [N/][user@]host; repeat it")
      .delimiter(',');
  args.add_option("--node-file", o.node_file, "A file with a node on each line")
      .check(existing_file());
  add_limits(args, o.limits);
  args.add_flag("--dry-run", o.dry_run, "Write the folder and start nothing");
  add_json(args, o.format.json, "the folder and its sizes");
}

}  // namespace
}  // namespace taut::verb::cluster_submit

TAUT_VERB(cluster_submit) = {
    .name = "cluster submit",
    .summary = "Writes a folder with all that the nodes need, and starts its shards",
    .example =
        "taut cluster submit iterations --on slurm --hours 2\n  taut cluster submit "
        "my/study.toml --on parallel --sshlogin a,b --shards 8 --dry-run",
    .answer = {{"facts", "folder cases shards minutes"}},
    .bind =
        taut::bind_verb<taut::verb::cluster_submit::add_options, taut::verb::cluster_submit::run>};
