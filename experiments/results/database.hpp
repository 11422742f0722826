#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cerrno>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace taut {

/// An SQLite file. Every failure is a StoreError that names the file and the reason: no space,
/// read-only, locked for longer than kPatience, damaged.
class Database {
 public:
  enum class Access { read, write };
  /// Longest wait for a lock of another process [ms].
  static constexpr int kPatience = 60000;

  /// `write` creates the file if it does not exist. Opening it to read also rolls back what a
  /// killed process had begun to write, if the file system permits it.
  Database(std::filesystem::path file, Access);
  const std::filesystem::path& file() const { return file_; }

  /// The rows of a query, one after another. Its locks end with this object.
  class Rows {
   public:
    Rows(Database& of, SQLite::Statement& statement) : of_(of), statement_(statement) {}
    ~Rows() { statement_.tryReset(); }
    Rows(const Rows&) = delete;
    Rows& operator=(const Rows&) = delete;
    bool next();
    bool null(int column) const { return statement_.getColumn(column).isNull(); }
    std::string text(int column) const { return statement_.getColumn(column).getString(); }
    /// The text of a column; a number is written to the bit, and NULL is "".
    std::string exact_text(int column) const;
    std::int64_t integer(int column) const { return statement_.getColumn(column).getInt64(); }
    /// A whole number within the bounds. Throws InputError that names the column if it is another
    /// number, a text or NULL.
    int whole(int column, int least, int most = std::numeric_limits<int>::max()) const;
    std::size_t count(int column) const;  ///< the same from 0 to 2^53
    double number(int column) const {     ///< NaN for NULL and for numbers that are not finite
      const double value = null(column) ? std::nan("") : statement_.getColumn(column).getDouble();
      return std::isfinite(value) ? value : std::nan("");
    }

   private:
    [[noreturn]] void fail(int column, const std::string& why) const;
    Database& of_;
    SQLite::Statement& statement_;
  };

  /// Runs a query. The values are bound to its "?" in order: texts, whole numbers, doubles (NULL if
  /// not finite), nullptr (NULL) or Bytes. Read all rows before you start the same query again.
  template <class... Values>
  Rows rows(const std::string& sql, const Values&... values) {
    SQLite::Statement& statement = prepared(sql);
    int place = 0;
    guarded([&] { (bind(statement, ++place, values), ...); });
    return Rows(*this, statement);
  }
  /// Runs one statement whose rows, if any, are ignored.
  template <class... Values>
  void run(const std::string& sql, const Values&... values) {
    Rows all = rows(sql, values...);
    while (all.next()) {
    }
  }
  /// Runs a statement built from a list of columns. There must be one value for each "?".
  using Value = std::variant<std::nullptr_t, std::int64_t, double, std::string>;
  void run_with(const std::string& sql, const std::vector<Value>& values);
  /// Several statements, separated by semicolons.
  void script(const std::string& sql);
  /// First column of the first row of a query that has a row.
  std::int64_t number_of(const std::string& sql);
  /// Runs `work` and commits all that it writes, or nothing if it throws. A nested call belongs to
  /// the outer transaction.
  void transaction(const std::function<void()>& work);

  /// The SQL statements that created the tables, indexes, views and triggers, by kind and name
  /// ("table", "cases").
  using Parts = std::map<std::pair<std::string, std::string>, std::string>;
  Parts parts();

  struct Bytes {
    const std::string& bytes;
  };

 private:
  SQLite::Statement& prepared(const std::string& sql);
  [[noreturn]] void fail(const SQLite::Exception&) const;
  template <class Work>
  auto guarded(const Work& work) const {
    errno = 0;
    try {
      return work();
    } catch (const SQLite::Exception& error) {
      fail(error);
    }
  }
  static void bind(SQLite::Statement& s, int at, const std::string& text) { s.bind(at, text); }
  static void bind(SQLite::Statement& s, int at, std::nullptr_t) { s.bind(at); }
  static void bind(SQLite::Statement& s, int at, int number) { s.bind(at, number); }
  static void bind(SQLite::Statement& s, int at, std::size_t number) {
    s.bind(at, static_cast<std::int64_t>(number));
  }
  static void bind(SQLite::Statement& s, int at, std::int64_t number) { s.bind(at, number); }
  static void bind(SQLite::Statement& s, int at, double number) {
    std::isfinite(number) ? s.bind(at, number) : s.bind(at);
  }
  static void bind(SQLite::Statement& s, int at, const Bytes& b) {
    s.bind(at, b.bytes.data(), static_cast<int>(b.bytes.size()));
  }

  std::filesystem::path file_;
  std::unique_ptr<SQLite::Database> db_;
  std::map<std::string, SQLite::Statement> statements_;  ///< by their text
  bool within_ = false;                                  ///< whether a transaction is open
};

/// Result of Database::parts() for a file that these statements created.
Database::Parts parts_made_by(const std::string& statements);

/// Whether the file is not a complete SQLite file, or its indexes and references disagree with its
/// rows.
bool damaged(const std::filesystem::path& file);

}  // namespace taut
