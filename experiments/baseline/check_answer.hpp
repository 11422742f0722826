#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/baseline.hpp"

namespace taut {

// What of an answer of `taut check` is read back from a results file.

/// How much was compared; people see it in the table of studies.
void add_compared(Answer&, std::size_t cases, std::size_t values);

/// A table of findings, empty: every change with the command that runs its case again.
Table findings_table();
/// `now`: the rows that were compared.
void add_findings(Table&, const std::string& study, const Baseline& now, const Comparison&);

struct Regressions {
  struct Row {
    std::string study, id, change;
    Change::Kind kind = Change::Kind::value_moved;
  };
  std::size_t cases = 0, values = 0;  ///< compared
  std::vector<Row> rows;
};
/// Throws InputError: it is no such answer.
Regressions regressions_in(const Answer&);

}  // namespace taut
