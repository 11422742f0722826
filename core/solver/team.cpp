#include "core/solver/team.hpp"

namespace taut {

namespace {

/// About 20 us: longer than a sweep's imbalance, shorter than anyone's patience. Waiting on a futex
/// from the start would cost more than a small sweep.
constexpr int kSpins = 4000;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Returns once `value` differs from `old`.
void wait_for_change(const std::atomic<unsigned>& value, unsigned old) {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (value.load(std::memory_order_acquire) != old) return;
    pause();
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

Team::Team(int threads) {
  for (int member = 1; member < threads; ++member)
    threads_.emplace_back([this, member] { serve(static_cast<std::size_t>(member)); });
}

Team::~Team() {
  stop_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Team::part(std::size_t member) const {
  const std::size_t members = threads_.size() + 1;
  const std::size_t begin = job_.count * member / members,
                    end = job_.count * (member + 1) / members;
  if (begin < end) job_.call(job_.work, begin, end);
}

void Team::dispatch(const Job& job) {
  job_ = job;
  busy_.store(static_cast<unsigned>(threads_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  part(0);
  for (unsigned left = busy_.load(std::memory_order_acquire); left != 0;
       left = busy_.load(std::memory_order_acquire))
    wait_for_change(busy_, left);
}

void Team::serve(std::size_t member) {
  for (unsigned seen = 0;; ++seen) {
    wait_for_change(round_, seen);
    if (stop_) return;
    part(member);
    busy_.fetch_sub(1, std::memory_order_release);
    busy_.notify_one();
  }
}

}  // namespace taut
