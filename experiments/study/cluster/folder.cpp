#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/io/document.hpp"
#include "core/io/scene_files.hpp"
#include "core/io/text_file.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/names.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/results/database.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut::cluster {

namespace fs = std::filesystem;

namespace {

// Estimate of memory. Measured: a case of a few hundred vertices takes 15 MB.
constexpr std::size_t kProgramBytes = std::size_t{64} << 20, kElementBytes = 2048;

constexpr Names<Scheduler::parallel> kSchedulers{"slurm", "parallel"};

/// File of a folder with the name of its scheduler.
constexpr const char* kSchedulerFile = "scheduler";

/// The scheduler that a folder was written for.
Scheduler scheduler_of(const fs::path& folder) {
  const fs::path file = folder / kSchedulerFile;
  if (!fs::exists(file)) {  // of an earlier taut: only its script tells
    const bool slurm = read_text(folder / "job.sh").find("\n#SBATCH") != std::string::npos;
    return slurm ? Scheduler::slurm : Scheduler::parallel;
  }
  std::string name = read_text(file);
  while (name.ends_with('\n')) name.pop_back();
  if (const auto scheduler = scheduler_named(name)) return *scheduler;
  throw InputError(file.string() + ": unknown scheduler '" + name + "'");
}

double longest_shard(const std::vector<Case>& cases, int shards) {
  std::vector<double> seconds(static_cast<std::size_t>(shards), 0);
  for (const Case& one : cases)
    seconds[static_cast<std::size_t>(Shard::of(one.key, shards)) - 1] +=
        estimated_seconds(estimated_work(one));
  return *std::ranges::max_element(seconds);
}

/// The smallest number of shards that each end within `hours`.
int shards_for(Plan& plan, const std::vector<Case>& cases, double hours) {
  if (!(3600 * hours - plan.limits.wall_seconds() - 60 > 0))
    throw InputError("--hours " + shortest(hours) + ": a single case may take " +
                     shortest(std::ceil(plan.limits.wall_seconds() / 60)) +
                     " minutes (--timeout makes that less)");
  const int most = std::min(kMostShards, static_cast<int>(cases.size()));
  const auto fits = [&](int shards) {
    plan.longest = longest_shard(cases, shards);
    return shard_minutes(plan) <= 60 * hours;
  };
  int fewest = 1;
  while (!fits(fewest) && fewest < most) fewest = std::min(most, fewest + 1 + fewest / 16);
  if (!fits(fewest))
    throw InputError("--hours " + shortest(hours) + ": " + std::to_string(most) +
                     " shards, as many as there can be, take " +
                     std::to_string(shard_minutes(plan)) + " minutes each");
  return fewest;
}

/// Copies the files that a scene names: meshes and frames.
void copy_named_files(const fs::path& scene, const SceneSettings& settings, const fs::path& into) {
  Document document = read_document(scene, settings);
  for (const Value* value : file_names(document.root)) {
    const fs::path name(value->string);
    if (name.is_absolute() || std::ranges::find(name, "..") != name.end())
      throw InputError({document.diagnostic(
          value->place, "a file that goes to other machines lies in the scene's folder or below")});
    make_folder((into / name).parent_path());
    write_file(into / name, read_text(scene.parent_path() / name, kMostMeshBytes));
  }
}

/// Copies the user's own scene files and what they name to where the folder's copy of the study
/// finds them, so that the folder is complete in itself.
void copy_scenes(const std::vector<Case>& cases, const fs::path& folder) {
  std::set<std::pair<std::string, SceneSettings>> seen;
  for (const Case& one : cases) {
    if (!seen.insert({one.spec.scene, one.spec.settings}).second) continue;
    const fs::path name(one.spec.scene), file = find_scene(one.spec.scene);
    if (file.parent_path() == data_folder() / "scenes" || !fs::exists(name)) continue;
    if (name.is_absolute() || std::ranges::find(name, "..") != name.end())
      throw InputError(name.string() +
                       ": a scene that goes to other machines lies in this folder or below");
    make_folder((folder / name).parent_path());
    write_file(folder / name, read_text(file));
    copy_named_files(file, one.spec.settings, (folder / name).parent_path());
  }
}

/// Host and time of the last start of a shard.
std::pair<std::string, std::string> last_start(const Store& store) {
  Database* database = store.reading();
  if (!database) return {};
  Database::Rows row =
      database->rows("SELECT host, started FROM sessions ORDER BY started DESC LIMIT 1");
  return row.next() ? std::pair(row.text(0), row.text(1)) : std::pair<std::string, std::string>();
}

std::string start_command(const std::vector<int>& shards, const fs::path& folder) {
  const auto list = [&](const char* separator) {
    return join(shards, separator, [](int shard) { return std::to_string(shard); });
  };
  const bool slurm = scheduler_of(folder) == Scheduler::slurm;
  return "cd " + shell_word(folder.string()) + " && " +
         (slurm ? "sbatch --array=" + list(",") + " job.sh" : "./job.sh " + list(" "));
}

}  // namespace

std::string_view to_string(Scheduler scheduler) { return kSchedulers[scheduler]; }

std::optional<Scheduler> scheduler_named(std::string_view name) { return kSchedulers.find(name); }

double estimated_seconds(double work) { return 0.1 + 1.5e-8 * work; }

Plan plan(const Study& study, const std::vector<Case>& cases, const Limits& limits, int shards,
          double hours) {
  if (cases.empty()) throw InputError("this study has no case");
  if (shards > static_cast<int>(cases.size()))
    throw InputError("--shards " + std::to_string(shards) + ": the study has only " +
                     std::to_string(cases.size()) + " cases");
  Plan plan{study.name, study.preset, 1, limits, cases.size()};
  plan.shards = shards > 0 ? shards : shards_for(plan, cases, hours);
  plan.longest = longest_shard(cases, plan.shards);
  for (const Case& one : cases)
    plan.case_memory = std::max(plan.case_memory,
                                kProgramBytes + kElementBytes * (to_index(one.scene->mesh.size()) +
                                                                 one.scene->links.size()));
  return plan;
}

Plan write_folder(const fs::path& folder, const FolderRequest& request) {
  const Study& study = request.study;
  fs::path there = folder.parent_path();  // the part of the folder's path that already exists
  while (!there.empty() && !fs::exists(there)) there = there.parent_path();
  const std::vector<Case> cases = cases_of(study);
  try {
    const Plan made = plan(study, cases, request.limits, request.shards, request.hours);
    make_folder(folder / "log");
    make_folder(folder / "shards");
    copy_scenes(cases, folder);
    write_durably(folder / (study.name + ".toml"), read_text(study.file));
    write_durably(folder / "README", readme(made, request.on));
    if (!request.nodes.empty()) write_durably(folder / "nodes", request.nodes);
    write_durably(folder / kSchedulerFile, std::string(to_string(request.on)) + "\n");
    write_durably(folder / "job.sh", job_script(made, request.on));
    fs::permissions(folder / "job.sh", fs::perms::owner_exec | fs::perms::group_exec,
                    fs::perm_options::add);
    Store(folder).begin_session("taut cluster submit", {{study.name, cases}}, {1, made.shards});
    return made;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    for (fs::path parent = folder.parent_path(); parent != there; parent = parent.parent_path())
      fs::remove(parent, ignored);
    throw;
  }
}

fs::path shard_folder(const fs::path& folder, int shard) {
  const std::string number = std::to_string(shard);
  return folder / "shards" /
         (std::string(4 - std::min<std::size_t>(4, number.size()), '0') + number);
}

Answer status_of(const fs::path& folder) {
  std::map<int, std::map<std::string, std::string>> planned;  // ids by shard and key
  if (Store::is_at(folder) && fs::is_directory(folder / "shards"))
    for (const PlannedKey& one : Store(folder).planned()) planned[one.shard][one.key] = one.id;
  if (planned.empty())
    throw InputError(folder.string() + ": not a folder of `taut cluster submit`");
  Table shards{"shards", "", {{"shard"}, {"state"}, {"cases"}, {"done"}, {"host"}, {"started"}}},
      failed{"failed", "failed", {{"shard"}, {"case"}, {"status"}}};
  std::size_t cases = 0, done = 0;
  std::vector<int> to_start, with_failures;
  for (const auto& [shard, ids] : planned) {
    const Store store(shard_folder(folder, shard));
    std::size_t there = 0;
    for (const Store::Entry& entry : store.entries()) {
      const auto id = ids.find(entry.key);
      if (id == ids.end()) continue;  // the merge reports it
      ++there;
      if (!entry.is_result)
        if (const auto record = store.find(entry.key))
          failed.rows.push_back({shard, id->second, describe(record->status)});
    }
    const auto [host, started] = last_start(store);
    const bool whole = there == ids.size();
    shards.rows.push_back({shard,
                           whole             ? "done"
                           : started.empty() ? "waiting"
                                             : "begun",
                           ids.size(), there, host, started});
    if (!whole) to_start.push_back(shard);
    if (!failed.rows.empty() && failed.rows.back()[0] == Cell(shard))
      with_failures.push_back(shard);
    cases += ids.size();
    done += there;
  }
  std::ranges::stable_sort(shards.rows, {},
                           [](const std::vector<Cell>& row) { return row[1] == Cell("done"); });
  shards.most = failed.most = 12;
  shards.caption = to_start.empty() ? "" : "which of them run: squeue, or GNU parallel's terminal";
  Answer answer{"cluster status", folder.string()};
  answer.add({"cases"}, cases);
  answer.add({"done"}, done);
  if (!to_start.empty())
    answer.add(Column("start", "start what is not done").of_commands(),
               start_command(to_start, folder));
  if (!failed.rows.empty())
    answer.add(Column("again", "failures again").of_commands(),
               "export ONLY=failed; " + start_command(with_failures, folder));
  answer.add(std::move(shards));
  answer.add(std::move(failed));
  return answer;
}

}  // namespace taut::cluster
