#pragma once

#include <ctime>

namespace taut {

/// What a clock of the system shows [s], such as CLOCK_THREAD_CPUTIME_ID or CLOCK_MONOTONIC.
inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace taut
