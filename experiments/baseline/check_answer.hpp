#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/baseline.hpp"

namespace taut {

// The parts of an answer of `taut check` that are read back from a results file.

/// Adds the numbers of compared cases and values. People see them in the table of studies.
void add_compared(Answer&, std::size_t cases, std::size_t values);

/// An empty table of findings: every change with the command that runs its case again.
Table findings_table();
/// Adds findings. `now` holds the rows that were compared.
void add_findings(Table&, const std::string& study, const Baseline& now, const Comparison&);

struct Regressions {
  struct Row {
    std::string study, id, change;
    Change::Kind kind = Change::Kind::value_moved;
  };
  std::size_t cases = 0, values = 0;  ///< compared
  std::vector<Row> rows;
};
/// Throws InputError if it is not an answer of `taut check`.
Regressions regressions_in(const Answer&);

}  // namespace taut
