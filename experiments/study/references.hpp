#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Result for one reference: its floor, or why there is no reference.
struct ReferenceOutcome {
  std::string scene, kind, derivation, refused;
  double t = 0, floor = 0;  ///< s, m
};

/// Writes the converged references of a scene into `folder`/SCENE: its state at rest, and its
/// states after 0.5, 1, 1.5 and 2 s, up to the horizon to which they are converged. Keeps existing
/// references of the same scene unless `replace`.
std::vector<ReferenceOutcome> write_references(const Scene&, const std::filesystem::path& folder,
                                               bool replace);

}  // namespace taut
