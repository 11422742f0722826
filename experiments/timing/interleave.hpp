#pragma once

#include <cstddef>
#include <functional>

#include "experiments/system/clock.hpp"

namespace taut {

struct Rounds {
  int count = 1;
  /// A round starts only if it would end by then even at 1.5 times the longest round so far.
  SteadyClock::time_point deadline = SteadyClock::time_point::max();
  /// Called after each round, if set.
  std::function<void(std::size_t done, std::size_t all)> progress;
};

/// In every round calls sample(0), ..., sample(n - 1), between(), sample(n - 1), ..., sample(0) (A
/// B B A), so that a drift in the machine's speed cancels between any two subjects.
void interleave(
    std::size_t subjects, const Rounds&, const std::function<void(std::size_t)>& sample,
    const std::function<void()>& between = [] {});

}  // namespace taut
