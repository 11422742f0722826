#include "experiments/baseline/claims_baseline.hpp"

#include <algorithm>
#include <cstdio>

#include "core/model/printable.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

std::string figure_text(const Finding& f) {
  char text[96];
  const std::string unit = f.unit == "1" ? "" : " " + f.unit;
  if (f.expected == 0)
    std::snprintf(text, sizeof text, " %.4g%s (at most %.3g)", f.measured, unit.c_str(),
                  f.tolerance);
  else
    std::snprintf(text, sizeof text, " %.4g%s (%.4g +- %.3g)", f.measured, unit.c_str(), f.expected,
                  f.tolerance);
  return f.subject.substr(0, f.subject.find(':')) + ": " + f.quantity + text;
}

/// What speaks for a claim: a number that breaks it, else the first that is measured and begins so.
const Finding* telling(const std::vector<Finding>& findings, std::string_view begins) {
  const Finding* told = nullptr;
  for (const Finding& f : findings) {
    if (f.verdict == TruthVerdict::broken) return &f;
    const bool quoted = f.quantity.starts_with(begins) && f.verdict != TruthVerdict::not_claimed;
    if (!told && quoted) told = &f;
  }
  return told;
}

const JudgedClaim* find(const std::vector<JudgedClaim>& all, const JudgedClaim& one) {
  const auto at = std::ranges::find_if(
      all, [&](const auto& c) { return c.section == one.section && c.claim == one.claim; });
  return at == all.end() ? nullptr : &*at;
}

std::string name(const JudgedClaim& claim) { return claim.section + " \"" + claim.claim + "\""; }

}  // namespace

std::vector<JudgedClaim> judge_claims(const FindingsOf& findings_of) {
  std::vector<JudgedClaim> all;
  for (const VasiloviciClaim& claim : vasilovici_claims()) {
    JudgedClaim judged{std::string(claim.section), std::string(claim.claim),
                       std::string(to_string(claim.verdict)), ""};
    if (!claim.truth.empty()) {
      const std::vector<Finding>* findings = findings_of(claim.truth);
      if (!findings) continue;
      const Finding* told = telling(*findings, claim.figure);
      if (!told || told->verdict == TruthVerdict::broken) judged.verdict = "overturned";
      if (told) judged.figure = figure_text(*told);
    }
    all.push_back(std::move(judged));
  }
  return all;
}

std::string to_json_lines(const std::vector<JudgedClaim>& claims) {
  std::string text;
  for (const auto& [section, claim, verdict, figure] : claims)
    text += to_text(Json{
                {"section", section}, {"claim", claim}, {"verdict", verdict}, {"figure", figure}}) +
            "\n";
  return text;
}

std::vector<JudgedClaim> read_claims(const std::filesystem::path& file) {
  return read_json_lines(file, [](const JsonReader& json) {
    const auto text = [&](const char* key) { return printable(json.at(key).text()); };
    return JudgedClaim{text("section"), text("claim"), text("verdict"), text("figure")};
  });
}

std::vector<std::string> compare_claims(const std::vector<JudgedClaim>& before,
                                        const std::vector<JudgedClaim>& now) {
  std::vector<std::string> changes;
  for (const JudgedClaim& is : now) {
    const JudgedClaim* was = find(before, is);
    if (!was)
      changes.push_back("claim " + name(is) + " is not in the baseline");
    else if (was->verdict != is.verdict)
      changes.push_back("claim " + name(is) + ": '" + was->verdict + "' -> '" + is.verdict + "'" +
                        (is.figure.empty() ? "" : "; " + is.figure));
  }
  for (const JudgedClaim& was : before)
    if (!find(now, was)) changes.push_back("claim " + name(was) + " is gone");
  return changes;
}

}  // namespace taut
