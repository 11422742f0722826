#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/metrics/observables.hpp"

namespace taut {

/// The converged state of a scene at rest, in which no solver of the testbed took part:
/// results/references/<scene>/static.json.
struct Reference {
  std::string scene;       ///< name of the scene
  std::string digest;      ///< SHA-256 of everything it depends on; see reference_digest
  std::string derivation;  ///< how it was found, one sentence
  double floor = 0;        ///< m, its own error from self-convergence
  std::vector<Vec3> x;     ///< [n] m
};

/// The converged motion of a scene from its start to the horizon to which it is known, in which no
/// solver of the testbed took part: results/references/<scene>/motion.json and motion.npy.
struct MotionReference {
  std::string scene, digest, derivation;  ///< as in Reference
  double horizon = 0;                     ///< s
  /// Distance between references that should be equal, as a share of the motion: RMS over moments
  /// and free vertices, as motion.error is. The largest over all that were computed.
  double floor = 0;
  /// motion.error of a cloth that stands still and is only pushed out of the bodies; 1 without.
  double pushed_out = 1;
  std::vector<State> states;  ///< [moments + 1], at equal intervals from the start to the horizon

  double interval() const { return horizon / static_cast<double>(states.size() - 1); }  ///< s
  /// State at t [s], at most the horizon: the cubic through places and velocities of the moments
  /// beside it.
  std::vector<Vec3> at(double t) const;
};

/// Observables of a scene whose motion in contact is chaotic, over references whose starts differ
/// by a millionth: results/references/<scene>/ensemble.json.
struct Ensemble {
  std::string scene, digest, derivation;  ///< as in Reference
  double from = 0, to = 0;                ///< s, time over which observables are averaged
  Observables mean;
  double fall = 0;   ///< m, displacement of the centre of mass from the start
  double floor = 0;  ///< twice the standard deviation of the worst observable, as apart() has it
  double plate = 0;  ///< apart() of a rigid plate at rest on the body
};

/// The references of a scene: the shipped ones, if they belong to exactly this cloth.
struct References {
  std::optional<Reference> rest;
  std::optional<MotionReference> motion;
  std::optional<Ensemble> ensemble;  ///< of a scene without a known motion
};

/// Defined in experiments/case/reference_store, so that metrics need not know files. Throws
/// InputError if a file is not a reference.
References known_references(const Scene&);

}  // namespace taut
