// Copies the cases of another results file.
#include <algorithm>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/schema.hpp"
#include "experiments/results/store.hpp"

namespace taut {

namespace fs = std::filesystem;

std::vector<std::string> Store::unsound_keys() const {
  std::vector<std::string> all = keys();
  const std::vector<Entry> sound = entries();
  std::erase_if(all, [&](const std::string& key) {
    return std::ranges::binary_search(sound, key, {}, &Entry::key);
  });
  return all;
}

namespace {

/// A temporary table with these keys, which exists as long as this object.
class SoundKeys {
 public:
  SoundKeys(Database& database, const std::vector<Store::Entry>& all) : database_(database) {
    database_.script("CREATE TEMP TABLE sound (key TEXT PRIMARY KEY) WITHOUT ROWID");
    for (const Store::Entry& one : all) database_.run("INSERT INTO temp.sound VALUES (?)", one.key);
  }
  ~SoundKeys() {
    try {
      database_.script("DROP TABLE IF EXISTS temp.sound");
    } catch (const InputError&) {  // the connection is of no use any more
    }
  }
  SoundKeys(const SoundKeys&) = delete;
  SoundKeys& operator=(const SoundKeys&) = delete;

 private:
  Database& database_;
};

}  // namespace

void Store::take(const Store& other) {
  if (!other.reading()) return;
  Database& database = writing();
  const std::string columns = join(case_columns(), ", ") + ", is_result, result_digest, errors";
  const SoundKeys sound(database, other.entries());
  const std::vector<std::string> unsound = unsound_keys();
  database.run("ATTACH ? AS other", fs::absolute(other.file()).string());
  try {
    database.transaction([&] {
      for (const std::string& key : unsound)
        database.run("DELETE FROM cases WHERE key = ? AND key IN (SELECT key FROM temp.sound)",
                     key);
      database.script(
          "INSERT OR IGNORE INTO metrics (name, unit, definition) "
          "SELECT name, unit, definition FROM other.metrics;"
          "DELETE FROM cases WHERE NOT is_result AND key IN "
          "(SELECT key FROM other.cases JOIN temp.sound USING (key) WHERE is_result)");
      const std::int64_t last =
          database.number_of("SELECT coalesce(max(case_id), 0) FROM main.cases");
      const std::string taken =
          " FROM main.cases AS mine JOIN other.cases AS theirs USING (key) WHERE mine.case_id > " +
          std::to_string(last);
      database.script(
          "INSERT OR IGNORE INTO main.cases (" + columns + ") SELECT " + columns +
          " FROM other.cases WHERE key IN (SELECT key FROM temp.sound) ORDER BY "
          "case_id;"
          "CREATE TEMP TABLE taken AS SELECT mine.case_id AS mine, theirs.case_id AS "
          "theirs" +
          taken +
          " ORDER BY mine.case_id;"
          "INSERT INTO main.numbers SELECT mine, n.metric_id, value FROM taken JOIN "
          "(SELECT n.case_id, m.metric_id, n.value FROM other.numbers AS n JOIN "
          "other.metrics AS o USING (metric_id) JOIN main.metrics AS m USING (name)) "
          "AS n ON n.case_id = theirs;"
          "INSERT INTO main.series SELECT mine, columns, digest FROM taken JOIN other.series "
          "ON case_id = theirs;"
          "INSERT OR IGNORE INTO main.sessions SELECT * FROM other.sessions;"
          "INSERT OR IGNORE INTO main.planned SELECT * FROM other.planned;"
          "INSERT OR IGNORE INTO main.builds SELECT * FROM other.builds;"
          "INSERT OR IGNORE INTO main.ran SELECT * FROM other.ran;"
          "INSERT OR IGNORE INTO main.spent SELECT * FROM other.spent;"
          "INSERT OR IGNORE INTO main.ratios SELECT * FROM other.ratios;"
          "INSERT INTO main.frames SELECT mine, motion, digest FROM taken JOIN other.frames "
          "ON case_id = theirs;"
          "DROP TABLE taken");
    });
  } catch (...) {
    database.run("DETACH other");
    throw;
  }
  database.run("DETACH other");
}

}  // namespace taut
