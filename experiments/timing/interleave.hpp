#pragma once

#include <cstddef>
#include <functional>

#include "experiments/system/clock.hpp"

namespace taut {

struct Rounds {
  int count = 1;
  /// No round begins that would not end by then, if it takes as long as the longest before.
  SteadyClock::time_point deadline = SteadyClock::time_point::max();
  std::function<void(std::size_t done, std::size_t all)> progress;  ///< after each; none: silent
};

/// Calls sample(0), ..., sample(n - 1), between(), sample(n - 1), ..., sample(0) in every round
/// (A B B A): a drift of the machine's speed cancels between any two subjects.
void interleave(
    std::size_t subjects, const Rounds&, const std::function<void(std::size_t)>& sample,
    const std::function<void()>& between = [] {});

}  // namespace taut
