#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "core/model/input_error.hpp"
#include "experiments/study/cluster/cluster.hpp"

namespace taut::cluster {

namespace fs = std::filesystem;

namespace {

/// A record found in the stores. A result takes precedence over a failure.
struct Found {
  std::string result;  ///< result_digest
  bool is_result = false;
  const Store* store = nullptr;
};

}  // namespace

void Merge::note_planned_alone(const Source& a, const Source& b,
                               std::vector<std::string>& foreign) {
  std::vector<PlannedKey> alone;
  std::ranges::set_difference(a.cases, b.cases, std::back_inserter(alone), {}, &PlannedKey::key,
                              &PlannedKey::key);
  for (const PlannedKey& one : alone)
    foreign.push_back(one.id + ": planned by " + a.folder.string() + ", not by " +
                      b.folder.string() + " (another study or build)");
}

Merge::Merge(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    Source source{folder, {}, {}};
    if (!Store::is_at(folder)) throw InputError(folder.string() + ": has no 'results.db'");
    source.stores.emplace_back(folder);
    source.cases = source.stores.front().planned();
    if (fs::is_directory(folder / "shards"))  // a folder of `taut cluster submit`
      for (const auto& shard : fs::directory_iterator(folder / "shards"))
        source.stores.emplace_back(shard.path());
    std::ranges::sort(source.stores, {}, &Store::root);
    sources_.push_back(std::move(source));
  }
}

MergePlan Merge::look(const Store& into) const {
  MergePlan plan{sources_.front().cases, {}, {}, {}};
  std::map<std::string, std::string> ids;
  for (const PlannedKey& one : plan.cases) ids[one.key] = one.id;
  for (const Source& other : std::span(sources_).subspan(1)) {
    note_planned_alone(sources_.front(), other, plan.foreign);
    note_planned_alone(other, sources_.front(), plan.foreign);
  }
  std::unordered_map<std::string, Found> found;
  for (const Source& source : sources_)
    for (const Store& store : source.stores) {
      for (const std::string& key : store.conflicts())
        plan.conflicts.push_back(ids[key] + ": two results in " + store.root().string());
      for (const Store::Entry& entry : store.entries()) {
        if (!std::ranges::binary_search(source.cases, entry.key, {}, &PlannedKey::key)) {
          plan.foreign.push_back(entry.id + ": in " + store.root().string() +
                                 ", but not planned (another study or build)");
          continue;
        }
        const Found mine{entry.result, entry.is_result, &store};
        auto [at, fresh] = found.try_emplace(entry.key, mine);
        if (!fresh && mine.is_result && at->second.is_result && mine.result != at->second.result)
          plan.conflicts.push_back(ids[entry.key] + ": " + at->second.store->root().string() +
                                   " and " + store.root().string() + " have different results");
        if (!at->second.is_result) at->second = mine;
      }
    }
  const std::vector<Store::Entry> all = into.entries();
  for (const PlannedKey& one : plan.cases) {
    const auto at = found.find(one.key);
    const auto there = std::ranges::lower_bound(all, one.key, {}, &Store::Entry::key);
    const bool is_there = there != all.end() && there->key == one.key;
    if (at == found.end() && !is_there) plan.missing.push_back(one);
    if (at != found.end() && is_there && at->second.is_result && there->is_result &&
        there->result != at->second.result)
      plan.conflicts.push_back(one.id + ": " + at->second.store->root().string() + " and " +
                               into.root().string() + " have different results");
  }
  return plan;
}

void Merge::copy(const MergePlan& plan, Store& into,
                 const std::function<void(std::size_t, std::size_t)>& progress) const {
  const std::size_t all = plan.cases.size() - plan.missing.size();
  for (const Source& source : sources_)
    for (const Store& store : source.stores) {
      if (fs::weakly_canonical(store.root()) == fs::weakly_canonical(into.root())) continue;
      into.take(store);
      progress(std::min(into.keys().size(), all), all);
    }
}

}  // namespace taut::cluster
