#include "experiments/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/baseline/check_answer.hpp"
#include "experiments/report/chart/one_step.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/require/requirement_answer.hpp"
#include "experiments/system/json.hpp"
#include "experiments/truths/verification.hpp"

namespace taut::report {

namespace {

/// Row of the model: a measured value, and the closed form or published number that it should have.
Json row_of(const CheckedTruth& truth, const Finding& finding) {
  const std::string unit = finding.unit == "1" ? "" : " " + finding.unit;
  const double measured = finding.measured, expected = finding.expected, slack = finding.tolerance;
  Json row{{"section", truth.section_title},
           {"statement", typeset(truth.statement)},
           {"source", typeset(truth.source)},
           {"subject", finding.subject},
           {"expected", ""},
           {"measured", ""},
           {"verdict", std::string(to_string(finding.verdict))}};
  add_if(row, "why", typeset(finding.why));
  if (finding.verdict == TruthVerdict::not_applicable) return row;
  const auto say = [&](const std::string& wanted, const std::string& found) {
    row["expected"] = typeset(wanted);
    row["measured"] = typeset(found);
    return row;
  };
  if (expected == 0)
    return say("at most " + significant(slack, 2) + unit, significant(measured, 2) + unit);
  // As many digits as the tolerance makes relevant.
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

/// Results of `read` for each answer of a kind.
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

/// For each truth the finding nearest to its tolerance, and all findings that did not simply pass.
Truths truths_of(const Answer& answer) {
  const Verification found = verification_in(answer);
  Truths truths;
  std::map<std::string, int> verdicts;
  std::size_t findings = 0;
  Json rows;
  for (const CheckedTruth& truth : found.truths) {
    const Finding* nearest = nullptr;
    Json apart;
    for (const Finding& finding : truth.findings) {
      ++findings;
      ++verdicts[std::string(to_string(finding.verdict))];
      if (finding.verdict != TruthVerdict::passed)
        apart.push_back(row_of(truth, finding));
      else if (!nearest || share_of_tolerance(finding) > share_of_tolerance(*nearest))
        nearest = &finding;
    }
    if (nearest) rows.push_back(row_of(truth, *nearest));
    for (Json& row : apart) rows.push_back(std::move(row));
  }
  truths.shown = {{"truths", found.truths.size()}, {"findings", findings}, {"verdicts", verdicts}};
  add_if(truths.shown, "rows", std::move(rows));
  for (const JudgedAssertion& one : found.assertions)
    truths.assertions[one.assertion] = {std::string(to_string(one.verdict)), one.figure};
  return truths;
}

}  // namespace

Json stored_requirements(const Store& store, std::string_view program) {
  Json rows;
  for (const RequirementSummary& one : found(store, "require", program, requirement_in))
    rows.push_back(Json::array(
        {one.scene, solver_title(solver_name(one.solver)), one.chaotic, one.kept, one.can_go,
         one.required, std::isnan(one.time_left) ? "-" : number_text(one.time_left, kShare, 2)}));
  return rows;
}

std::vector<ParameterFrontier> stored_frontiers(const Store& store, std::string_view program) {
  std::vector<ParameterFrontier> all;
  for (const auto& one : found(store, "frontier", program, frontiers_of))
    all.insert(all.end(), one.begin(), one.end());
  return all;
}

std::vector<OneStep> stored_steps(const Store& store, std::string_view program) {
  return found(store, "converge", program, [](const Answer& answer) { return OneStep(answer); });
}

std::optional<Truths> stored_truths(const Store& store, std::string_view program) {
  return only(found(store, "verify", program, truths_of));
}

std::optional<Json> stored_regressions(const Store& store, std::string_view program) {
  return only(found(store, "check", program, [](const Answer& answer) {
    const Regressions found = regressions_in(answer);
    Json regressions{{"cases", found.cases}, {"values", found.values}};
    for (const Regressions::Row& row : found.rows)
      if (row.kind != Change::Kind::value_new)  // only for information
        regressions["rows"].push_back(
            {{"study", row.study}, {"case", row.id}, {"change", row.change}});
    return regressions;
  }));
}

}  // namespace taut::report
