#include "experiments/baseline/check_answer.hpp"

#include "core/model/input_error.hpp"

namespace taut {

namespace {

std::size_t count_in(const Answer& answer, const char* fact) {
  const double number = answer.fact(fact).number();
  if (!(number >= 0 && number < 1e15)) throw InputError("has no number of " + std::string(fact));
  return static_cast<std::size_t>(number);
}

}  // namespace

void add_compared(Answer& answer, std::size_t cases, std::size_t values) {
  answer.add(Column("cases").in_detail(), cases);
  answer.add(Column("values").in_detail(), values);
}

Table findings_table() {
  return {"findings",
          "all that differs",
          {{"study"},
           {"kind"},
           {"case"},
           {"change"},
           Column("command").of_commands(),
           Column("solver").in_detail(),
           Column("scene").in_detail(),
           Column("value").in_detail(),
           Column("before", "", kNumber, 7).in_detail(),
           Column("now", "", kNumber, 7).in_detail()}};
}

void add_findings(Table& table, const std::string& study, const Baseline& now,
                  const Comparison& comparison) {
  for (const Change& finding : comparison.findings) {
    const BaselineRow* row = find_row(now, finding.id);
    const bool number = finding.kind == Change::Kind::value_moved;
    table.rows.push_back({study, to_string(finding.kind),
                          finding.id.empty() ? "solver " + finding.solver : finding.id,
                          finding.text, row ? Cell(reproduce(*row)) : Cell(), finding.solver,
                          finding.scene, finding.value, number ? Cell(finding.before) : Cell(),
                          number ? Cell(finding.now) : Cell()});
  }
}

Regressions regressions_in(const Answer& answer) {
  Regressions found{count_in(answer, "cases"), count_in(answer, "values"), {}};
  const Table& findings = answer.table("findings");
  for (const auto& row : findings.rows)
    found.rows.push_back({findings.at(row, "study").text(), findings.at(row, "case").text(),
                          findings.at(row, "change").text(),
                          change_kind(findings.at(row, "kind").text())});
  return found;
}

}  // namespace taut
