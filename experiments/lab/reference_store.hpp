#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// A converged state of a scene that no solver of the testbed took part in:
/// results/references/<scene>/static.json or motion-<t>.json.
struct Reference {
  std::string scene;       ///< its name
  std::string digest;      ///< SHA-256 of the scene's content; see digest(const Scene&)
  std::string kind;        ///< "static": where it comes to rest; "motion": where it is at time t
  double t = 0;            ///< s; motion only
  std::string derivation;  ///< how it was found, one sentence
  double floor = 0;        ///< m, its own error by self-convergence
  std::vector<Vec3> x;     ///< [n] m
};

/// Writes pretty JSON with shortest round-trip numbers; throws InputError if that fails.
void write_reference(const Reference&, const std::filesystem::path& folder);

/// The static reference of the scene of this name below `root` (results/references) if it belongs
/// to exactly this content: another grid or mass has none. Throws InputError on a file that is not
/// a reference.
std::optional<Reference> find_reference(const Scene&, const std::filesystem::path& root);

/// Throws InputError that names the file.
Reference read_reference(const std::filesystem::path&);

}  // namespace taut
