#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>

namespace taut {

/// Time [s] of a system clock such as CLOCK_THREAD_CPUTIME_ID or CLOCK_MONOTONIC.
inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using SteadyClock = std::chrono::steady_clock;

inline double seconds_between(SteadyClock::time_point from, SteadyClock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}
inline double seconds_since(SteadyClock::time_point start) {
  return seconds_between(start, SteadyClock::now());
}
inline double seconds_until(SteadyClock::time_point end) { return -seconds_since(end); }

/// Longest time [s] that a user may ask for: 11 days.
inline constexpr double kLongestSeconds = 1e6;

/// The time `seconds` after `start`. At most 10 kLongestSeconds are added, so that no clock
/// overflows.
inline SteadyClock::time_point after(SteadyClock::time_point start, double seconds) {
  const double most = std::clamp(seconds, 0.0, 10 * kLongestSeconds);
  return start +
         std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(most));
}
inline SteadyClock::time_point in_seconds(double seconds) {
  return after(SteadyClock::now(), seconds);
}

}  // namespace taut
