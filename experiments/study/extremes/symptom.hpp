#pragma once

#include <string>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// What there is to judge a run by.
struct JudgedRun {
  Case one;
  Record record;
  std::vector<Vec3> end;  ///< positions at the end [m]; empty: it did not come to its end
};

/// What is wrong with a run, the gravest first. Measured, each by its own rule:
///   NaN, explodes       status `exploded`: not finite; beyond the scene's energy or space
///   crashes             the process ended so
///   refuses             the solver says that it would misread the scene
///   tunnels             a vertex ended on the other side of a collider (tunnelling.count)
///   overstretches       a link is longer than twice its length (stretch.max > 1), or status
///                       `extreme`
///   freezes             the centre of mass moved less than a tenth as far as at the start
///                       of the range, scaled down with the cloth (drift.max)
///   gains energy        a passive scene's mechanical energy rose by over 5 % of what its swing can
///                       set free (energy.peak)
///   jitters             a vertex accelerates by over 100 g, and ten times as much as at the start
///                       of the range, in the last second (popping.max), or status `unsettled`
///   asymmetric          a mirror-symmetric scene ends over a tenth of its size from its mirror
///                       image
///   loses energy        a passive scene lost over half of that (energy.mean)
/// `start`: the run at the start of the range; nullptr: this is it.
std::vector<std::string> symptoms(const JudgedRun&, const JudgedRun* start);

/// What a pinned cloth's swing can set free [J]: from where it starts to hanging straight below its
/// pins, each vertex its distance at rest from the nearest pin. 0: not passive, or not pinned.
double swing_energy(const Scene&);

/// How far the cloth is from its mirror image in the plane across its first side [m]; 0 if the
/// scene has no such symmetry: a grid with rows along x, gravity and all else in the plane.
double asymmetry(const Scene&, const std::vector<Vec3>& end);

}  // namespace taut
