#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace taut {

/// Threads that wait for work and split it evenly. What they compute must not depend on how it is
/// split; then nothing depends on how many there are.
class Team {
 public:
  explicit Team(int threads);  ///< >= 1, the caller included; 1 starts none
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Calls work(begin, end) on parts of [0, count) at the same time; returns when all are done.
  template <class Work>
  void run(std::size_t count, const Work& work) {
    if (threads_.empty() || count < 2) {
      if (count > 0) work(std::size_t{0}, count);
      return;
    }
    dispatch({&work,
              [](const void* w, std::size_t begin, std::size_t end) {
                (*static_cast<const Work*>(w))(begin, end);
              },
              count});
  }

 private:
  struct Job {
    const void* work = nullptr;
    void (*call)(const void*, std::size_t, std::size_t) = nullptr;
    std::size_t count = 0;
  };
  void dispatch(const Job&);
  void part(std::size_t member) const;
  void serve(std::size_t member);

  Job job_;
  std::atomic<unsigned> round_{0};
  std::atomic<unsigned> busy_{0};
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace taut
