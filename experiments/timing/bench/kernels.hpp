#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/timing/bench/two_cores.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

/// One way to project links, on one size of sheet.
struct KernelRow {
  std::string name;
  int threads = 1;
  int flops = 0;     ///< additions, multiplications, divisions and roots of one projection
  int bytes = 0;     ///< read and written in one projection, as the program asks for them
  double floor = 0;  ///< ns: flops at the machine's measured rate
  std::vector<double> samples;  ///< ns per projection, one of each round
  /// ns per projection from the fastest parts of all samples: what it costs while nothing else
  /// uses the core. A neighbour on a core's other thread slows wide vectors by half and more, and
  /// the textbook, which waits for its own results, hardly at all.
  double fastest = 0;
  /// A step without a sweep (integration, pins) of a sheet that begins to fall, in sweeps over the
  /// structural links alone, one of each round.
  std::vector<double> fixed;
  Interval cost() const { return bootstrap_median(samples); }
};

struct KernelBench {
  int side = 0;                 ///< vertices of the square sheet's side
  std::vector<KernelRow> rows;  ///< the first is the textbook
  /// ns of a square-root-free projection in registers (seconds_per_projection).
  double arithmetic_float = 0, arithmetic_double = 0;
  /// ns to load and store the particles of a link in a colour batch (seconds_per_link_traffic).
  double traffic_float = 0, traffic_double = 0;
  TwoCores two_cores;
  /// Median over rounds of rows[i]'s cost over rows[j]'s cost.
  Interval ratio(std::size_t i, std::size_t j) const;
};

struct KernelBenchOptions {
  int side = 32;
  int rounds = 11;
  double seconds = 0.005;  ///< of one sample
  bool bullet = true;
  std::function<void(std::size_t done, std::size_t all)> progress = [](auto, auto) {};  ///< rounds
};

/// All kernels interleaved: each round times every one of them in alternating order (ABBA). A
/// projection's time is the difference between steps of 18 and of 2 sweeps, so that what a step
/// costs besides drops out. One thread: CPU time; several: wall time.
KernelBench bench_kernels(const KernelBenchOptions&);

/// Seconds of one addition or multiplication of floats (doubles) on this machine's widest vectors
/// when nothing stands in the way.
double seconds_per_flop(bool single);
/// Seconds of one square-root-free projection of particles that are in registers already: its
/// arithmetic with the division, without loads and stores.
double seconds_per_projection(bool single);
/// Seconds from one thread's store of a word to its sight by another, at its fastest: threads are
/// not pinned, and virtual cores may lie near each other or not.
double seconds_per_handover();
/// Seconds to load and to store both ends of a link as the sweep over the scene's colour batches
/// does, in its order, with an addition in the place of the projection.
double seconds_per_link_traffic(const Scene&, bool single);

}  // namespace taut
