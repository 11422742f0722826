#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/session.hpp"
#include "experiments/study/store.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::verb::merge {

namespace {

namespace fs = std::filesystem;

/// Copies the entries and sessions of `from`; gives the number of conflicts.
std::size_t copy_into(const Store& store, const fs::path& from) {
  const Store source(from);
  std::size_t conflicts = 0;
  for (const std::string& key : source.keys()) {
    const std::optional<Record> record = source.find(key);
    if (!record) continue;
    const fs::path staged = store.stage(key);
    fs::copy(source.folder(key), staged, fs::copy_options::overwrite_existing);
    if (store.commit(staged, *record) == Store::Commit::conflict) {
      std::cerr << record->id << ": " << from.string() << " has another result\n";
      ++conflicts;
    }
  }
  std::error_code none;
  for (const auto& session : fs::directory_iterator(from / "sessions", none)) {
    make_folder(store.root() / "sessions");
    fs::copy(session.path(), store.root() / "sessions" / session.path().filename(),
             fs::copy_options::recursive | fs::copy_options::skip_existing);
  }
  return conflicts;
}

int run(const std::vector<std::string>& folders, const std::string& out, bool json) {
  for (const std::string& folder : folders)
    if (!fs::is_directory(fs::path(folder) / "store"))
      throw InputError(folder + ": no results (no folder 'store' in it)");
  const Store store(out);
  store.prepare();
  std::size_t conflicts = 0;
  for (const std::string& folder : folders)
    if (fs::weakly_canonical(folder) != fs::weakly_canonical(out))
      conflicts += copy_into(store, folder);

  const std::vector<ManifestEntry> manifest = read_manifests(store.root());
  std::set<std::string> missing_shards;
  std::size_t there = 0;
  for (const ManifestEntry& one : manifest) {
    if (store.find(one.key))
      ++there;
    else
      missing_shards.insert(std::to_string(one.shard) + "/" + std::to_string(one.shards));
  }
  if (json) {
    std::cout << to_text(Json{{"cases", manifest.size()},
                              {"there", there},
                              {"missing_shards", missing_shards},
                              {"conflicts", conflicts},
                              {"store", store.digest()}},
                         1)
              << '\n';
  } else {
    std::cout << there << "/" << manifest.size() << " cases";
    if (!missing_shards.empty()) std::cout << "; missing from shards";
    for (const std::string& shard : missing_shards) std::cout << ' ' << shard;
    std::cout << "\nstore " << store.digest() << '\n';
  }
  if (conflicts > 0) return kConflict;
  return there == manifest.size() ? kPass : kIncomplete;
}

std::function<int()> bind(CLI::App& app) {
  const auto folders = std::make_shared<std::vector<std::string>>();
  const auto out = std::make_shared<std::string>(default_results());
  app.add_option("DIR", *folders, "Results folders of shards")->required();
  app.add_option("--out", *out, "Where to (default: " + *out + ")");
  const auto json = std::make_shared<bool>(false);
  add_json(app, *json, "What is there and what is missing");
  return [folders, out, json] { return run(*folders, *out, *json); };
}

}  // namespace
}  // namespace taut::verb::merge

TAUT_VERB(merge) = {.name = "merge",
                    .group = VerbGroup::studies,
                    .summary = "Unites results of shards; says which planned case is missing",
                    .example = "taut merge results/shard1 results/shard2 --out results/runs",
                    .bind = taut::verb::merge::bind};
