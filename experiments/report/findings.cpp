#include "experiments/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/report/chart/one_step.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

namespace {

/// A row of the findings of `taut verify`, by the names of their columns.
struct Found {
  const Table& table;
  const std::vector<Cell>& row;
  std::string text(const char* column) const { return table.at(row, column).text(); }
  double number(const char* column) const { return table.at(row, column).number(); }

  /// How far a finding is on the way to its tolerance; 1: at it.
  double share_of_tolerance() const {
    const double off = std::abs(number("measured") - number("expected"));
    return number("tolerance") > 0 ? off / number("tolerance") : off;
  }
};

/// A row of the model: a closed form or a published number beside what was measured.
Json row_of(const Found& truth, const Found& finding) {
  const std::string si = finding.text("unit"), unit = si == "1" ? "" : " " + si,
                    verdict = finding.text("verdict");
  const double expected = finding.number("expected"), slack = finding.number("tolerance");
  Json row{{"section", truth.text("section_title")},
           {"statement", typeset(truth.text("statement"))},
           {"source", typeset(truth.text("source"))},
           {"subject", finding.text("subject")},
           {"expected", ""},
           {"measured", ""},
           {"verdict", verdict}};
  add_if(row, "why", typeset(finding.text("why")));
  if (verdict == "not applicable") return row;
  const double measured = finding.number("measured");
  const auto say = [&](const std::string& wanted, const std::string& found) {
    row["expected"] = typeset(wanted), row["measured"] = typeset(found);
    return row;
  };
  if (expected == 0)
    return say("at most " + significant(slack, 2) + unit, significant(measured, 2) + unit);
  // As many digits as the tolerance lets matter.
  if (slack >= 1e-6 && std::abs(measured) < 1e6) {
    const int decimals = decimals_for(slack);
    return say(fixed(expected, decimals) + " ± " + fixed(slack, decimals) + unit,
               fixed(measured, decimals) + unit);
  }
  if (slack > 0)
    return say(significant(expected, 6) + " ± " + significant(slack, 2) + unit,
               significant(measured, 6) + unit);
  return say("exactly " + significant(expected, 3) + unit, significant(measured, 3) + unit);
}

/// What `read` makes of each answer of a kind.
template <class Read>
auto found(const Store& store, const char* kind, std::string_view program, Read read) {
  std::vector<std::invoke_result_t<Read, const Answer&>> all;
  for (const Answer& answer : store.answers(kind, program)) try {
      all.push_back(read(answer));
    } catch (const InputError& error) {
      throw InputError(store.file().string() + ": answer of " + kind + ": " + error.what());
    }
  return all;
}

template <class Value>
std::optional<Value> only(std::vector<Value> all) {
  return all.empty() ? std::nullopt : std::optional(std::move(all.front()));
}

std::size_t count(const Answer& answer, const char* fact) {
  const double number = answer.fact(fact).number();
  if (!(number >= 0 && number < 1e15)) throw InputError("has no number of " + std::string(fact));
  return static_cast<std::size_t>(number);
}

/// Of each truth the finding nearest to its tolerance, and all that did not simply pass.
Truths truths_of(const Answer& answer) {
  const Table &all = answer.table("truths"), &findings = answer.table("findings"),
              &assertions = answer.table("assertions");
  Truths truths;
  std::map<std::string, int> verdicts;
  Json rows;
  for (const auto& own : all.rows) {
    const Found truth{all, own};
    std::optional<std::size_t> nearest;
    Json apart;
    for (std::size_t i = 0; i < findings.rows.size(); ++i) {
      const Found finding{findings, findings.rows[i]};
      if (finding.text("truth") != truth.text("name")) continue;
      const std::string verdict = finding.text("verdict");
      ++verdicts[verdict];
      if (verdict != "passed")
        apart.push_back(row_of(truth, finding));
      else if (!nearest || finding.share_of_tolerance() >
                               Found{findings, findings.rows[*nearest]}.share_of_tolerance())
        nearest = i;
    }
    if (nearest) rows.push_back(row_of(truth, {findings, findings.rows[*nearest]}));
    for (Json& row : apart) rows.push_back(std::move(row));
  }
  truths.shown = {
      {"truths", all.rows.size()}, {"findings", findings.rows.size()}, {"verdicts", verdicts}};
  add_if(truths.shown, "rows", std::move(rows));
  for (const auto& row : assertions.rows) {
    const Found one{assertions, row};
    truths.assertions[one.text("assertion")] = {one.text("verdict"), one.text("figure")};
  }
  return truths;
}

}  // namespace

Json stored_requirements(const Store& store, std::string_view program) {
  Json rows;
  for (Json& row : found(store, "require", program, [](const Answer& answer) {
         const auto text = [&](const char* fact) { return answer.fact(fact).text(); };
         const double left = answer.fact("time_left").number();
         return Json::array({text("scene"), solver_title(solver_name(text("solver"))),
                             text("chaotic"), text("kept"), text("can_go"), text("required"),
                             std::isnan(left) ? "-" : number_text(left, kShare, 2)});
       }))
    rows.push_back(std::move(row));
  return rows;
}

std::vector<ParameterFrontier> stored_frontiers(const Store& store, std::string_view program) {
  std::vector<ParameterFrontier> all;
  for (const auto& one : found(store, "frontier", program, frontiers_of))
    all.insert(all.end(), one.begin(), one.end());
  return all;
}

std::vector<Answer> stored_steps(const Store& store, std::string_view program) {
  return found(store, "converge", program, [](const Answer& answer) {
    OneStep{answer};  // it can be drawn
    return answer;
  });
}

std::optional<Truths> stored_truths(const Store& store, std::string_view program) {
  return only(found(store, "verify", program, truths_of));
}

std::optional<Json> stored_regressions(const Store& store, std::string_view program) {
  return only(found(store, "check", program, [](const Answer& answer) {
    const Table& findings = answer.table("findings");
    Json regressions{{"cases", count(answer, "cases")}, {"values", count(answer, "values")}};
    for (const auto& row : findings.rows) {
      const Found one{findings, row};
      if (one.text("kind") == to_string(Change::Kind::value_new)) continue;  // for information
      regressions["rows"].push_back({{"study", one.text("study")},
                                     {"case", one.text("case")},
                                     {"change", one.text("change")}});
    }
    return regressions;
  }));
}

}  // namespace taut::report
