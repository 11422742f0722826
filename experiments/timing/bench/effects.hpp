#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// Cost of a step of one scene, with all its effects and with its links alone.
struct EffectRow {
  /// Scene and its effects: "flag", "wind"; no effects: only links and pins.
  std::string scene, effects;
  std::size_t vertices = 0;
  double dt = 0;        ///< s
  std::string refused;  ///< why it was not timed; empty if it was
  /// Nanoseconds per vertex and step, two samples per round: with all effects, and from the same
  /// states without wind, colliders and self-collision.
  std::vector<double> whole, links_alone;
  std::vector<double> copies;  ///< for all copies together on two threads, one step of each
  /// The same with colliders so far away that nothing touches them. Empty if there are none.
  std::vector<double> touching_nothing;

  Interval cost() const { return bootstrap_median(whole); }
  /// Cost of the copies relative to a single sheet.
  Interval times_one() const { return interleaved_ratio(copies, whole); }
  Interval times_links_alone() const { return interleaved_ratio(whole, links_alone); }
  /// Cost per vertex and step relative to `other`, which was timed in the same rounds.
  Interval times(const EffectRow& other) const { return interleaved_ratio(whole, other.whole); }
  Interval touching_nothing_times(const EffectRow& other) const {
    return interleaved_ratio(touching_nothing, other.whole);
  }
};

struct EffectBenchOptions {
  std::vector<std::string> scenes;  ///< names or files
  std::string solver;               ///< "jakobsen:iterations=1,substeps=15"
  int side = 0;                     ///< sheets of side x side vertices; 0: as the scene has it
  /// Copies of each scene that are timed together on two threads. If not 0, all times are wall
  /// times, otherwise CPU times of the process.
  int copies = 0;
  int rounds = 11;
  double seconds = 0.01;  ///< CPU or wall time of one sample [s]
  std::function<void(std::size_t done, std::size_t all)> progress = [](auto, auto) {};
};

/// Times all scenes in one interleaved session, in rounds of alternating order (ABBA). A sample
/// starts from up to four states spread over the scene's whole run. With `side`, scenes that are
/// not sheets are left out, and radius and thickness shrink with the spacing. A scene that cannot
/// be timed has a row that says why.
std::vector<EffectRow> bench_effects(const EffectBenchOptions&);

}  // namespace taut
