#pragma once

#include <string>
#include <string_view>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"

namespace taut {

/// Digest of what a solver is made of: sources, compiler, flags, library versions; empty for a
/// solver that is not part of the program (test doubles). `solver` is its name: that of its
/// TAUT_SOLVER line with hyphens for underscores. Generated at build time
/// (cmake/fingerprint.cmake).
std::string_view implementation(std::string_view solver);
/// Digest of what turns states into numbers: metrics, verdict, run_case. Generated likewise.
std::string_view measurement();
/// Compiler, flags and library versions, for people. Generated likewise.
std::string_view toolchain();

/// The address of a case's result: SHA-256 of canonical JSON (sorted keys, no spaces, doubles in
/// shortest exact form) over schema, scene content, solver with all parameters, implementation,
/// measurement, dt and steps. Not the scene's name, the host, the time or the commit.
/// `scene_digest` is digest(scene).
std::string case_key(const Scene& scene, const std::string& scene_digest, const SolverChoice&);

}  // namespace taut
