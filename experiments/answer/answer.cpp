#include "experiments/answer/answer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<Cell::State::astray> kStates{"value", "none", "refused", "not_run", "astray"};
}

std::string_view to_string(Cell::State state) { return kStates[state]; }

std::optional<Cell::State> cell_state(std::string_view name) { return kStates.find(name); }

Cell::Cell(double number) {
  if (!std::isfinite(number)) return;
  value = number;
  state = State::value;
}

Cell::Cell(const Interval& i) {
  *this = Cell(i.mid);
  if (std::isfinite(i.low) && std::isfinite(i.mid) && std::isfinite(i.high)) value = i;
}

Cell Cell::lacking(State why, std::string words) {
  Cell cell(std::move(words));
  cell.state = why;
  return cell;
}

Cell Cell::with(std::string a_note) const {
  Cell noted = *this;
  noted.note = std::move(a_note);
  return noted;
}

Cell Cell::of_scene(std::string name) const {
  Cell named = *this;
  named.scene = std::move(name);
  return named;
}

Cell Cell::toned(Tone a_tone) const {
  Cell other = *this;
  other.tone = a_tone;
  return other;
}

Cell cell_of(Status::Kind kind) {
  return Cell(to_string(kind))
      .toned(kind == Status::Kind::ok ? Cell::Tone::good : Cell::Tone::plain);
}

std::string Cell::text() const {
  const auto* own = std::get_if<std::string>(&value);
  return own ? *own : "";
}

double Cell::number() const {
  if (const auto* own = std::get_if<double>(&value)) return *own;
  if (const auto* own = std::get_if<Interval>(&value)) return own->mid;
  return std::numeric_limits<double>::quiet_NaN();
}

Column::Column(std::string a_name, std::string a_heading, const Unit& of, int some_digits)
    : name(std::move(a_name)),
      heading(std::move(a_heading)),
      unit(of.si),
      shown(of.shown),
      scale(of.scale),
      digits(some_digits) {
  if (!heading.empty()) return;
  heading = name;
  std::ranges::replace(heading, '_', ' ');
}

Column Column::in_detail() const {
  Column other = *this;
  other.detail = true;
  return other;
}

Column Column::of_commands() const {
  Column other = *this;
  other.command = true;
  return other;
}

void Answer::add(Column column, Cell cell) {
  facts.push_back({std::move(column), std::move(cell)});
}

Table& Answer::add(Table table) { return tables.emplace_back(std::move(table)); }

const Cell& Answer::fact(std::string_view name) const {
  static const Cell kEmpty;
  const auto at = std::ranges::find(facts, name, [](const Fact& f) { return f.column.name; });
  return at == facts.end() ? kEmpty : at->cell;
}

const Table& Answer::table(std::string_view name) const {
  static const Table kEmpty{};
  const auto at = std::ranges::find(tables, name, &Table::name);
  return at == tables.end() ? kEmpty : *at;
}

const Cell& Table::at(const std::vector<Cell>& row, std::string_view column) const {
  const auto at = std::ranges::find(columns, column, &Column::name);
  if (at == columns.end())
    throw InputError("table '" + name + "' has no column '" + std::string(column) + "'");
  return row[static_cast<std::size_t>(at - columns.begin())];
}

std::string text(const Cell& cell, const Column& column, bool with_unit) {
  if (cell.empty()) return cell.note.empty() ? "-" : cell.note;
  const std::string_view shown = with_unit ? std::string_view(column.shown) : std::string_view();
  const Unit unit{Unit::Kind::other, column.unit, shown, column.scale};
  std::string said = cell.text();
  if (const auto* yes = std::get_if<bool>(&cell.value)) said = *yes ? "yes" : "no";
  if (const auto* number = std::get_if<double>(&cell.value))
    said = column.shown.empty() || with_unit ? number_text(*number, unit, column.digits)
                                             : number_text(*number * unit.scale, column.digits);
  if (const auto* interval = std::get_if<Interval>(&cell.value))
    said = interval_text(*interval, unit, column.digits) +
           (unit.shown.empty() ? "" : " " + std::string(unit.shown));
  return cell.note.empty() ? said : said + " (" + cell.note + ")";
}

std::string label(const Column& column) {
  return column.shown.empty() ? column.heading : column.heading + " [" + column.shown + "]";
}

}  // namespace taut
