// Preloaded library that makes the time of day jump back and forth by more than a year, farther at
// every reading.
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <ctime>

namespace {
time_t jump() {
  static std::atomic<int> days{366};
  const int n = days++;
  return (n % 2 == 0 ? n : -n) * time_t{86400};
}
}  // namespace

extern "C" {
int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const long code = syscall(SYS_clock_gettime, clock, now);
  if (clock == CLOCK_REALTIME) now->tv_sec += jump();
  return static_cast<int>(code);
}

time_t time(time_t* at) noexcept {
  timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (at) *at = now.tv_sec;
  return now.tv_sec;
}
}
