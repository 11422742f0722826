#pragma once

#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

/// The arithmetic in which a solver computes its links.
struct Arithmetic {
  std::string precision = "double";  ///< "float", "double"
  /// "avx2", "scalar", "vectors" of unknown kind; "": no vector instructions.
  std::string instructions = {};
  int lanes = 0;  ///< numbers per instruction; 0: unknown or no vectors

  std::string brief() const;    ///< "float × 8", "double"
  std::string text() const;     ///< "float × 8 (avx2)", "float, scalar"
  std::string meaning() const;  ///< "single precision, 8 numbers in one instruction"
};
/// `vectors` is what simd=auto chooses, such as "avx2"; "": unknown.
Arithmetic arithmetic_of(const Record&, const std::string& vectors);
/// "coloured", "mesh order", Bullet's "reordered"; "": its links have no order.
std::string link_order(const Record&);
/// Link order of each solver in any of these scenes: "Jakobsen coloured, Bullet reordered".
std::string link_orders(const std::vector<SceneBench>&);

}  // namespace taut::report
