#include "core/solver/thread_pool.hpp"

#include <chrono>

namespace taut {

namespace {

/// Longer than what a step does between two sweeps. Waiting on a futex from the start would cost
/// more than a small sweep.
constexpr std::chrono::microseconds kSpinTime{100};
constexpr int kPausesPerCheck = 32;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Returns once `value` differs from `old`.
void wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  const auto spin_until = std::chrono::steady_clock::now() + kSpinTime;
  do {
    for (int n = 0; n < kPausesPerCheck; ++n) {
      if (value.load(std::memory_order_acquire) != old) return;
      pause();
    }
  } while (std::chrono::steady_clock::now() < spin_until);
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

ThreadPool::ThreadPool(int threads) : slices_(static_cast<std::size_t>(threads)) {
  for (std::size_t member = 1; member < slices_.size(); ++member)
    threads_.emplace_back([this, member] { serve(member); });
}

ThreadPool::~ThreadPool() {
  stop_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::work_off(std::size_t member) {
  const std::size_t members = slices_.size(), parts = members * kParts;
  for (std::size_t k = 0; k < members; ++k) {
    const std::size_t owner = (member + k) % members;
    std::atomic<std::uint32_t>& taken = slices_[owner].taken;
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

void ThreadPool::dispatch(const Job& job) {
  job_ = job;
  left_.store(static_cast<std::uint32_t>(slices_.size()) * kParts, std::memory_order_relaxed);
  for (Slice& slice : slices_) slice.taken.store(0, std::memory_order_release);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  work_off(0);
  for (std::uint32_t left = left_.load(std::memory_order_acquire); left != 0;
       left = left_.load(std::memory_order_acquire))
    wait_for_change(left_, left);
}

void ThreadPool::serve(std::size_t member) {
  for (std::uint32_t seen = 0;;) {
    wait_for_change(round_, seen);
    if (stop_) return;
    seen = round_.load(std::memory_order_acquire);
    work_off(member);
  }
}

}  // namespace taut
