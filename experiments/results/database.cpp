#include "experiments/results/database.hpp"

#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "experiments/answer/number.hpp"
#include "experiments/results/store_error.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_with(const fs::path& file, int code, int system, const std::string& text) {
  const auto cannot = [&](const std::string& what, const std::string& why) {
    throw StoreError(file, "cannot " + what + ": " + why);
  };
  if (code == SQLITE_FULL) cannot("write", std::strerror(system > 0 ? system : ENOSPC));
  if (code == SQLITE_READONLY) {
    errno = 0;
    const bool gone = access(file.c_str(), F_OK) != 0;
    const bool refused =
        gone || access(file.c_str(), W_OK) != 0 || access(file.parent_path().c_str(), W_OK) != 0;
    cannot("write", refused ? std::strerror(errno) : text);
  }
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED)
    throw StoreError(file, "another process has it locked for more than " +
                               std::to_string(Database::kPatience / 1000) + " s");
  if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB)
    throw StoreError(
        file, "damaged: " + text + "; what writes results there sets it aside and begins anew");
  if (code == SQLITE_IOERR || code == SQLITE_CANTOPEN)
    cannot(code == SQLITE_IOERR ? "write" : "open", system > 0 ? std::strerror(system) : text);
  throw StoreError(file, text);
}

}  // namespace

Database::Database(fs::path file, Access access) : file_(std::move(file)) {
  std::error_code none;
  if (fs::exists(file_, none) && !fs::is_regular_file(file_, none))
    throw StoreError(file_, "is not a regular file");  // opening a pipe would block
  errno = 0;
  try {
    db_ = std::make_unique<SQLite::Database>(fs::absolute(file_),
                                             access == Access::read
                                                 ? SQLite::OPEN_READWRITE
                                                 : SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE,
                                             kPatience);
  } catch (const SQLite::Exception& error) {
    fail_with(file_, error.getErrorCode() & 0xff, errno, error.what());
  }
  // The schema in the file is not trusted, since others may have written it.
  script("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA foreign_keys = ON");
}

void Database::fail(const SQLite::Exception& error) const {
  const int known = sqlite3_system_errno(db_->getHandle());  // 0 after a COMMIT that failed
  fail_with(file_, error.getErrorCode() & 0xff, known > 0 ? known : errno, error.what());
}

bool Database::Rows::next() {
  return of_.guarded([&] { return statement_.executeStep(); });
}

std::string Database::Rows::exact_text(int column) const {
  const SQLite::Column value = statement_.getColumn(column);
  return value.isFloat() ? exact(value.getDouble()) : value.getString();
}

void Database::Rows::fail(int column, const std::string& why) const {
  throw InputError(std::string(statement_.getColumn(column).getName()) + ": " + why);
}

int Database::Rows::whole(int column, int least, int most) const {
  const std::int64_t number = integer(column);
  if (!statement_.getColumn(column).isInteger() || number < least || number > most)
    fail(column,
         "expected a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(number);
}

std::size_t Database::Rows::count(int column) const {
  constexpr std::int64_t kMost = std::int64_t{1} << 53;
  const std::int64_t number = integer(column);
  if (!statement_.getColumn(column).isInteger() || number < 0 || number > kMost)
    fail(column, "expected a count");
  return static_cast<std::size_t>(number);
}

SQLite::Statement& Database::prepared(const std::string& sql) {
  auto at = statements_.find(sql);
  if (at == statements_.end())
    at = guarded([&] { return statements_.try_emplace(sql, *db_, sql).first; });
  return at->second;
}

void Database::run_with(const std::string& sql, const std::vector<Value>& values) {
  SQLite::Statement& statement = prepared(sql);
  int place = 0;
  guarded([&] {
    for (const Value& value : values)
      std::visit([&](const auto& one) { bind(statement, ++place, one); }, value);
  });
  Rows all(*this, statement);
  while (all.next()) {
  }
}

void Database::script(const std::string& sql) {
  guarded([&] { db_->exec(sql); });
}

std::int64_t Database::number_of(const std::string& sql) {
  Rows row = rows(sql);
  row.next();
  return row.integer(0);
}

namespace {
constexpr const char* kParts = "SELECT type, name, sql FROM sqlite_master WHERE sql NOT NULL";
}

Database::Parts Database::parts() {
  Parts all;
  Rows row = rows(kParts);
  while (row.next()) all[{row.text(0), row.text(1)}] = row.text(2);
  return all;
}

Database::Parts parts_made_by(const std::string& statements) {
  SQLite::Database made(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  made.exec(statements);
  Database::Parts all;
  SQLite::Statement row(made, kParts);
  while (row.executeStep())
    all[{row.getColumn(0).getString(), row.getColumn(1).getString()}] =
        row.getColumn(2).getString();
  return all;
}

void Database::transaction(const std::function<void()>& work) {
  if (within_) return work();
  run("BEGIN IMMEDIATE");
  within_ = true;
  try {
    work();
    within_ = false;
    run("COMMIT");
  } catch (...) {
    within_ = false;
    // Unless SQLite has already rolled back.
    sqlite3_exec(db_->getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

bool damaged(const fs::path& file) {
  try {
    SQLite::Database db(fs::absolute(file), SQLite::OPEN_READWRITE, Database::kPatience);
    SQLite::Statement rows(db, "PRAGMA integrity_check(1)");
    if (rows.executeStep() && rows.getColumn(0).getString() != "ok") return true;
    return SQLite::Statement(db, "PRAGMA foreign_key_check").executeStep();
  } catch (const SQLite::Exception& error) {
    const int code = error.getErrorCode() & 0xff;
    return code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
  }
}

}  // namespace taut
