#pragma once

#include <string>
#include <vector>

#include "experiments/baseline/baseline.hpp"

namespace taut {

/// How one value moved on one scene, over all its cases.
struct MovedValue {
  std::string scene, value;
  std::size_t cases = 0;
  std::size_t less = 0, more = 0;   ///< of these: now below, above what it was
  const Change* largest = nullptr;  ///< relative change; into the comparison

  /// (now - before) / |before| of the largest; infinite where there was 0 or no number, and
  /// for a status.
  double relative() const;
};

/// Statuses that changed and values that moved, by scene and value; the largest change first.
std::vector<MovedValue> roll_up(const Comparison&);

/// "+12 % (0.01 -> 0.0112 m)", from the case with the largest change.
std::string text(const MovedValue&, std::string_view unit);

}  // namespace taut
