// Tables of what scenes require and how far solvers go, of what differs between two folders, and of
// what Vasilovici's report asserts.
#include <algorithm>
#include <cmath>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/truths/assertions/assertions.hpp"

namespace taut::report {

void add_by_id(Json& part, const char* list, Json one, Json& all) {
  part[list].push_back(one["id"]);
  all.push_back(std::move(one));
}

Json json_table(const std::string& id, const std::string& title, const std::string& caption,
                const Json& columns) {
  Json table{{"id", id}, {"title", title}, {"caption", caption}};
  for (const Json& column : columns)
    table["columns"].push_back(column.is_string() ? Json{{"title", column}} : column);
  table["rows"] = Json::array();
  return table;
}

namespace {

std::string setting_text(double value, const ParameterFrontier& one) {
  return significant(value, 3) + (one.unit.empty() ? "" : "\u00A0" + one.unit);
}

std::string end_text(const ParameterFrontier& one) {
  if (!one.lacks.empty()) return "–: " + one.lacks;
  if (std::isnan(one.bad)) return setting_text(one.to, one) + ", as far as was asked";
  return (std::isnan(one.good) ? "none" : setting_text(one.good, one)) + ", then " + one.symptom +
         (std::isnan(one.theory) ? "" : " (theory: " + setting_text(one.theory, one) + ")");
}

Json frontier_table(const std::vector<ParameterFrontier>& frontiers) {
  std::vector<std::string> columns{"parameter"}, parameters;
  for (const ParameterFrontier& f : frontiers)
    push_unique(columns, f.solver), push_unique(parameters, f.parameter);
  Json table = json_table(
      "frontiers", "How far every parameter goes on a small swinging sheet",
      "The hardest setting up to which nothing was wrong, and what goes wrong first beyond it, "
      "by its own metric; taut frontier --all.",
      columns);
  for (const std::string& parameter : parameters) {
    Json row = Json::array({parameter});
    for (std::size_t i = 1; i < columns.size(); ++i) {
      const auto at = std::ranges::find_if(frontiers, [&](const auto& f) {
        return f.parameter == parameter && f.solver == columns[i];
      });
      row.push_back(at == frontiers.end() ? "–" : end_text(*at));
    }
    table["rows"].push_back(std::move(row));
  }
  return table;
}

constexpr std::size_t kMostRows = 200;  ///< of the table; the data has all

/// A value of a case that B has otherwise.
struct Changed {
  const std::pair<Record, Record>* pair;
  const std::string* value;  ///< nullptr: the status
  double size;               ///< |b - a| over the larger; 2: another status
};

/// The largest first.
std::vector<Changed> all_changed(const Differences& differences) {
  std::vector<Changed> all;
  for (const auto& pair : differences.pairs) {
    const auto& [a, b] = pair;
    if (a.status.kind != b.status.kind) {
      all.push_back({&pair, nullptr, 2});
      continue;
    }
    if (!completed(b.status)) continue;
    for (const auto& [name, now] : b.values) {
      const auto at = a.values.find(name);
      if (at == a.values.end() || !std::isfinite(now) || !std::isfinite(at->second)) continue;
      const double before = at->second;
      if (now != before)
        all.push_back(
            {&pair, &name, std::abs(now - before) / std::max(std::abs(now), std::abs(before))});
    }
  }
  std::ranges::stable_sort(all, [](const Changed& x, const Changed& y) { return x.size > y.size; });
  return all;
}

/// Its row: what it is, in A, in B, the change, and whether that is better.
Json row_of(const Changed& changed, Citations& refs) {
  const auto& [a, b] = *changed.pair;
  Json head{{"text", b.scene + " " + solver_title(b.solver) + " " + brief_settings(b.spec.solver) +
                         ", " + quantity("dt").text(b.dt, 3)}};
  add_if(head, "case", refs.key(b));
  if (!changed.value)
    return {head, "status", to_string(a.status.kind), to_string(b.status.kind), "–", ""};
  const Quantity& q = refs.use(*changed.value);
  const double before = a.values.at(*changed.value), now = b.values.at(*changed.value);
  return {head,
          q.title,
          q.text(before, 4),
          q.text(now, 4),
          before == 0 ? "–" : shown(kShare, now / before - 1),
          !q.unit.less_is_better ? ""
          : now < before         ? "better"
                                 : "worse"};
}

}  // namespace

Json json_of_limits(const ReportInput& input, Json& tables) {
  Json limits;
  if (!input.required.empty()) {
    Json table = json_table(
        "required", "The smallest model that keeps a scene's answers",
        "taut require takes away or coarsens one effect at a time and then all that can go; an "
        "answer may move by its tolerance, or by what a rounding error at the start moves it. Of "
        "a chaotic scene only statistics are kept.",
        {"scene", "solver", "chaotic", "kept answers", "can go", "required", "CPU time left"});
    table["rows"] = input.required;
    add_by_id(limits, "tables", std::move(table), tables);
  }
  if (!input.frontiers.empty())
    add_by_id(limits, "tables", frontier_table(input.frontiers), tables);
  return limits;
}

Json json_of(const Differences& differences, Citations& refs, Json& tables) {
  const std::vector<Changed> changed = all_changed(differences);
  Json one{{"a", differences.a}, {"b", differences.b}};
  if (changed.empty()) return one;
  const std::size_t rows = std::min(changed.size(), kMostRows);
  Json table = json_table("differences-values", "Values that differ",
                          "The " + std::to_string(rows) + " largest relative changes of " +
                              std::to_string(changed.size()) +
                              "; better and worse where a value is an error.",
                          {"case", "value", "A", "B", "change", "judged"});
  for (std::size_t i = 0; i < rows; ++i) table["rows"].push_back(row_of(changed[i], refs));
  add_by_id(one, "tables", std::move(table), tables);
  return one;
}

Json json_of_assertions(const std::optional<Truths>& truths) {
  Json all = Json::array();
  for (const Assertion& assertion : assertions()) {
    Json one{{"section", std::string(assertion.source) + ", " + std::string(assertion.place)},
             {"assertion", typeset(assertion.assertion)},
             {"verdict", to_string(assertion.verdict)},
             {"because", typeset(assertion.because)}};
    if (truths)
      if (const auto now = truths->assertions.find(std::string(assertion.assertion));
          now != truths->assertions.end()) {
        one["verdict"] = now->second.first;
        add_if(one, "figure", typeset(now->second.second));
      }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace taut::report
