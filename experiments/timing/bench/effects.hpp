#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// What a step of one scene costs, with everything in it and with its links alone.
struct EffectRow {
  std::string scene, effects;  ///< "flag", "wind"; empty: links and pins alone
  std::size_t vertices = 0;
  double dt = 0;        ///< s
  std::string refused;  ///< why it was not timed; empty: it was
  /// Nanoseconds a vertex and step, two of each round: all effects; without wind, colliders and
  /// self-collision, from the same states.
  std::vector<double> whole, links_alone;
  std::vector<double> copies;  ///< likewise: all copies of it on two threads, one step of each
  /// Likewise: with its colliders so far away that nothing touches them. Empty: it has none.
  std::vector<double> touching_nothing;

  Interval cost() const { return bootstrap_median(whole); }
  /// The copies over one sheet alone.
  Interval times_one() const { return interleaved_ratio(copies, whole); }
  Interval times_links_alone() const { return interleaved_ratio(whole, links_alone); }
  /// A step of a vertex over one of `other`, which was timed in the same rounds.
  Interval times(const EffectRow& other) const { return interleaved_ratio(whole, other.whole); }
  Interval touching_nothing_times(const EffectRow& other) const {
    return interleaved_ratio(touching_nothing, other.whole);
  }
};

struct EffectBenchOptions {
  std::vector<std::string> scenes;  ///< names or files
  std::string solver;               ///< "jakobsen:iterations=1,substeps=15"
  int side = 0;                     ///< sheets of side x side vertices; 0: as the scene has it
  int copies = 0;  ///< of each scene, to be timed together on two threads; all is wall time then,
                   ///< else CPU time of the process; 0: none
  int rounds = 11;
  double seconds = 0.01;  ///< of one sample
  std::function<void(std::size_t done, std::size_t all)> progress = [](auto, auto) {};
};

/// All scenes in one interleaved session, in rounds of alternating order (ABBA). A sample begins at
/// up to four states spread over the scene's whole run. Scenes that are no sheet are left out where
/// `side` is set; radius and thickness shrink with the spacing. A scene that cannot be timed has a
/// row that says why.
std::vector<EffectRow> bench_effects(const EffectBenchOptions&);

}  // namespace taut
