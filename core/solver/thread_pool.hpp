#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <thread>
#include <type_traits>
#include <vector>

namespace taut {

/// Threads that wait for work and divide it. Results must not depend on how the work is split; then
/// they do not depend on the number of threads.
///
/// Each thread has its own slice, the same every time, so that its data stay in its cache. Where it
/// would have to wait for others, it does what they have left undone. The caller never waits for a
/// thread that has not started: on a busy machine it does all the work itself.
class ThreadPool {
 public:
  /// threads >= 1, the caller included; 1 starts none. Throws std::system_error if not all start.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t threads() const { return threads_.size() + 1; }  ///< the caller included

  /// Fewest particles for which threads share a pass: a smaller pass ends before another thread
  /// could join. A second thread began to pay at about this size (64 x 64 no, 96 x 96 yes; not
  /// measured again).
  static constexpr std::size_t kWorthSharing = 8192;

  /// Calls work(begin, end) on parts of [0, count) at the same time, or once on all of it if not
  /// `shared`. Returns when all are done. Here and below, the caller gets an exception of `work`
  /// when it waits for the work; parts that had not begun by then are skipped.
  template <class Work>
  void run(std::size_t count, const Work& work, bool shared = true) {
    finish();
    if (threads_.empty() || count < 2 || !shared) {
      if (count > 0) work(std::size_t{0}, count);
      return;
    }
    queue(count, [&work](std::size_t begin, std::size_t end) { work(begin, end); });
    finish();
  }

  /// Calls work(n, begin, end) once for each of `parts` parts of [0, count), for results that must
  /// be kept apart. One part is the caller's.
  template <class Work>
  void run_parts(std::size_t parts, std::size_t count, const Work& work) {
    run(parts, [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n)
        work(n, count * n / parts, count * (n + 1) / parts);
    });
  }

  /// Queues a stage of work on independent blocks of particles: calls work(begin, end) on parts of
  /// [0, blocks), after the stages queued before it have been done on them. With one thread or if
  /// not `shared` this happens at once, otherwise not before finish(). `work` is copied.
  template <class Work>
  void queue(std::size_t blocks, const Work& work, bool shared = true) {
    if (threads_.empty() || !shared) {
      work(std::size_t{0}, blocks);
      return;
    }
    add_stage(blocks, false, work);
  }

  /// Queues two stages, the even blocks and then the odd ones: calls work(block), which may also
  /// work on the block after it.
  template <class Work>
  void queue_pairs(std::size_t blocks, const Work& work, bool shared = true) {
    const auto stage = [&](std::size_t parity) {
      return [work, parity](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin + (begin + parity) % 2; block < end; block += 2) work(block);
      };
    };
    if (threads_.empty() || !shared) {
      stage(0)(0, blocks);
      stage(1)(0, blocks);
      return;
    }
    if (stages_.size() + 2 > kMostStages) finish();  // both in one dispatch: see blocks_per_unit_
    add_stage(blocks, false, stage(0));
    add_stage(blocks, true, stage(1));
  }

  /// Returns when all queued work is done.
  void finish() {
    if (!stages_.empty()) dispatch();
  }

 private:
  class Stage {
   public:
    template <class Work>
    Stage(bool reaches, const Work& work)
        : reaches_next_part(reaches),
          call_([](const std::byte* w, std::size_t begin, std::size_t end) {
            (*std::launder(reinterpret_cast<const Work*>(w)))(begin, end);
          }) {
      static_assert(sizeof(Work) <= sizeof work_ && std::is_trivially_copyable_v<Work>);
      new (work_) Work(work);
    }
    void operator()(std::size_t begin, std::size_t end) const { call_(work_, begin, end); }

    bool reaches_next_part;  ///< also works on the first block of the next part

   private:
    void (*call_)(const std::byte*, std::size_t, std::size_t);
    alignas(16) std::byte work_[368];  // fits contact with a moving box in double
  };
  /// Progress of a part, as numbers of stages. Only a thread that may take on the part reads
  /// `begun`, so `begun` stays in that core's cache.
  struct Part {
    alignas(64) std::atomic<std::uint32_t> done{0};
    alignas(64) std::atomic<std::uint32_t> begun{0};
  };

  /// Most parts in a thread's slice. Each costs 0.2 us a stage; with one part, a thread would
  /// always wait for its neighbour.
  static constexpr std::size_t kParts = 4;
  static constexpr std::size_t kMostStages = 128;  ///< also limits the depth of advance()

  /// A thread at work: its own parts, and how long it waits before it takes on parts of others.
  struct Member {
    std::size_t begin, end;
    int patience;  ///< number of pauses
    bool owns(std::size_t part) const { return begin <= part && part < end; }
  };

  template <class Work>
  void add_stage(std::size_t blocks, bool reaches_next_part, const Work& work) {
    if (blocks != count_ || stages_.size() == kMostStages) finish();
    count_ = blocks;
    stages_.emplace_back(reaches_next_part, work);
  }
  void stop();
  std::size_t begin_of(std::size_t part) const {
    return std::min(count_, units() * part / part_count_ * blocks_per_unit_);
  }
  std::size_t units() const { return (count_ + blocks_per_unit_ - 1) / blocks_per_unit_; }
  void dispatch();
  void serve(std::size_t member);
  void work_off(std::size_t member);
  void advance(Member&, std::size_t part, std::uint32_t stages);

  std::vector<Stage> stages_;
  std::size_t count_ = 0;  ///< number of blocks of each stage
  /// Parts consist of whole units. A unit is two blocks if there are pairs, so that each part
  /// begins with an even block.
  std::size_t blocks_per_unit_ = 1;
  std::vector<Part> parts_;  ///< room for the parts of all threads
  std::size_t part_count_ = 0;
  std::atomic<std::uint32_t> round_{0};  ///< number of dispatches
  /// 1 if there is work, plus twice the number of threads, besides the caller, that see it.
  alignas(64) std::atomic<std::uint32_t> gate_{0};
  std::atomic<bool> failed_{false};  ///< work has thrown
  std::exception_ptr failure_;       ///< the first exception
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace taut
