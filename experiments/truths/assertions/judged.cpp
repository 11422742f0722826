#include "experiments/truths/assertions/judged.hpp"

#include "core/model/solver.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

std::string figure_text(const Finding& f) {
  return solver_name(f.subject) + ": " + f.quantity + formatted(" %.4g", f.measured) +
         (f.unit == "1" ? "" : " " + f.unit) +
         (f.expected == 0 ? formatted(" (at most %.3g)", f.tolerance)
                          : formatted(" (%.4g +- %.3g)", f.expected, f.tolerance));
}

/// The finding to quote for an assertion: one that breaks it, otherwise the first measured one
/// whose quantity begins with this text.
const Finding* beginning_with(const std::vector<Finding>& findings, std::string_view begins) {
  const Finding* told = nullptr;
  for (const Finding& f : findings) {
    if (f.verdict == TruthVerdict::broken) return &f;
    const bool quoted = f.quantity.starts_with(begins) && f.verdict != TruthVerdict::not_applicable;
    if (!told && quoted) told = &f;
  }
  return told;
}

}  // namespace

std::vector<JudgedAssertion> judge_assertions(const FindingsOf& findings_of) {
  std::vector<JudgedAssertion> all;
  for (const Assertion& assertion : assertions()) {
    JudgedAssertion judged{std::string(assertion.source), std::string(assertion.place),
                           std::string(assertion.assertion),
                           std::string(to_string(assertion.verdict)), ""};
    if (!assertion.truth.empty()) {
      const std::vector<Finding>* findings = findings_of(assertion.truth);
      if (!findings) continue;
      const Finding* told = beginning_with(*findings, assertion.figure);
      if (!told || told->verdict == TruthVerdict::broken) judged.verdict = "overturned";
      if (told) judged.figure = figure_text(*told);
    }
    all.push_back(std::move(judged));
  }
  return all;
}

}  // namespace taut
