#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/timing/statistics.hpp"

// Of a table whose rows are scenes and whose columns are solvers, the first the scene.
namespace taut::report {

/// Its columns: "scene", then the solvers with this unit.
std::vector<Column> columns_of(const std::vector<Column>& solvers, const Unit&, int digits = 2);

/// Whether the cell has a number that is compared with others of its row; cloth that hardly moves
/// has none.
bool is_compared(const Cell&);
/// Marks the least compared number of the row if the second exceeds it by kTolerance; numbers below
/// `floor` count as it.
void mark_least(std::vector<Cell>& row, double floor);

/// Scenes whose values make up the last row, and who has values at all.
struct Common {
  std::vector<std::size_t> rows, columns;
  /// "mean of 3 scenes", with the others and why in its note.
  Cell label(const Table&, const std::string& what) const;
};
/// The columns that have a compared number somewhere, and the rows that have one in each of these;
/// without rows whose numbers are all below `floor`.
Common common_of(const Table&, double floor);

/// The last cell of a column without a compared number: what all its rows say, else "no value".
Cell why_empty(const Table&, std::size_t column);

/// The last row of a table: the label of `what`, then of each column what `sum` makes of the common
/// rows; of a single one its cell, not marked, and of none the reason.
std::vector<Cell> last_row(const Table&, const Common&, const std::string& what,
                           const std::function<Cell(std::size_t column)>& sum);

/// The cell of a case without a value; nullptr: the case was not run.
Cell why_none(const Record*);

/// Geometric mean of independent ratios: their errors add as squares of logarithms.
Interval geometric_mean(const std::vector<Interval>&);

}  // namespace taut::report
