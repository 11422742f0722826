#include "experiments/results/store.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/record_rows.hpp"
#include "experiments/results/schema.hpp"
#include "experiments/results/store_error.hpp"
#include "experiments/results/writer_mark.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostErrors = std::size_t{64} << 10;  ///< most bytes of stderr that are kept

/// The last `most` bytes of a file; "" if there is no file.
std::string end_of(const fs::path& file, std::size_t most) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return {};
  const auto size = static_cast<std::size_t>(in.tellg());
  std::string text(std::min(size, most), '\0');
  in.seekg(static_cast<std::streamoff>(size - text.size()));
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

std::string text_if_there(const fs::path& file) {
  return fs::exists(file) ? read_text(file) : std::string();
}

/// Decides what to do with a record, given the stored one, if any.
Store::Commit beside(const std::optional<Record>& old, const Record& record, bool adds_frames) {
  using Commit = Store::Commit;
  if (!old) return Commit::stored;
  if (result_digest(*old) == result_digest(record))
    return adds_frames ? Commit::stored : Commit::same;
  if (!old->status.is_result()) return Commit::stored;
  return record.status.is_result() ? Commit::conflict : Commit::same;
}

/// Why the file's tables cannot be trusted; "" if they can. In a foreign file, a view in place of a
/// table may never end, and a trigger may do anything.
std::string wrong_part(Database& database) {
  static const Database::Parts kOurs = parts_made_by(tables());
  const Database::Parts theirs = database.parts();
  for (const auto& [part, sql] : kOurs)
    if (const auto at = theirs.find(part); at == theirs.end() || at->second != sql)
      return "its " + part.first + " " + part.second + " is not that of a results file";
  for (const auto& [part, sql] : theirs)
    if (part.first == "trigger") return "it has a trigger " + part.second;
  return {};
}

/// Whether a file is damaged, has this taut's version but not its tables, or has tables but no
/// version, which no taut leaves behind.
bool unusable(const fs::path& file) {
  if (damaged(file)) return true;
  Database database(file, Database::Access::read);
  const std::int64_t version = database.number_of("PRAGMA user_version");
  if (version == 0) return !database.parts().empty();
  return version == kSchemaVersion && !wrong_part(database).empty();
}

void require_version(const fs::path& file, std::int64_t version) {
  if (version != kSchemaVersion)
    throw StoreError(file, "of another taut (version " + std::to_string(version) +
                               "; this one reads " + std::to_string(kSchemaVersion) +
                               "); name another results folder");
}

}  // namespace

struct Store::State {
  std::unique_ptr<WriterMark> mark;
  std::unique_ptr<Database> database;
  bool writable = false;
  std::map<std::string, std::int64_t, std::less<>> metrics;  ///< metric_id by name
  std::optional<Scratch> scratch;                            ///< where cases write their files
};

fs::path default_results() { return results_folder() / "runs"; }

Store::Store(fs::path root, Notice notice)
    : root_(std::move(root)), notice_(std::move(notice)), state_(std::make_shared<State>()) {
  if (!notice_) notice_ = [](const std::string& text) { std::cerr << text << '\n'; };
}

void Store::say_earlier_results() const {
  for (const char* name : {"store", "packs"})
    if (fs::is_directory(root_ / name))
      notice_((root_ / name).string() +
              ": results of an earlier taut; they stay there and are not read");
}

Database* Store::reading() const {
  if (state_->database) return state_->database.get();
  std::error_code none;
  if (!fs::exists(file(), none)) {
    say_earlier_results();
    return nullptr;
  }
  auto database = std::make_unique<Database>(file(), Database::Access::read);
  const std::int64_t version = database->number_of("PRAGMA user_version");
  if (version == 0) return nullptr;  // another process is creating it
  require_version(file(), version);
  if (const std::string wrong = wrong_part(*database); !wrong.empty())
    throw StoreError(file(), wrong);
  state_->database = std::move(database);
  return state_->database.get();
}

Database& Store::writing() {
  if (state_->writable) return *state_->database;
  state_->database.reset();
  std::error_code none;
  if (!fs::exists(file(), none)) say_earlier_results();
  make_folder(root_);
  state_->mark = std::make_unique<WriterMark>(file());
  auto database = std::make_unique<Database>(file(), Database::Access::write);
  database->transaction([&] {  // also shows that the disk accepts it
    if (const std::int64_t version = database->number_of("PRAGMA user_version"); version == 0)
      database->script(tables());
    else
      require_version(file(), version);
    database->script("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  });
  state_->database = std::move(database);
  state_->writable = true;
  return *state_->database;
}

void Store::prepare() {
  std::error_code none;
  if (!state_->database && fs::is_regular_file(file(), none) && unusable(file())) {
    const fs::path aside = file().string() + ".damaged-" + unique_suffix();
    std::error_code error;
    fs::rename(file(), aside, error);
    if (error) throw StoreError(file(), "damaged, and cannot be set aside: " + error.message());
    fs::remove(file().string() + "-journal", none);  // belongs to the damaged file
    notice_(file().string() + ": damaged, set aside as " + aside.string() + "; begun anew");
  }
  writing();
}

std::optional<Record> Store::sound_record(Database& database, const std::string& key,
                                          std::string& why) const {
  std::optional<Record> record;
  std::string result;
  {
    Database::Rows row = database.rows(
        "SELECT " + join(case_columns(), ", ") + ", result_digest FROM cases WHERE key = ?", key);
    if (!row.next()) return {};
    record = record_of_row(row, why);
    if (!record) return {};
    result = row.text(static_cast<int>(case_columns().size()));
  }
  Database::Rows values = database.rows(
      "SELECT name, value FROM cases JOIN numbers USING (case_id) JOIN metrics USING (metric_id) "
      "WHERE key = ?",
      key);
  while (values.next()) record->values[values.text(0)] = values.number(1);
  if (result_digest(*record) == result) return record;
  why = "it does not match its digest";
  return {};
}

std::optional<Record> Store::find(const std::string& key) const {
  Database* database = reading();
  if (!database) return {};
  std::string why;
  std::optional<Record> record = sound_record(*database, key, why);
  if (!why.empty()) say_damaged("case " + key, why);
  return record;
}

void Store::say_damaged(const std::string& what, const std::string& why) const {
  notice_(file().string() + ": damaged " + what + " (" + why + "), counts as none");
}

std::optional<Record> Store::find(const Case& one) const {
  std::optional<Record> record = find(one.key);
  if (record) name_it(*record, one);
  return record;
}

Series Store::series(const std::string& key) const {
  Database* database = reading();
  if (!database) return {};
  Database::Rows row = database->rows(
      "SELECT columns, series.digest FROM series JOIN cases USING (case_id) WHERE key = ?", key);
  if (!row.next()) return {};
  if (sha256(row.text(0)) == row.text(1))
    return series_from_json(row.text(0), file().string() + ": series of " + key);
  say_damaged("series of " + key);
  return {};
}

bool Store::has_frames(const std::string& key) const {
  Database* database = reading();
  if (!database) return false;
  Database::Rows row = database->rows(
      "SELECT motion, frames.digest FROM frames JOIN cases USING (case_id) WHERE key = ?", key);
  if (!row.next()) return false;
  if (sha256(row.text(0)) == row.text(1)) return true;
  say_damaged("motion of " + key);
  return false;
}

Trajectory Store::motion(const std::string& key) const {
  Database::Rows row = reading()->rows(
      "SELECT motion, vertices, solver_text, dt, frames.digest FROM frames JOIN cases USING "
      "(case_id) WHERE key = ?",
      key);
  const auto fail = [&](const std::string& why) {
    throw StoreError(file(), "motion of " + key + ": " + why);
  };
  if (!row.next()) fail("it is not stored");
  if (sha256(row.text(0)) != row.text(4)) fail("it does not match its digest");
  try {
    return {row.text(2), row.number(3), frames_in(row.text(0), row.whole(1, 0))};
  } catch (const InputError& error) {
    fail(error.what());
  }
  return {};
}

fs::path Store::stage(const std::string& key) {
  if (!state_->scratch) state_->scratch.emplace();
  const fs::path staged = state_->scratch->path() / (key + "." + unique_suffix());
  std::error_code error;
  if (!fs::create_directory(staged, error))
    throw InputError(staged.string() + ": cannot create: " + error.message());
  return staged;
}

void Store::insert(Database& database, const Record& r, const CaseFiles& files) {
  database.run("DELETE FROM cases WHERE key = ?", r.key);
  std::vector<Database::Value> values = row_of(r);
  std::string marks;
  for (std::size_t i = 0; i < values.size(); ++i) marks += "?, ";
  values.insert(values.end(), {std::int64_t{r.status.is_result()}, result_digest(r), files.errors});
  database.run_with("INSERT INTO cases (" + join(case_columns(), ", ") +
                        ", is_result, result_digest, errors) VALUES (" + marks + "?, ?, ?)",
                    values);
  const std::int64_t id = database.number_of("SELECT last_insert_rowid()");
  for (const auto& [name, value] : r.values) {
    std::int64_t& metric = state_->metrics[name];
    if (metric == 0) {
      const ValueSpec* spec = find_value(name).second;
      database.run("INSERT OR IGNORE INTO metrics (name, unit, definition) VALUES (?, ?, ?)", name,
                   std::string(spec ? spec->unit.si : ""), std::string(spec ? spec->help : ""));
      Database::Rows row = database.rows("SELECT metric_id FROM metrics WHERE name = ?", name);
      row.next();
      metric = row.integer(0);
    }
    database.run("INSERT INTO numbers VALUES (?, ?, ?)", id, metric, value);
  }
  if (!files.series.empty())
    database.run("INSERT INTO series VALUES (?, ?, ?)", id, files.series, sha256(files.series));
  if (!files.motion.empty())
    database.run("INSERT INTO frames VALUES (?, ?, ?)", id, Database::Bytes{files.motion},
                 sha256(files.motion));
}

Store::Commit Store::commit(const Record& record, const CaseFiles& files) {
  Database& database = writing();
  Commit done = Commit::same;
  try {
    database.transaction([&] {
      std::string damage;
      const std::optional<Record> old = sound_record(database, record.key, damage);
      done = beside(old, record, !files.motion.empty() && !has_frames(record.key));
      if (done == Commit::stored) insert(database, record, files);
      if (files.spent)
        database.run("INSERT OR REPLACE INTO spent VALUES (?, ?, ?)", record.key, files.spent->cpu,
                     files.spent->metrics);
      if (done == Commit::conflict)
        database.run("INSERT OR IGNORE INTO conflicts VALUES (?, ?, ?, ?)", record.key,
                     result_digest(record), utc_stamp(), to_json(record));
    });
  } catch (const InputError&) {
    state_->metrics.clear();  // it may refer to rows that were rolled back
    throw;
  }
  return done;
}

Store::Commit Store::commit(const fs::path& staged, const Record& record, const Spent& spent) {
  const Commit done =
      commit(record, {text_if_there(staged / kSeriesFile), text_if_there(staged / kFramesFile),
                      end_of(staged / kErrorsFile, kMostErrors), spent});
  std::error_code ignored;
  fs::remove_all(staged, ignored);
  return done;
}

std::map<std::string, Spent> Store::spent() const {
  std::map<std::string, Spent> all;
  Database* database = reading();
  if (!database) return all;
  Database::Rows row = database->rows("SELECT key, cpu, metrics FROM spent");
  while (row.next()) all[row.text(0)] = {row.number(1), row.number(2)};
  return all;
}

void Store::together(const std::function<void()>& work) {
  try {
    writing().transaction(work);
  } catch (...) {
    state_->metrics.clear();
    throw;
  }
}

std::vector<Store::Entry> Store::entries() const {
  std::vector<Entry> all;
  Database* database = reading();
  if (!database) return all;
  const std::size_t columns = case_columns().size();
  Database::Rows row = database->rows("SELECT " + join(case_columns(), ", ") +
                                      ", result_digest, is_result FROM cases ORDER BY key");
  Database::Rows value = database->rows(
      "SELECT cases.key, name, value FROM cases JOIN numbers USING (case_id) "
      "JOIN metrics USING (metric_id) ORDER BY cases.key");
  bool more = value.next();
  while (row.next()) {
    std::string why;
    std::optional<Record> record = record_of_row(row, why);
    const std::string key = row.text(0);
    for (; more && value.text(0) <= key; more = value.next())
      if (record && value.text(0) == key) record->values[value.text(1)] = value.number(2);
    const std::string result = record ? result_digest(*record) : "";
    const bool is_result = row.integer(static_cast<int>(columns) + 1) != 0;
    if (record &&
        (result != row.text(static_cast<int>(columns)) || is_result != record->status.is_result()))
      why = "it does not match its digest";
    if (why.empty())
      all.push_back({key, record->id, result, is_result});
    else
      say_damaged("case " + key, why);
  }
  return all;
}

std::vector<std::string> Store::keys() const {
  std::vector<std::string> keys;
  Database* database = reading();
  if (!database) return keys;
  Database::Rows row = database->rows("SELECT key FROM cases ORDER BY case_id");
  while (row.next()) keys.push_back(row.text(0));
  return keys;
}

std::string Store::digest() const {
  std::string all;
  for (const Entry& one : entries())
    if (one.is_result) all += one.key + ' ' + one.result + '\n';
  return sha256(all);
}

std::vector<std::string> Store::conflicts() const {
  std::vector<std::string> keys;
  Database* database = reading();
  if (!database) return keys;
  Database::Rows row = database->rows("SELECT key FROM conflicts ORDER BY key");
  while (row.next()) keys.push_back(row.text(0));
  return keys;
}

void Store::keep(const Answer& answer) {
  const std::string text = to_json(answer);
  writing().run("INSERT OR REPLACE INTO answers VALUES (?, ?, ?, ?, ?, ?)", answer.kind,
                answer.subject, program_digest(), utc_stamp(), text, sha256(text));
}

std::vector<Answer> Store::answers(const std::string& kind, std::string_view program) const {
  std::vector<Answer> all;
  Database* database = reading();
  if (!database) return all;
  const std::string what = "answer of " + kind;
  Database::Rows row = database->rows(
      "SELECT answer, digest FROM answers WHERE kind = ? AND program = ? ORDER BY subject", kind,
      std::string(program));
  while (row.next()) {
    if (sha256(row.text(0)) != row.text(1))
      throw StoreError(file(), what + ": it does not match its digest");
    all.push_back(answer_from_json(row.text(0), file().string() + ": " + what));
  }
  return all;
}

}  // namespace taut
