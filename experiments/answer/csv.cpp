#include <algorithm>
#include <functional>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

/// The fields that a column takes: an interval adds two for its ends, and notes add one.
struct Shape {
  bool interval = false, notes = false;
};

std::string field_of(const Cell& cell) {
  if (std::holds_alternative<bool>(cell.value)) return cell.is_true() ? "true" : "false";
  return cell.text().empty() ? exact(cell.number()) : csv_field(cell.text());
}

void add_fields(std::vector<std::string>& fields, const Cell& cell, const Shape& shape) {
  const auto* interval = std::get_if<Interval>(&cell.value);
  if (shape.interval) fields.push_back(exact(interval ? interval->low : cell.number()));
  fields.push_back(field_of(cell));
  if (shape.interval) fields.push_back(exact(interval ? interval->high : cell.number()));
  if (shape.notes) fields.push_back(csv_field(cell.note));
}

std::string csv_of(const Table& table) {
  std::vector<Shape> shapes(table.columns.size());
  for (const std::vector<Cell>& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      shapes[i].interval |= std::holds_alternative<Interval>(row[i].value);
      shapes[i].notes |= !row[i].note.empty();
    }
  std::vector<std::string> fields;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::string& name = table.columns[i].name;
    if (shapes[i].interval) fields.push_back(csv_field(name + "_low"));
    fields.push_back(csv_field(name));
    if (shapes[i].interval) fields.push_back(csv_field(name + "_high"));
    if (shapes[i].notes) fields.push_back(csv_field(name + "_note"));
  }
  std::string out = join(fields, ",") + '\n';
  for (const std::vector<Cell>& row : table.rows) {
    fields.clear();
    for (std::size_t i = 0; i < row.size(); ++i) add_fields(fields, row[i], shapes[i]);
    out += join(fields, ",") + '\n';
  }
  return out;
}

/// A table with name, value and unit of each fact. Its value column mixes texts and numbers.
Table as_table(const std::vector<Fact>& facts) {
  Table table{"facts", "", {{"name"}, {"value"}, {"unit"}}};
  for (const Fact& fact : facts)
    table.rows.push_back({fact.column.name, fact.cell, fact.column.unit});
  return table;
}

}  // namespace

std::string csv_field(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  if (!line.empty() && std::string_view("=+-@").find(line.front()) != std::string_view::npos)
    line.insert(0, "'");
  if (line.find_first_of(",\"") == std::string::npos) return line;
  std::string out = "\"";
  for (const char c : line) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string to_csv(const Answer& answer, std::string_view name) {
  if (name == "facts" || (name.empty() && answer.tables.empty()))
    return csv_of(as_table(answer.facts));
  if (name.empty()) return csv_of(answer.tables.front());
  if (const Table& table = answer.table(name); !table.columns.empty()) return csv_of(table);
  std::vector<std::string> names{"facts"};
  for (const Table& table : answer.tables) names.push_back(table.name);
  throw InputError("no table '" + std::string(name) + "' here" +
                   suggestion(std::string(name), names) + ": there are " + join(names, ", "));
}

std::string slug(std::string_view text) {
  constexpr std::size_t kMost = 120;  // a file name may have 255 bytes, including extensions
  std::string out;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_';
    if (plain && !(out.empty() && (c == '-' || c == '.')))
      out += c;
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  out.resize(std::min(out.size(), kMost));
  while (!out.empty() && (out.back() == '-' || out.back() == '.')) out.pop_back();
  if (!out.empty() && out == text) return out;
  // The digest keeps texts apart that differ only where characters were replaced or cut off.
  return (out.empty() ? "x" : out) +
         formatted("-%08zx", std::hash<std::string_view>{}(text)&0xFFFFFFFFU);
}

}  // namespace taut
