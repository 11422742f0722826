#include "experiments/results/store.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/schema.hpp"
#include "experiments/results/writer_mark.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostErrors = std::size_t{64} << 10;  ///< bytes that are kept of stderr

/// The end of a file, "" if there is none.
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

/// -1 where the column is NULL.
int place(const Database::Rows& row, int column) {
  return row.null(column) ? -1 : static_cast<int>(row.integer(column));
}

// What a column of a record is in the file, and back. Texts of JSON hold what is no single value.

Database::Value kept(const std::string& text) { return text; }
Database::Value kept(double number) { return number; }
Database::Value kept(std::size_t count) { return static_cast<std::int64_t>(count); }
Database::Value kept(int number) {
  if (number < 0) return nullptr;
  return std::int64_t{number};
}
Database::Value kept(Status::Kind kind) { return std::string(to_string(kind)); }
template <class Value>
Database::Value kept(const Value& value) {
  return to_text(Json(value));
}

void read(const Database::Rows& row, int column, std::string& text) { text = row.text(column); }
void read(const Database::Rows& row, int column, double& number) { number = row.number(column); }
void read(const Database::Rows& row, int column, int& number) { number = place(row, column); }
void read(const Database::Rows& row, int column, std::size_t& count) {
  count = static_cast<std::size_t>(row.integer(column));
}
void read(const Database::Rows& row, int column, Status::Kind& kind) {
  kind = status_kind(row.text(column));
}
template <class Value>
void read(const Database::Rows& row, int column, Value& value) {
  read_json(row.text(column), case_columns()[static_cast<std::size_t>(column)],
            [&](const JsonReader& j) { return read_into(j, value), true; });
}

/// All but the values, of case_columns(). Throws InputError where a text is not what it has to be.
Record record_in(const Database::Rows& row) {
  Record r;
  int at = 0;
  for (const RecordColumn& column : record_columns())
    if (!column.column.empty())
      with_member(r, column, [&](auto& member) { read(row, at++, member); });
  if (!(r.dt > 0) || r.steps < 0 || r.vertices < 0 || r.links < 0)
    throw InputError("its time step or its sizes cannot be");
  return r;
}

/// The same; nothing, and why, if a text is not what it has to be.
std::optional<Record> record_of_row(const Database::Rows& row, std::string& why) {
  try {
    return record_in(row);
  } catch (const InputError& error) {
    why = error.what();
    return {};
  }
}

/// What becomes of a record beside the one that is there, if any.
Store::Commit beside(const std::optional<Record>& old, const Record& record, bool adds_frames) {
  using Commit = Store::Commit;
  if (!old) return Commit::stored;
  if (result_digest(*old) == result_digest(record))
    return adds_frames ? Commit::stored : Commit::same;
  if (!old->status.is_result()) return Commit::stored;
  return record.status.is_result() ? Commit::conflict : Commit::same;
}

/// Why nothing in the file can be trusted to be what it is called; "": it can. A view of a foreign
/// file in the place of a table may never end, a trigger does what it wants.
std::string wrong_part(Database& database) {
  static const std::map<std::string, std::string> kOurs = parts_made_by(tables());
  const std::map<std::string, std::string> theirs = database.parts();
  for (const auto& [name, sql] : kOurs)
    if (const auto at = theirs.find(name); at == theirs.end() || at->second != sql)
      return "its " + name + " is not that of a results file";
  for (const auto& [name, sql] : theirs)
    if (name.starts_with("trigger ")) return "it has a " + name;
  return {};
}

/// Of this taut, and not what it wrote.
bool unusable(const fs::path& file) {
  if (damaged(file)) return true;
  Database database(file, Database::Access::read);
  return database.number_of("PRAGMA user_version") == kSchemaVersion &&
         !wrong_part(database).empty();
}

void require_version(const fs::path& file, std::int64_t version) {
  if (version != kSchemaVersion)
    throw InputError(file.string() + ": of another taut (version " + std::to_string(version) +
                     "; this one reads " + std::to_string(kSchemaVersion) +
                     "); name another results folder");
}

}  // namespace

struct Store::State {
  std::unique_ptr<WriterMark> mark;
  std::unique_ptr<Database> database;
  bool writable = false;
  std::map<std::string, std::int64_t, std::less<>> metrics;  ///< metric_id by name
  std::optional<Scratch> scratch;                            ///< where cases write
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
  if (version == 0) return nullptr;  // being made
  require_version(file(), version);
  if (const std::string wrong = wrong_part(*database); !wrong.empty())
    throw InputError(file().string() + ": " + wrong);
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
  database->transaction([&] {  // which shows that the disk takes it
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
    if (error)
      throw InputError(file().string() + ": damaged, and cannot be set aside: " + error.message());
    fs::remove(file().string() + "-journal", none);  // of the damaged one
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
  if (record) {
    record->spec = one.spec;
    record->id = one.id;
    record->scene = one.scene->name;
  }
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
    throw InputError(file().string() + ": motion of " + key + ": " + why);
  };
  if (!row.next()) fail("there is none");
  if (sha256(row.text(0)) != row.text(4)) fail("it does not match its digest");
  try {
    return {row.text(2), row.number(3), frames_in(row.text(0), place(row, 1))};
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
  std::vector<Database::Value> values;
  std::string marks;
  for (const RecordColumn& column : record_columns()) {
    if (column.column.empty()) continue;
    values.push_back(with_member(r, column, [](const auto& member) { return kept(member); }));
    marks += "?, ";
  }
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
      if (done == Commit::conflict)
        database.run("INSERT OR IGNORE INTO conflicts VALUES (?, ?, ?, ?)", record.key,
                     result_digest(record), utc_stamp(), to_json(record));
    });
  } catch (const InputError&) {
    state_->metrics.clear();  // may be of rows that are not there
    throw;
  }
  return done;
}

Store::Commit Store::commit(const fs::path& staged, const Record& record) {
  const Commit done =
      commit(record, {text_if_there(staged / kSeriesFile), text_if_there(staged / kFramesFile),
                      end_of(staged / "stderr.txt", kMostErrors)});
  std::error_code ignored;
  fs::remove_all(staged, ignored);
  return done;
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
  const std::string place = file().string() + ": answer of " + kind;
  Database::Rows row = database->rows(
      "SELECT answer, digest FROM answers WHERE kind = ? AND program = ? ORDER BY subject", kind,
      std::string(program));
  while (row.next()) {
    if (sha256(row.text(0)) != row.text(1))
      throw InputError(place + ": it does not match its digest");
    all.push_back(answer_from_json(row.text(0), place));
  }
  return all;
}

std::vector<std::string> Store::unsound_keys() const {
  std::vector<std::string> all = keys();
  const std::vector<Entry> sound = entries();
  std::erase_if(all, [&](const std::string& key) {
    return std::ranges::binary_search(sound, key, {}, &Entry::key);
  });
  return all;
}

namespace {

/// A temporary table of these keys, for as long as this lives.
class SoundKeys {
 public:
  SoundKeys(Database& database, const std::vector<Store::Entry>& all) : database_(database) {
    database_.script("CREATE TEMP TABLE sound (key TEXT PRIMARY KEY) WITHOUT ROWID");
    for (const Store::Entry& one : all) database_.run("INSERT INTO temp.sound VALUES (?)", one.key);
  }
  ~SoundKeys() {
    try {
      database_.script("DROP TABLE IF EXISTS temp.sound");
    } catch (const InputError&) {  // of a connection that is of no use any more
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
