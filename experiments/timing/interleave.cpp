#include "experiments/timing/interleave.hpp"

#include <algorithm>

namespace taut {

void interleave(std::size_t subjects, const Rounds& rounds,
                const std::function<void(std::size_t)>& sample,
                const std::function<void()>& between) {
  SteadyClock::duration longest{};
  for (int round = 0; round < rounds.count; ++round) {
    const SteadyClock::time_point start = SteadyClock::now();
    if (rounds.deadline - start < longest + longest / 2) return;
    for (std::size_t i = 0; i < subjects; ++i) sample(i);
    between();
    for (std::size_t i = subjects; i-- > 0;) sample(i);
    if (rounds.progress)
      rounds.progress(static_cast<std::size_t>(round) + 1, static_cast<std::size_t>(rounds.count));
    longest = std::max(longest, SteadyClock::now() - start);
  }
}

}  // namespace taut
