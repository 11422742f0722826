#include "core/solver/thread_pool.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace taut {

namespace {

/// Spin for this long before waiting on the futex: longer than the work between two steps, since a
/// futex wait costs more than a small sweep.
constexpr std::chrono::microseconds kSpinTime{100};
constexpr int kPausesPerCheck = 32;
/// Pauses of a waiting thread before it yields, 20 to 70 us: longer than a stage of a part, so the
/// thread that it waits for is not on a core.
constexpr int kMostPauses = 1000;
/// Pauses before a thread works on parts of others, 40 to 140 us of all stages together: more than
/// a thread waits for one that is on a core. Data that move to another core have to move back.
constexpr int kPausesBeforeHelping = 2000;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Waiting for another thread: each call pauses, or yields after kMostPauses calls.
class Wait {
 public:
  void operator()() { ++pauses_ < kMostPauses ? pause() : std::this_thread::yield(); }

 private:
  int pauses_ = 0;
};

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

ThreadPool::ThreadPool(int threads) : parts_(static_cast<std::size_t>(threads) * kParts) {
  try {
    for (int member = 1; member < threads; ++member)
      threads_.emplace_back([this, member] { serve(static_cast<std::size_t>(member)); });
  } catch (...) {  // no memory for another stack, or too many threads
    stop();
    throw;
  }
}

ThreadPool::~ThreadPool() { stop(); }

void ThreadPool::stop() {
  stop_ = true;
  ++round_;
  round_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

/// Returns once the part has done `stages` stages. Meanwhile does the work that no thread is doing,
/// also of neighbouring parts.
void ThreadPool::advance(Member& me, std::size_t part, std::uint32_t stages) {
  Part& p = parts_[part];
  Wait wait;
  for (;;) {
    std::uint32_t next = p.done.load(std::memory_order_acquire);
    if (next >= stages) return;
    const bool alone = gate_.load(std::memory_order_relaxed) == 1;
    if (!me.owns(part) && me.patience > 0 && !alone) {
      --me.patience;
      pause();
      continue;
    }
    if (p.begun.load(std::memory_order_relaxed) != next) {
      wait();
      continue;
    }
    if (part > 0 && next > 0 && stages_[next - 1].reaches_next_part) advance(me, part - 1, next);
    if (part + 1 < part_count_ && stages_[next].reaches_next_part) advance(me, part + 1, next);
    if (!p.begun.compare_exchange_strong(next, next + 1, std::memory_order_relaxed)) continue;
    if (next + 1 < stages_.size()) __builtin_prefetch(&stages_[next + 1]);
    try {
      if (!failed_.load(std::memory_order_relaxed))
        stages_[next](begin_of(part), begin_of(part + 1));
    } catch (...) {
      if (!failed_.exchange(true, std::memory_order_relaxed)) failure_ = std::current_exception();
    }
    p.done.store(next + 1, std::memory_order_release);
  }
}

void ThreadPool::work_off(std::size_t member) {
  Member me{part_count_ * member / threads(), part_count_ * (member + 1) / threads(),
            kPausesBeforeHelping};
  const auto count = static_cast<std::uint32_t>(stages_.size());
  for (std::uint32_t stage = 1; stage <= count; ++stage) {
    // Skip stages that no other part waits for, so that all of them run while a part is in the
    // cache.
    if (stage < count && !stages_[stage - 1].reaches_next_part && !stages_[stage].reaches_next_part)
      continue;
    for (std::size_t k = 0; k < me.end - me.begin; ++k)  // both ends first: others wait for them
      advance(me, k % 2 == 0 ? me.begin + k / 2 : me.end - 1 - k / 2, stage);
  }
  for (std::size_t part = 0; part < part_count_; ++part)  // parts whose thread is late
    advance(me, part, count);
}

void ThreadPool::dispatch() {
  const bool pairs = std::ranges::any_of(stages_, &Stage::reaches_next_part);
  blocks_per_unit_ = pairs ? 2 : 1;
  part_count_ = std::min(units(), parts_.size());
  for (Part& part : parts_) {
    part.done.store(0, std::memory_order_relaxed);
    part.begun.store(0, std::memory_order_relaxed);
  }
  gate_.fetch_or(1, std::memory_order_release);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  work_off(0);
  gate_.fetch_and(~1U, std::memory_order_relaxed);
  for (Wait wait; gate_.load(std::memory_order_acquire) != 0;) wait();
  stages_.clear();
  if (failed_.exchange(false, std::memory_order_relaxed))
    std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::serve(std::size_t member) {
  for (std::uint32_t seen = 0;;) {
    wait_for_change(round_, seen);
    if (stop_) return;
    seen = round_.load(std::memory_order_acquire);
    if ((gate_.fetch_add(2, std::memory_order_acquire) & 1) != 0) work_off(member);
    gate_.fetch_sub(2, std::memory_order_release);
  }
}

}  // namespace taut
