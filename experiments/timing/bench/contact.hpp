#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// What contact costs one setting of `jakobsen` on one scene, beside the structural links of the
/// same cloth.
struct ContactRow {
  std::string scene, setting;  ///< "ball", "contact=continuous,order=coloured"
  std::size_t particles = 0;
  int steps = 1;        ///< timed in one go from the same state
  double touching = 0;  ///< share of the particles in contact with a collider at the start
  /// CPU nanoseconds per particle, one of each round: a sweep over the structural links; contact in
  /// every sweep; what contact costs a step besides.
  std::vector<double> sweep, each_sweep, each_step;
  std::vector<double> bare;  ///< likewise: a step of one sweep without contact

  /// Contact of a step of so many sweeps, in structural sweeps.
  Interval ratio(int sweeps) const;
};

struct ContactBenchOptions {
  int side = 128;  ///< vertices along a side
  int rounds = 11;
  double seconds = 0.01;  ///< of one sample
  std::function<void(std::size_t done, std::size_t all)> progress = [](auto, auto) {};  ///< rounds
};

/// The scenes `plane`, `ball`, `box` and `crumple` with structural links alone, run until the cloth
/// lies on what it falls on. From that state: steps of 2 and of 18 sweeps, with contact and
/// without, all interleaved in alternating order (ABBA); one thread, CPU time. A step of
/// self-collision that begins afresh has to search for pairs, so it is timed in one step and in
/// eight.
std::vector<ContactRow> bench_contact(const ContactBenchOptions&);

}  // namespace taut
