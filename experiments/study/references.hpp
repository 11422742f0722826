#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// What became of a reference: its floor [m], or why there is none.
struct ReferenceOutcome {
  std::string scene, kind, derivation, refused;
  double t = 0, floor = 0;  ///< s, m
};

/// Writes the converged references of a scene into `folder`/SCENE: where it comes to rest, and its
/// state after 0.5, 1, 1.5 and 2 s, up to the horizon to which that is converged. What is there
/// already of the same scene is kept unless `replace`.
std::vector<ReferenceOutcome> write_references(const Scene&, const std::filesystem::path& folder,
                                               bool replace);

}  // namespace taut
