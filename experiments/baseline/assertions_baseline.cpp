#include "experiments/baseline/assertions_baseline.hpp"

#include <algorithm>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

std::string figure_text(const Finding& f) {
  return solver_name(f.subject) + ": " + f.quantity + formatted(" %.4g", f.measured) +
         (f.unit == "1" ? "" : " " + f.unit) +
         (f.expected == 0 ? formatted(" (at most %.3g)", f.tolerance)
                          : formatted(" (%.4g +- %.3g)", f.expected, f.tolerance));
}

/// What speaks for an assertion: a number that breaks it, else the first that is measured and
/// begins so.
const Finding* telling(const std::vector<Finding>& findings, std::string_view begins) {
  const Finding* told = nullptr;
  for (const Finding& f : findings) {
    if (f.verdict == TruthVerdict::broken) return &f;
    const bool quoted = f.quantity.starts_with(begins) && f.verdict != TruthVerdict::not_applicable;
    if (!told && quoted) told = &f;
  }
  return told;
}

const JudgedAssertion* find(const std::vector<JudgedAssertion>& all, const JudgedAssertion& one) {
  const auto at = std::ranges::find_if(
      all, [&](const auto& c) { return c.section == one.section && c.assertion == one.assertion; });
  return at == all.end() ? nullptr : &*at;
}

std::string name(const JudgedAssertion& assertion) {
  return assertion.section + " \"" + assertion.assertion + "\"";
}

}  // namespace

std::vector<JudgedAssertion> judge_assertions(const FindingsOf& findings_of) {
  std::vector<JudgedAssertion> all;
  for (const VasiloviciAssertion& assertion : vasilovici_assertions()) {
    JudgedAssertion judged{std::string(assertion.section), std::string(assertion.assertion),
                           std::string(to_string(assertion.verdict)), ""};
    if (!assertion.truth.empty()) {
      const std::vector<Finding>* findings = findings_of(assertion.truth);
      if (!findings) continue;
      const Finding* told = telling(*findings, assertion.figure);
      if (!told || told->verdict == TruthVerdict::broken) judged.verdict = "overturned";
      if (told) judged.figure = figure_text(*told);
    }
    all.push_back(std::move(judged));
  }
  return all;
}

std::string to_json_lines(const std::vector<JudgedAssertion>& assertions) {
  std::string text;
  for (const auto& [section, assertion, verdict, figure] : assertions)
    text += to_text(Json{{"section", section},
                         {"assertion", assertion},
                         {"verdict", verdict},
                         {"figure", figure}}) +
            "\n";
  return text;
}

std::vector<JudgedAssertion> read_assertions(const std::filesystem::path& file) {
  return read_json_lines(file, [](const JsonReader& json) {
    const auto text = [&](const char* key) { return printable(json.at(key).text()); };
    return JudgedAssertion{text("section"), text("assertion"), text("verdict"), text("figure")};
  });
}

std::vector<std::string> compare_assertions(const std::vector<JudgedAssertion>& before,
                                            const std::vector<JudgedAssertion>& now) {
  std::vector<std::string> changes;
  for (const JudgedAssertion& is : now) {
    const JudgedAssertion* was = find(before, is);
    if (!was)
      changes.push_back("assertion " + name(is) + " is not in the baseline");
    else if (was->verdict != is.verdict)
      changes.push_back("assertion " + name(is) + ": '" + was->verdict + "' -> '" + is.verdict +
                        "'" + (is.figure.empty() ? "" : "; " + is.figure));
  }
  for (const JudgedAssertion& was : before)
    if (!find(now, was)) changes.push_back("assertion " + name(was) + " is gone");
  return changes;
}

}  // namespace taut
