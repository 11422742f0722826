#include "experiments/report/questions/failure_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/task.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/input.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/way.hpp"

namespace taut::report {

namespace {

constexpr double kLate = 0.9, kStrained = 0.005, kGained = 0.02;
constexpr std::string_view kStiffness = "links.stiffness";

/// "structural = 1e3" from a case's settings; "" if they do not set stiffness.
std::string stiffness_of(const Record& r) {
  const SceneSetting* setting = find_setting(r.spec.settings, kStiffness);
  if (!setting) return "";
  std::string text = setting->value();
  std::erase_if(text, [](char c) { return c == '{' || c == '}'; });
  const auto first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// Column of a case: "swing, structural = 1e3".
std::string column_of(const Record& r) { return r.scene + ", " + stiffness_of(r); }

std::string row_of(const Record& r) { return titled(r.solver, brief_settings(r)); }

const char* verdict(const Record& r) {
  const auto value = [&](std::string_view name) { return r.value(std::string(name)); };
  // The share of the way means nothing then.
  if (value("stretch.rms") > kStrained) return "strains";
  const WayGone gone = way_gone(r);
  if (gone.by != WayGone::By::nothing) {
    if (gone.share < kLeastMotion) return "freezes";
    if (gone.share < kLate) return "late";
  }
  if (value("energy.peak") > kGained) return "gains energy";
  return "right";
}

/// Note of a case: "100 % of the way, strain 0.086 %, energy -0.012, 20 ms a simulated second".
std::string numbers(const Record& r) {
  std::vector<std::string> all;
  const auto add = [&](std::string_view name, const std::string& before, const std::string& after) {
    const double value = r.value(std::string(name));
    if (std::isfinite(value)) all.push_back(before + quantity(name).text(value) + after);
  };
  if (const WayGone gone = way_gone(r); gone.by != WayGone::By::nothing)
    all.push_back(shown(kSignedShare, gone.share) + " of the way");
  add("stretch.rms", "strain ", "");
  add("energy.peak", "energy ", " m g L");
  add(kCpuPerSecond, "", " a simulated second");
  return join(all, ", ");
}

Cell cell_of(const Record& r, CaseList* list) {
  const bool refused = r.status.kind == Status::Kind::unsupported;
  Cell cell = completed(r.status)
                  ? Cell(verdict(r)).with(numbers(r))
                  : Cell::lacking(refused ? Cell::State::refused : Cell::State::none,
                                  refused ? "cannot: " + r.status.reason.text()
                                          : std::string(to_string(r.status.kind)));
  if (list) cell.key = list->key(r);
  return cell;
}

}  // namespace

Table failure_map(const Records& records, const std::vector<Record>& timed, CaseList* list) {
  Table table{
      kFailureMap,
      "Who is right on soft, stiff, taut and slack cloth: who freezes, who strains",
      {Column("solver")},
      {},
      "strains: RMS stretch above " + shown(kShare, kStrained, 1) + "; freezes: less than " +
          shown(kShare, kLeastMotion, 2) +
          " of the way (of a reference in motion, else of exact steps, else by what steps miss); "
          "late: less than " +
          shown(kShare, kLate, 2) + "; gains energy: above " + shown(kShare, kGained, 1) +
          " of m g L more than at the start; else right. The first of these that holds."};
  Records here;
  for (const Record* r : records) {
    if (stiffness_of(*r).empty()) continue;
    const auto with_cost = std::ranges::find(timed, r->key, &Record::key);
    here.push_back(with_cost == timed.end() ? r : &*with_cost);
  }
  const auto columns = distinct(here, [](const Record* r) { return column_of(*r); });
  if (distinct(here, [](const Record* r) { return stiffness_of(*r); }).size() < 2) return table;
  for (const std::string& column : columns) table.columns.emplace_back(column, column);
  const auto rows = distinct(here, [](const Record* r) { return row_of(*r); });
  for (const std::string& row : rows) {
    table.rows.emplace_back(columns.size() + 1);
    table.rows.back()[0] = row;
  }
  for (const Record* r : here) {
    const auto row = std::ranges::find(rows, row_of(*r)) - rows.begin();
    const auto column = std::ranges::find(columns, column_of(*r)) - columns.begin();
    table.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column) + 1] =
        cell_of(*r, list);
  }
  return table;
}

}  // namespace taut::report
