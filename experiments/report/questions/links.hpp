#pragma once

#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

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

}  // namespace taut::report
