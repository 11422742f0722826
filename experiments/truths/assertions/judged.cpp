#include "experiments/truths/assertions/judged.hpp"

#include "core/model/solver.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

std::string figure_text(const Finding& f) {
  return solver_name(f.subject) + ": " + f.quantity + " " + general(f.measured, 4) +
         (f.unit == "1" ? "" : " " + f.unit) +
         (f.expected == 0 ? " (at most " + general(f.tolerance, 3) + ")"
                          : " (" + general(f.expected, 4) + " +- " + general(f.tolerance, 3) + ")");
}

/// The finding to quote for an assertion: one that breaks it, otherwise the first measured one, of
/// its quantity and its solver if it names them.
const Finding* quoted(const std::vector<Finding>& findings, const Assertion& assertion) {
  const Finding* told = nullptr;
  for (const Finding& f : findings) {
    if (f.verdict == TruthVerdict::broken) return &f;
    const bool asked = (assertion.figure.empty() || f.quantity == assertion.figure) &&
                       (assertion.solver.empty() || solver_name(f.subject) == assertion.solver);
    if (!told && asked && f.verdict != TruthVerdict::not_applicable) told = &f;
  }
  return told;
}

}  // namespace

std::vector<JudgedAssertion> judge_assertions(const FindingsOf& findings_of) {
  std::vector<JudgedAssertion> all;
  for (const Assertion& assertion : assertions()) {
    JudgedAssertion judged{std::string(assertion.source), std::string(assertion.place),
                           std::string(assertion.assertion), assertion.verdict, ""};
    if (!assertion.truth.empty()) {
      const std::vector<Finding>* findings = findings_of(assertion.truth);
      if (!findings) continue;
      const Finding* told = quoted(*findings, assertion);
      if (!told || told->verdict == TruthVerdict::broken)
        judged.verdict = AssertionVerdict::overturned;
      if (told) judged.figure = figure_text(*told);
    }
    all.push_back(std::move(judged));
  }
  return all;
}

}  // namespace taut
