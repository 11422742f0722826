#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// A converged state of a scene that no solver of the testbed took part in:
/// results/references/<scene>/static.json or motion-<t>s.json.
struct Reference {
  std::string scene;       ///< its name
  std::string digest;      ///< SHA-256 of what it depends on; see reference_digest
  std::string kind;        ///< "static": where it comes to rest; "motion": where it is at time t
  double t = 0;            ///< s; motion only
  std::string derivation;  ///< how it was found, one sentence
  double floor = 0;        ///< m, its own error by self-convergence
  std::vector<Vec3> x;     ///< [n] m
};

/// What is known of a scene; the shipped references if they belong to exactly this cloth.
struct References {
  std::optional<Reference> rest;
  std::vector<Reference> motion;  ///< ascending in t, up to the horizon of convergence
};

/// Found by experiments/case/reference_store, so that metrics know no files. Throws InputError on
/// a file that is not a reference.
References known_references(const Scene&);

}  // namespace taut
