// Preloaded, it makes the time of day jump to and fro by a year at every look.
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <ctime>

namespace {
time_t jump() {
  static std::atomic<int> looks{0};
  constexpr time_t kYear = 31'536'000;
  return looks++ % 2 == 0 ? kYear : -kYear;
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
