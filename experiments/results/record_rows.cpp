#include "experiments/results/record_rows.hpp"

#include "core/model/input_error.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/record_parts.hpp"
#include "experiments/results/schema.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr int kNone = -1;  ///< of a whole number that is not known: NULL in the file

// Conversions between a column of a record and its form in the file. What is not a single value is
// stored as JSON text.

Database::Value kept(const std::string& text) { return text; }
Database::Value kept(double number) { return number; }
Database::Value kept(std::size_t count) { return static_cast<std::int64_t>(count); }
Database::Value kept(int number) {
  if (number == kNone) return nullptr;
  return std::int64_t{number};
}
Database::Value kept(Status::Kind kind) { return std::string(to_string(kind)); }
Database::Value kept(const StatusReason& reason) { return reason.text(); }
template <class Value>
Database::Value kept(const Value& value) {
  return to_text(Json(value));
}

void read(const Database::Rows& row, int column, std::string& text) { text = row.text(column); }
void read(const Database::Rows& row, int column, double& number) { number = row.number(column); }
/// The number is at least that of an empty record, as in JSON; NULL only where that is kNone.
void read(const Database::Rows& row, int column, int& number) {
  if (number != kNone || !row.null(column)) number = row.whole(column, number);
}
void read(const Database::Rows& row, int column, std::size_t& count) { count = row.count(column); }
void read(const Database::Rows& row, int column, Status::Kind& kind) {
  kind = status_kind(row.text(column));
}
void read(const Database::Rows& row, int column, StatusReason& reason) {
  reason = StatusReason::stored(row.text(column));
}
template <class Value>
void read(const Database::Rows& row, int column, Value& value) {
  read_json(row.text(column), case_columns()[static_cast<std::size_t>(column)],
            [&](const JsonReader& j) {
              read_into(j, value);
              return true;
            });
}

/// Reads a record, without its values, from case_columns(). Throws InputError that names the
/// column.
Record record_in(const Database::Rows& row) {
  Record r;
  int at = 0;
  for (const RecordColumn& column : record_columns())
    if (!column.column.empty())
      with_member(r, column, [&](auto& member) { read(row, at++, member); });
  if (const auto wrong = impossible_field(r))
    throw InputError(std::string(wrong->name) + ": " + wrong->why);
  return r;
}

}  // namespace

std::optional<Record> record_of_row(const Database::Rows& row, std::string& why) {
  try {
    return record_in(row);
  } catch (const InputError& error) {
    why = error.what();
    return {};
  }
}

std::vector<Database::Value> row_of(const Record& record) {
  std::vector<Database::Value> row;
  for (const RecordColumn& column : record_columns())
    if (!column.column.empty())
      row.push_back(with_member(record, column, [](const auto& member) { return kept(member); }));
  return row;
}

}  // namespace taut
