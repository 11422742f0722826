#pragma once

#include "experiments/answer/answer.hpp"
#include "experiments/report/answer/case_list.hpp"
#include "experiments/report/answer/compared_solvers.hpp"

namespace taut::report {

/// The value of kErrorMetric whose price the page says.
inline constexpr double kPricedError = 0.01;

/// What a run says of its solvers: a table for each question, whose columns are the scene and every
/// solver of the run and whose rows are scenes; the last row is all scenes that have a value of
/// every solver that has one anywhere. A cell is a value or why there is none: "not run", "cannot:
/// friction", "exploded". Its note is the setting where that is not the same for all. The best of a
/// row is marked only of costs, of what was had at one cost, and of failures: by more than
/// kTolerance and, of costs, beyond what identical code differed by (judge()).
Answer answer_of(const ReportInput&, const ComparedSolvers&, CaseList&);

/// The questions of costs; none without a bench.
void add_costs(Answer&, const ReportInput&, const std::vector<Column>& solvers, CaseList&);

inline constexpr const char* kWithoutExtras =
    "without accelerators that another solver of the scene lacks";
/// Without the cases that use a parameter which another solver of the scene lacks.
SceneBench with_shared_parameters(SceneBench);
/// "4 × 2, coloured": of cases of one scene those parameters that take several values, without the
/// one that is said beside it.
std::string setting_text(const SceneBench&, std::size_t at, std::string_view beside = "");

/// If the settings of a solver that reach the error do not count: a cell of these words, with the
/// state and the reason, such as "hardly moves: 5 % of the way".
std::optional<Cell> only_uncounted(const std::vector<Candidate>&, const std::string& solver,
                                   double error, const std::string& words);

/// Whether a cheaper setting of the same solver may reach what case `at` reaches: none was tried,
/// and it does more than one sweep in one substep, than which nothing is cheaper. Its cost is then
/// an upper bound.
bool is_upper_bound(const SceneBench&, const std::vector<Candidate>&, std::size_t at);
/// "; at most: its cheapest setting tried": behind the setting of an upper bound.
inline constexpr const char* kUpperBound = "; at most: its cheapest setting tried";

/// In what a solver computes its links.
struct Arithmetic {
  std::string precision = "double";  ///< "float", "double"
  std::string instructions = {};     ///< "avx2", "scalar", "vectors" of an unknown kind; "": plain
  int lanes = 0;                     ///< numbers in one instruction; 0: of no known vectors

  std::string brief() const;    ///< "float × 8", "double"
  std::string text() const;     ///< "float × 8 (avx2)", "float, scalar"
  std::string meaning() const;  ///< "single precision, 8 numbers in one instruction"
};
/// `vectors`: what simd=auto is, "avx2"; "": not known.
Arithmetic arithmetic_of(const Record&, const std::string& vectors);
/// "coloured", "mesh order", Bullet's "reordered"; "": its links have no order.
std::string link_order(const Record&);
/// "Jakobsen coloured, Bullet reordered": of each solver in any of these scenes.
std::string link_orders(const std::vector<SceneBench>&);

/// Geometric mean of independent ratios: their errors add as squares of logarithms.
Interval geometric_mean(const std::vector<Interval>&);

// Of a table whose first column is the scene.

/// Its columns: "scene", then the solvers with this unit.
std::vector<Column> columns_of(const std::vector<Column>& solvers, const Unit&, int digits = 2);

/// A number that is compared with others of its row: none of cloth that hardly moves.
bool is_compared(const Cell&);
/// Marks the least number compared of the row if the second is more by kTolerance; numbers below
/// `nothing` count as that.
void mark_least(std::vector<Cell>& row, double nothing);

/// Scenes whose values make up the last row, and who has values at all.
struct Common {
  std::vector<std::size_t> rows, columns;
  /// "mean of 3 scenes", with the others and why in its note.
  Cell label(const Table&, const std::string& what) const;
};
/// Rows that have a number that is compared in every column that has one somewhere; rows with all
/// numbers below `nothing` are none.
Common common_of(const Table&, double nothing);

/// What a column without a number that is compared says: the same in all rows, else "no value".
Cell why_empty(const Table&, std::size_t column);
/// Of a column with values, but none on a scene that all others have.
Cell no_common_scene();

}  // namespace taut::report
