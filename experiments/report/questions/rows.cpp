#include "experiments/report/questions/rows.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"

namespace taut::report {

Interval geometric_mean(const std::vector<Interval>& ratios) {
  double mid = 0, below = 0, above = 0;
  for (const Interval& r : ratios) {
    mid += std::log(r.mid);
    below += std::pow(std::log(r.mid / r.low), 2);
    above += std::pow(std::log(r.high / r.mid), 2);
  }
  const auto n = static_cast<double>(ratios.size());
  return {std::exp((mid - std::sqrt(below)) / n), std::exp(mid / n),
          std::exp((mid + std::sqrt(above)) / n)};
}

std::vector<Column> columns_of(const std::vector<Column>& solvers, const Unit& unit, int digits) {
  std::vector<Column> columns{Column("scene")};
  for (const Column& solver : solvers)
    columns.emplace_back(solver.name, solver.heading, unit, digits);
  return columns;
}

bool is_compared(const Cell& cell) {
  return !std::isnan(cell.number()) && cell.state == Cell::State::value;
}

void mark_least(std::vector<Cell>& row, double floor) {
  Cell *least = nullptr, *second = nullptr;
  const auto value = [&](const Cell& cell) { return std::max(cell.number(), floor); };
  for (Cell& cell : row) {
    if (!is_compared(cell)) continue;
    if (!least || value(cell) < value(*least))
      second = std::exchange(least, &cell);
    else if (!second || value(cell) < value(*second))
      second = &cell;
  }
  if (second) least->best = value(*second) > (1 + kTolerance) * value(*least);
}

Common common_of(const Table& table, double floor) {
  Common common;
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    if (std::ranges::any_of(table.rows, [&](const auto& row) { return is_compared(row[c]); }))
      common.columns.push_back(c);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto& row = table.rows[r];
    if (std::ranges::all_of(common.columns, [&](std::size_t c) { return is_compared(row[c]); }) &&
        (floor <= 0 || std::ranges::any_of(common.columns, [&](std::size_t c) {
           return row[c].number() >= floor;
         })))
      common.rows.push_back(r);
  }
  return common;
}

Cell Common::label(const Table& table, const std::string& what) const {
  if (rows.size() == 1 && table.rows.size() == 1) return table.rows[0][0];
  if (rows.empty()) return Cell("no scene has all: scenes with a value");
  std::string without;
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    if (std::ranges::find(rows, r) == rows.end())
      without += (without.empty() ? "without " : ", ") + table.rows[r][0].text();
  return Cell(what + " " + std::to_string(rows.size()) + (rows.size() == 1 ? " scene" : " scenes"))
      .with(without);
}

Cell why_empty(const Table& table, std::size_t column) {
  std::set<std::string> words;
  std::set<Cell::State> states;
  for (const auto& row : table.rows) {
    const Cell& cell = row[column];
    states.insert(cell.state);
    words.insert(std::isnan(cell.number()) ? cell.text() : "is elsewhere");
  }
  if (words.size() != 1) return Cell::lacking(Cell::State::none, "no value");
  return Cell::lacking(states.size() == 1 ? *states.begin() : Cell::State::none, *words.begin());
}

std::string with_value(const Table& table, std::size_t column) {
  const auto count =
      std::ranges::count_if(table.rows, [&](const auto& row) { return is_compared(row[column]); });
  return std::to_string(count) + " of " + std::to_string(table.rows.size());
}

std::vector<Cell> last_row(const Table& table, const Common& common, const std::string& what,
                           const std::function<Cell(std::size_t column)>& sum) {
  std::vector<Cell> last{common.label(table, what)};
  for (std::size_t c = 1; c < table.columns.size(); ++c) {
    if (std::ranges::find(common.columns, c) == common.columns.end())
      last.push_back(why_empty(table, c));
    else if (common.rows.empty())
      last.push_back(Cell::lacking(Cell::State::none, with_value(table, c)));
    else
      last.push_back(common.rows.size() == 1 ? table.rows[common.rows[0]][c] : sum(c));
    last.back().best = false;
  }
  return last;
}

Cell why_none(const Record* r) {
  if (!r) return Cell::lacking(Cell::State::not_run, "not run");
  if (completed(r->status)) return Cell::lacking(Cell::State::none, "no value");
  if (r->status.kind == Status::Kind::unsupported)
    return Cell::lacking(Cell::State::refused, "cannot: " + r->status.reason.text());
  return Cell::lacking(Cell::State::none, std::string(to_string(r->status.kind)));
}

}  // namespace taut::report
