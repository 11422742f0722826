#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/timing/statistics.hpp"

// Functions for a table whose rows are scenes and whose columns are the scene and the solvers.
namespace taut::report {

/// The columns: "scene", then the solvers with this unit.
std::vector<Column> columns_of(const std::vector<Column>& solvers, const Unit&, int digits = 2);

/// Whether the cell has a number that is compared with others in its row. Strains of cloth
/// that is not where it should be are not.
bool is_compared(const Cell&);
/// Marks the smallest compared number in the row if the second smallest exceeds it by kTolerance.
/// Numbers below `floor` count as `floor`.
void mark_least(std::vector<Cell>& row, double floor);

/// The rows that the last row combines, and the columns that have values.
struct Common {
  std::vector<std::size_t> rows, columns;
  /// "mean of 3 scenes"; its note names the scenes that are left out.
  Cell label(const Table&, const std::string& what) const;
};
/// The columns with a compared number in some row, and the rows with one in all of these columns.
/// Rows whose numbers are all below `floor` are left out.
Common common_of(const Table&, double floor);

/// Last cell of a column without compared numbers: the words that all its cells share, or "no
/// value".
Cell why_empty(const Table&, std::size_t column);

/// The last row of a table: the label for `what`, then for each column sum(column). With a single
/// common row it is that row's cell, not marked as best; without one it is the reason.
std::vector<Cell> last_row(const Table&, const Common&, const std::string& what,
                           const std::function<Cell(std::size_t column)>& sum);

/// Cell of a case without a value; nullptr stands for a case that was not run.
Cell why_none(const Record*);

/// Geometric mean of independent ratios, whose errors add as squares of logarithms.
Interval geometric_mean(const std::vector<Interval>&);

}  // namespace taut::report
