#include "experiments/results/session.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/results/builds.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

int from_environment(const char* name, int fallback) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : fallback;
}

}  // namespace

int Shard::of(const std::string& key, int count) {
  unsigned long number = 0;
  std::from_chars(key.data(), key.data() + 8, number, 16);
  return static_cast<int>(number % static_cast<unsigned long>(count)) + 1;
}

Shard Shard::parse(const std::string& text) {
  Shard shard;
  if (text.empty()) {
    shard.count = from_environment("SLURM_ARRAY_TASK_COUNT", 1);
    shard.index = from_environment("SLURM_ARRAY_TASK_ID", 1) -
                  from_environment("SLURM_ARRAY_TASK_MIN", 1) + 1;
  } else {
    const std::string_view all = text;
    const std::size_t slash = std::min(all.find('/'), all.size() - 1);
    const auto index = whole<int>(all.substr(0, slash)), count = whole<int>(all.substr(slash + 1));
    if (!index || !count) throw InputError("--shard " + text + ": expected i/n, such as 1/4");
    shard = {*index, *count};
  }
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count)
    throw InputError("shard " + std::to_string(shard.index) + "/" + std::to_string(shard.count) +
                     " does not exist: the first is 1/n, the last n/n");
  return shard;
}

std::vector<std::string> remarks_of(const std::vector<StudyCases>& studies) {
  std::vector<std::string> all;
  for (const StudyCases& study : studies)
    for (const Case& one : study.cases)
      for (const std::string& remark : one.remarks) push_unique(all, remark);
  return all;
}

std::string Missing::sentence() const {
  constexpr std::size_t kShown = 10;
  std::string text = study + ": merged although " + std::to_string(cases) +
                     " planned cases were missing; " + std::to_string(ids.size()) + " still are: ";
  for (std::size_t i = 0; i < std::min(kShown, ids.size()); ++i) text += (i ? ", " : "") + ids[i];
  return text + (ids.size() > kShown ? ", ..." : "");
}

void Store::begin_session(const std::string& command, const std::vector<StudyCases>& studies,
                          const Shard& shard) {
  Database& database = writing();
  std::map<std::string, Build> builds;
  const auto build_of = [&](const Case& one) -> const Build& {
    const std::string text = one.build.empty() ? this_build() : one.build;
    const auto at = builds.find(text);
    if (at != builds.end()) return at->second;
    const Build named = build_named(text), given = given_build();
    return builds.emplace(text, given.id == named.id ? given : named).first->second;
  };
  database.transaction([&] {
    std::size_t cases = 0;
    for (const auto& [study, planned] : studies) {
      cases += planned.size();
      if (study.empty()) continue;
      // Planned by another build or preset.
      database.run("DELETE FROM planned WHERE study = ?", study);
      for (const Case& one : planned) {
        database.run(
            "INSERT OR IGNORE INTO planned (study, key, id, shard, shards) VALUES (?, ?, ?, ?, ?)",
            study, one.key, one.id, Shard::of(one.key, shard.count), shard.count);
        note_ran(*this, study, build_of(one), one.id, one.key);
      }
    }
    database.run("INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                 utc_stamp() + "-" + unique_suffix(), command, utc_stamp(), host_name(),
                 std::string(toolchain()), shard.index, shard.count, cases);
  });
}

std::vector<PlannedKey> Store::planned() const {
  std::vector<PlannedKey> all;
  Database* database = reading();
  if (!database) return all;
  Database::Rows row = database->rows(
      "SELECT min(study), key, id, shard, shards FROM planned GROUP BY key ORDER BY key");
  while (row.next()) {
    try {
      all.push_back({row.text(0), row.text(1), row.text(2), row.whole(3, 1), row.whole(4, 1)});
    } catch (const InputError& error) {
      throw InputError(file().string() + ": plan of " + row.text(2) + ": " + error.what());
    }
  }
  return all;
}

void Store::mark_missing(const std::vector<PlannedKey>& planned) {
  Database& database = writing();
  database.transaction([&] {
    for (const PlannedKey& one : planned)
      database.run(
          "INSERT INTO planned (study, key, id, shard, shards, missing) VALUES (?, ?, ?, ?, ?, 1) "
          "ON CONFLICT (study, key) DO UPDATE SET missing = 1",
          one.study, one.key, one.id, one.shard, one.shards);
  });
}

std::vector<Missing> Store::still_missing() const {
  std::vector<Missing> all;
  Database* database = reading();
  if (!database) return all;
  Database::Rows row = database->rows(
      "SELECT study, id, key IN (SELECT key FROM cases) FROM planned WHERE missing ORDER BY study, "
      "key");
  while (row.next()) {
    if (all.empty() || all.back().study != row.text(0)) all.push_back({row.text(0), {}, 0});
    ++all.back().cases;
    if (row.integer(2) == 0) all.back().ids.push_back(row.text(1));
  }
  std::erase_if(all, [](const Missing& one) { return one.ids.empty(); });
  return all;
}

}  // namespace taut
