#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace taut {

/// Threads that wait for work and divide it. What they compute must not depend on how it is split;
/// then nothing depends on how many there are.
///
/// Each has a slice of its own, the same one every time, so that its data stay in its cache, and
/// helps the others when that is done. Whoever has not come yet is not waited for: on a busy
/// machine the caller does the work alone.
class ThreadPool {
 public:
  explicit ThreadPool(int threads);  ///< >= 1, the caller included; 1 starts none
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t threads() const { return threads_.size() + 1; }  ///< the caller included

  /// A pass over fewer particles is done before another thread has come: with 64 x 64, two threads
  /// are slower than one, with 96 x 96 they are faster (results/benchmarks/threads.md).
  static constexpr std::size_t kWorthSharing = 8192;

  /// Calls work(begin, end) on parts of [0, count) at the same time, unless not `shared`; returns
  /// when all are done.
  template <class Work>
  void run(std::size_t count, const Work& work, bool shared = true) {
    if (threads_.empty() || count < 2 || !shared) {
      if (count > 0) work(std::size_t{0}, count);
      return;
    }
    dispatch({&work,
              [](const void* w, std::size_t begin, std::size_t end) {
                (*static_cast<const Work*>(w))(begin, end);
              },
              count});
  }

  /// Calls work(n, begin, end) for the n-th of so many parts of [0, count), each once: for what has
  /// to be kept apart. One part is the caller's.
  template <class Work>
  void run_parts(std::size_t parts, std::size_t count, const Work& work) {
    run(parts, [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n)
        work(n, count * n / parts, count * (n + 1) / parts);
    });
  }

 private:
  struct Job {
    const void* work = nullptr;
    void (*call)(const void*, std::size_t, std::size_t) = nullptr;
    std::size_t count = 0;
  };
  static constexpr std::uint32_t kParts = 4;  ///< of a slice
  /// How many of its parts are taken; all, between two rounds.
  struct alignas(64) Slice {
    std::atomic<std::uint32_t> taken{kParts};
  };
  void dispatch(const Job&);
  void work_off(std::size_t member);
  void serve(std::size_t member);

  Job job_;
  std::vector<Slice> slices_;
  std::atomic<std::uint32_t> round_{0};
  std::atomic<std::uint32_t> left_{0};  ///< parts of this round that are not done
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace taut
