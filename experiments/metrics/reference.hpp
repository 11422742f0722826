#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// A converged state of a scene in which no solver of the testbed took part:
/// results/references/<scene>/static.json or motion-<t>s.json.
struct Reference {
  std::string scene;       ///< name of the scene
  std::string digest;      ///< SHA-256 of everything it depends on; see reference_digest
  std::string kind;        ///< "static": at rest; "motion": at time t
  double t = 0;            ///< s; motion only
  std::string derivation;  ///< how it was found, one sentence
  double floor = 0;        ///< m, its own error from self-convergence
  std::vector<Vec3> x;     ///< [n] m
};

/// The references of a scene: the shipped ones, if they belong to exactly this cloth.
struct References {
  std::optional<Reference> rest;
  std::vector<Reference> motion;  ///< ascending in t, up to the horizon of convergence
};

/// Defined in experiments/case/reference_store, so that metrics need not know files. Throws
/// InputError if a file is not a reference.
References known_references(const Scene&);

}  // namespace taut
