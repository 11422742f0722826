#pragma once

#include <vector>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// What a second thread is worth, and what a second core is worth where none has to wait for the
/// other: the one cannot exceed the other by more than noise. Wall time throughout.
class TwoCores {
 public:
  /// Both cores were free where unrelated sheets are as fast as so many single threads.
  static constexpr double kFree = 1.9;

  /// A round: the same work by one thread and by two, then by one thread again and twice by two
  /// solvers that know nothing of each other [s, or any other unit of time]. No time is in both
  /// ratios, or a slow single thread would be called free cores and flatter what it counts for.
  void add(double one, double two, double one_again, double unrelated) {
    threads_.push_back(one / two);
    unrelated_.push_back(2 * one_again / unrelated);
    share_.push_back(unrelated / 2 / two);
    if (unrelated_.back() >= kFree) threads_while_free_.push_back(threads_.back());
  }

  /// Speed of two threads on one sheet, in single threads, one of each round.
  const std::vector<double>& thread_samples() const { return threads_; }
  const std::vector<double>& unrelated_samples() const { return unrelated_; }
  Interval threads() const { return bootstrap_median(threads_); }
  /// Of two sheets at the same time, a thread and no word between them.
  Interval unrelated() const { return bootstrap_median(unrelated_); }
  Interval share() const { return bootstrap_median(share_); }  ///< threads over unrelated, by round
  /// threads() of those rounds in which both cores were free.
  Interval threads_while_free() const { return bootstrap_median(threads_while_free_); }
  std::size_t rounds() const { return threads_.size(); }
  std::size_t free_rounds() const { return threads_while_free_.size(); }

 private:
  std::vector<double> threads_, unrelated_, share_, threads_while_free_;
};

}  // namespace taut
