#pragma once

#include <string>
#include <vector>

#include "experiments/timing/bench.hpp"

namespace taut {

/// A ratio of costs that two sessions measured: a case over the first case of its scene. Ratios,
/// not costs, are what a session claims: a machine's speed differs from hour to hour.
struct TwiceMeasured {
  std::string scene, id;
  Interval a, b;
  bool overlap = false;  ///< of the two 95 % intervals
  /// They are disjoint, and apart by more than the tolerance and by more than either session's
  /// same code strayed from itself.
  bool contradict = false;
};

/// The answer of two sessions to "who is cheapest for this error?" on one scene.
struct TwiceAnswered {
  std::string scene;
  double level = 0;
  std::string a, b;  ///< settings; "": never reached
  /// Another solver, or one session reaches what the other does not.
  bool contradict = false;
};

struct Agreement {
  std::vector<TwiceMeasured> ratios;
  std::vector<TwiceAnswered> answers;

  std::size_t overlapping() const;
  std::size_t contradictions() const;
};

/// Compares what both sessions timed; empty if they have nothing in common.
Agreement agreement(const BenchSession& a, const BenchSession& b, const std::string& metric,
                    double tolerance);

}  // namespace taut
