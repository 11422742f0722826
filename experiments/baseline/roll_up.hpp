#pragma once

#include <string>
#include <vector>

#include "experiments/baseline/baseline.hpp"

namespace taut {

/// How one value moved on one scene, over all its cases.
struct MovedValue {
  std::string scene, value;
  std::size_t cases = 0;
  const Change* worst = nullptr;  ///< the largest relative change; into the comparison

  /// (now - before) / |before| of the worst; infinite where there was 0 or no number.
  double relative() const;
};

/// Moved values by scene and value, the worst first.
std::vector<MovedValue> roll_up(const Comparison&);

/// "+12 % (0.01 -> 0.0112 m)", from the worst case.
std::string text(const MovedValue&, std::string_view unit);

}  // namespace taut
