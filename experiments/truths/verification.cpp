#include "experiments/truths/verification.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiments/answer/number.hpp"

namespace taut {

namespace {

std::string value(double v) {
  return number_text(v, std::abs(v) > 0.01 && std::abs(v) < 1e4 ? 7 : 3);
}

/// A finding as text: its number, and the expected one.
std::string text_of(const Finding& f) {
  if (f.verdict == TruthVerdict::not_applicable) return f.subject + ": " + f.why;
  std::string text = f.subject + ": " + f.quantity + " " + value(f.measured);
  if (f.uncertainty > 0) text += " +- " + value(f.uncertainty);
  if (f.unit != "1") text += " " + f.unit;
  if (f.expected == 0)
    text += " (at most " + value(f.tolerance) + ")";
  else
    text += " (" + value(f.expected) + " +- " + value(f.tolerance) + ")";
  return f.why.empty() ? text : text + ": " + f.why;
}

/// Sort key of a finding by which the worst comes last.
std::pair<TruthVerdict, double> badness(const Finding& f) {
  const double share = share_of_tolerance(f);
  return {f.verdict, std::isnan(share) ? 1e300 : share};
}

/// Table with a row for each truth, which shows the number that is worst or nearest to its
/// tolerance.
Table truths_table(const std::vector<CheckedTruth>& truths) {
  Table table{"truths",
              "",
              {{"verdict"},
               {"place"},
               {"name", "truth"},
               {"numbers"},
               {"nearest", "nearest to its tolerance"},
               Column("section").in_detail(),
               Column("section_title").in_detail(),
               Column("statement").in_detail(),
               Column("source").in_detail(),
               Column("seconds", "time", kTime).in_detail()}};
  for (const CheckedTruth& truth : truths) {
    const auto worst = std::ranges::max_element(truth.findings, {}, badness);
    const bool any = worst != truth.findings.end();
    table.rows.push_back({cell_of(any ? worst->verdict : TruthVerdict::not_applicable), truth.place,
                          truth.name, truth.findings.size(), any ? text_of(*worst) : "",
                          truth.section, truth.section_title, truth.statement, truth.source,
                          truth.seconds});
  }
  return table;
}

CheckedTruth truth_in(const Table& table, const std::vector<Cell>& row) {
  CheckedTruth truth;
  truth.name = table.at(row, "name").text();
  truth.place = table.at(row, "place").text();
  truth.section = static_cast<int>(table.at(row, "section").number());
  truth.section_title = table.at(row, "section_title").text();
  truth.statement = table.at(row, "statement").text();
  truth.source = table.at(row, "source").text();
  truth.seconds = table.at(row, "seconds").number();
  return truth;
}

Table findings_table(const std::vector<CheckedTruth>& truths) {
  Table table{"findings",
              "every number",
              {{"verdict"},
               {"truth"},
               {"subject"},
               {"quantity"},
               {"unit"},
               {"measured", "", kNumber, 7},
               {"expected", "", kNumber, 7},
               {"tolerance"},
               {"uncertainty"},
               {"why"}}};
  for (const CheckedTruth& truth : truths)
    for (const Finding& f : truth.findings)
      table.rows.push_back({cell_of(f.verdict), truth.name, f.subject, f.quantity, f.unit,
                            f.measured, f.expected, f.tolerance, f.uncertainty, f.why});
  table.detail = true;
  return table;
}

Finding finding_in(const Table& table, const std::vector<Cell>& row) {
  Finding f;
  f.verdict = verdict_of(table.at(row, "verdict").text());
  f.subject = table.at(row, "subject").text();
  f.quantity = table.at(row, "quantity").text();
  f.unit = table.at(row, "unit").text();
  f.measured = table.at(row, "measured").number();
  f.expected = table.at(row, "expected").number();
  f.tolerance = table.at(row, "tolerance").number();
  f.uncertainty = table.at(row, "uncertainty").number();
  f.why = table.at(row, "why").text();
  return f;
}

Table assertions_table(const std::vector<JudgedAssertion>& assertions) {
  Table table{"assertions",
              "what publications assert",
              {{"source"}, {"section"}, {"verdict"}, {"assertion"}, {"figure"}}};
  for (const auto& [source, section, assertion, verdict, figure] : assertions)
    table.rows.push_back({source, section, cell_of(verdict), assertion, figure});
  return table;
}

JudgedAssertion assertion_in(const Table& table, const std::vector<Cell>& row) {
  return {table.at(row, "source").text(), table.at(row, "section").text(),
          table.at(row, "assertion").text(), assertion_verdict_of(table.at(row, "verdict").text()),
          table.at(row, "figure").text()};
}

/// Table of the broken numbers, shown last, where they are read.
Table broken_table(const std::vector<CheckedTruth>& truths) {
  Table table{"broken", "broken", {{"truth"}, {"number"}}};
  for (const CheckedTruth& truth : truths)
    for (const Finding& f : truth.findings)
      if (f.verdict == TruthVerdict::broken) table.rows.push_back({truth.name, text_of(f)});
  return table;
}

}  // namespace

CheckedTruth::CheckedTruth(const TruthEntry& truth, std::vector<Finding> found, double used)
    : name(truth.name),
      place(place_of(truth)),
      section_title(taut::section_title(truth.section)),
      statement(truth.statement),
      source(truth.source),
      section(truth.section),
      seconds(used),
      findings(std::move(found)) {}

VerdictCounts verdicts_of(const std::vector<CheckedTruth>& truths) {
  VerdictCounts counts{.truths = truths.size()};
  for (const CheckedTruth& truth : truths) {
    bool broken = false;
    for (const Finding& f : truth.findings) {
      ++counts.of[static_cast<std::size_t>(f.verdict)];
      ++counts.findings;
      broken = broken || f.verdict == TruthVerdict::broken;
    }
    counts.broken_truths += broken;
  }
  return counts;
}

std::string VerdictCounts::text() const {
  std::string all = std::to_string(truths) + " truths, " + std::to_string(findings) +
                    " numbers: " + std::to_string(of[0]) + " passed, " + std::to_string(of[1]) +
                    " deviate as explained, " + std::to_string(of[2]) + " not applicable, " +
                    std::to_string(of[3]) + " broken";
  if (broken_truths > 0) all += " in " + std::to_string(broken_truths) + " truths";
  return all;
}

std::string place_of(const TruthEntry& truth) {
  return std::to_string(truth.section) + "." + std::to_string(truth.row);
}

double share_of_tolerance(const Finding& f) {
  const double off = std::abs(f.measured - f.expected);
  return f.tolerance > 0 ? off / f.tolerance : off;
}

Answer answer_of(const Verification& found, bool assertions_first) {
  Answer answer{"verify"};
  answer.add(truths_table(found.truths));
  answer.add(findings_table(found.truths));
  answer.add(assertions_table(found.assertions));
  answer.add(broken_table(found.truths));
  answer.tables[assertions_first ? 0 : 2].detail = true;
  return answer;
}

Verification verification_in(const Answer& answer) {
  Verification found;
  const Table& truths = answer.table("truths");
  for (const auto& row : truths.rows) found.truths.push_back(truth_in(truths, row));
  const Table& findings = answer.table("findings");
  for (const auto& row : findings.rows) {
    const std::string name = findings.at(row, "truth").text();
    const auto of = std::ranges::find(found.truths, name, &CheckedTruth::name);
    if (of != found.truths.end()) of->findings.push_back(finding_in(findings, row));
  }
  const Table& assertions = answer.table("assertions");
  for (const auto& row : assertions.rows) found.assertions.push_back(assertion_in(assertions, row));
  return found;
}

}  // namespace taut
