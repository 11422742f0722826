#include "experiments/results/builds.hpp"

#include <algorithm>
#include <cstdlib>
#include <regex>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

/// Converts "20260504T101112Z" to "2026-05-04T10:11:12Z".
std::string with_separators(const std::string& stamp) {
  return stamp.substr(0, 4) + "-" + stamp.substr(4, 2) + "-" + stamp.substr(6, 5) + ":" +
         stamp.substr(11, 2) + ":" + stamp.substr(13);
}

}  // namespace

Build build_named(const std::string& text) {
  static const std::regex kTimeOfBuild(
      "[0-9]{4}-[01][0-9]-[0-3][0-9](T[0-2][0-9]:[0-5][0-9]:[0-6][0-9]Z)?");
  constexpr std::size_t kLongest = 150;
  const std::size_t at = text.find('@');
  Build build{text.substr(0, at), with_separators(utc_stamp())};
  if (build.id.empty() || build.id.size() > kLongest || printable(build.id) != build.id ||
      build.id.find_first_of(" \t\n\"',") != std::string::npos)
    throw InputError("build '" + text +
                     "': expected ID or ID@TIME; an ID has 1 to 150 characters, no blank, quote, "
                     "comma or '@'");
  if (at == std::string::npos) return build;
  build.made = text.substr(at + 1);
  if (!std::regex_match(build.made, kTimeOfBuild))
    throw InputError("build '" + text +
                     "': expected a time after '@' as 2026-05-04 or 2026-05-04T10:11:12Z");
  return build;
}

Build given_build() {
  const char* given = std::getenv("TAUT_BUILD_ID");
  return given && *given ? build_named(given) : Build{};
}

void note_build(Store& store, const std::string& study, const Build& build) {
  store.writing().run(
      "INSERT INTO builds VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO UPDATE SET made = "
      "excluded.made, place = excluded.place, subject = excluded.subject, asked = excluded.asked, "
      "gap = excluded.gap",
      study, build.id, build.made, build.place, build.subject, build.asked, build.gap);
}

void note_ran(Store& store, const std::string& study, const Build& build, const std::string& id,
              const std::string& key) {
  Database& database = store.writing();
  database.run("INSERT OR IGNORE INTO builds VALUES (?, ?, ?, ?, ?, ?, ?)", study, build.id,
               build.made, build.place, build.subject, build.asked, build.gap);
  database.run("INSERT OR REPLACE INTO ran VALUES (?, ?, ?, ?)", study, build.id, id, key);
}

std::vector<Build> builds_of(const Store& store, const std::string& study) {
  std::vector<Build> all;
  Database* database = store.reading();
  if (!database) return all;
  Database::Rows row = database->rows(
      "SELECT build, made, place, subject, asked, gap FROM builds WHERE study = ? ORDER BY made, "
      "place, build",
      study);
  while (row.next())
    all.push_back(
        {row.text(0), row.text(1), row.integer(2), row.text(3), row.text(4), row.text(5)});
  return all;
}

bool has_all_results(const Store& store, const std::string& study, const std::string& build) {
  Database* database = store.reading();
  if (!database) return false;
  Database::Rows row = database->rows(
      "SELECT count(*), count(cases.key) FROM ran LEFT JOIN cases USING (key) WHERE study = ? AND "
      "build = ?",
      study, build);
  row.next();
  return row.integer(0) > 0 && row.integer(0) == row.integer(1);
}

std::vector<std::pair<std::string, std::string>> ran_by(const Store& store,
                                                        const std::string& study,
                                                        const std::string& build) {
  std::vector<std::pair<std::string, std::string>> all;
  Database* database = store.reading();
  if (!database) return all;
  Database::Rows row = database->rows(
      "SELECT id, key FROM ran WHERE study = ? AND build = ? ORDER BY id", study, build);
  while (row.next()) all.emplace_back(row.text(0), row.text(1));
  return all;
}

void note_ratio(Store& store, const std::string& study, const BuildRatio& r) {
  store.writing().run(
      "INSERT OR REPLACE INTO ratios VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", study, r.id,
      r.before, r.now, r.host, r.clock, r.low, r.ratio, r.high, r.control_low, r.control,
      r.control_high, utc_stamp());
}

std::vector<BuildRatio> ratios_of(const Store& store, const std::string& study) {
  std::vector<BuildRatio> all;
  Database* database = store.reading();
  if (!database) return all;
  Database::Rows row = database->rows(
      "SELECT id, before, now, host, clock, low, ratio, high, control_low, control, control_high "
      "FROM ratios WHERE study = ? ORDER BY id, before, now, host, clock",
      study);
  while (row.next())
    all.push_back({row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.number(5),
                   row.number(6), row.number(7), row.number(8), row.number(9), row.number(10)});
  return all;
}

}  // namespace taut
