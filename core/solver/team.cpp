#include "core/solver/team.hpp"

#include <chrono>

namespace taut {

namespace {

/// Longer than what a step does between two sweeps, shorter than anyone's patience. Waiting on a
/// futex from the start would cost more than a small sweep.
constexpr std::chrono::microseconds kPatience{100};
constexpr int kPausesPerGlance = 32;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Returns once `value` differs from `old`.
void wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  const auto patient_until = std::chrono::steady_clock::now() + kPatience;
  do {
    for (int n = 0; n < kPausesPerGlance; ++n) {
      if (value.load(std::memory_order_acquire) != old) return;
      pause();
    }
  } while (std::chrono::steady_clock::now() < patient_until);
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

Team::Team(int threads) : shares_(static_cast<std::size_t>(threads)) {
  for (std::size_t member = 1; member < shares_.size(); ++member)
    threads_.emplace_back([this, member] { serve(member); });
}

Team::~Team() {
  stop_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Team::work_off(std::size_t member) {
  const std::size_t members = shares_.size(), parts = members * kParts;
  for (std::size_t k = 0; k < members; ++k) {
    const std::size_t owner = (member + k) % members;
    std::atomic<std::uint32_t>& taken = shares_[owner].taken;
    for (std::uint32_t n = taken.load(std::memory_order_acquire); n < kParts;) {
      if (!taken.compare_exchange_weak(n, n + 1, std::memory_order_acquire)) continue;
      const std::size_t part = owner * kParts + n;  // of this round, which ends with its last part
      const std::size_t begin = job_.count * part / parts, end = job_.count * (part + 1) / parts;
      if (begin < end) job_.call(job_.work, begin, end);
      if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) left_.notify_one();
      n = taken.load(std::memory_order_acquire);
    }
  }
}

void Team::dispatch(const Job& job) {
  job_ = job;
  left_.store(static_cast<std::uint32_t>(shares_.size()) * kParts, std::memory_order_relaxed);
  for (Share& share : shares_) share.taken.store(0, std::memory_order_release);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  work_off(0);
  for (std::uint32_t left = left_.load(std::memory_order_acquire); left != 0;
       left = left_.load(std::memory_order_acquire))
    wait_for_change(left_, left);
}

void Team::serve(std::size_t member) {
  for (std::uint32_t seen = 0;;) {
    wait_for_change(round_, seen);
    if (stop_) return;
    seen = round_.load(std::memory_order_acquire);
    work_off(member);
  }
}

}  // namespace taut
