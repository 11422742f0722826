#pragma once

#include "core/model/scene.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

/// What a second thread is worth, and what a second core is worth where none has to wait for the
/// other: the one cannot exceed the other by more than noise. Wall time throughout.
struct TwoCores {
  Interval threads;    ///< speed of two threads on one sheet, in single threads
  Interval unrelated;  ///< of two sheets at the same time, a thread and no word between them
  Interval share;      ///< threads over unrelated, round by round
  /// threads in those rounds in which the unrelated sheets reached kFree: both cores were free.
  Interval threads_while_free;
  double free = 0;  ///< share of such rounds
  static constexpr double kFree = 1.9;
};

/// Interleaved: each round times one thread, two threads, one thread again and two unrelated
/// sheets, `seconds` each. The first single thread is what the threads are compared with and the
/// second one what the unrelated sheets are: no slow sample is in both ratios.
TwoCores bench_two_cores(const Scene&, int rounds, double seconds);

}  // namespace taut
