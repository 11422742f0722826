#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Result for one reference: its floor, or why there is no reference.
struct ReferenceOutcome {
  std::string scene, kind, derivation, refused;
  double t = 0;            ///< s, horizon of a motion
  double floor = 0;        ///< m, of a state at rest
  double floor_share = 0;  ///< of a motion, as a share of it
};

/// Writes the converged references of a scene into `folder`/SCENE: its state at rest, and its
/// motion at 32 moments up to the horizon, at most 2 s, at which references that should agree do;
/// where there is none, the observables of an ensemble of references.
/// Keeps existing references of the same scene unless `replace`.
std::vector<ReferenceOutcome> write_references(const Scene&, const std::filesystem::path& folder,
                                               bool replace);

}  // namespace taut
