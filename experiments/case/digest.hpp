#pragma once

#include <string>
#include <string_view>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"

namespace taut {

/// SHA-256 (FIPS 180-4) in lower-case hexadecimal, 64 characters.
std::string sha256(std::string_view bytes);

/// SHA-256 of content(scene): equal exactly when the scenes are the same simulation.
std::string digest(const Scene&);

/// SHA-256 of the bits of x and v: equal exactly when the states are bit-identical (-0 and 0
/// differ).
std::string digest(const State&);

/// The address of a case's result: SHA-256 of canonical JSON (keys in a fixed order, no spaces,
/// doubles in shortest exact form) over schema, scene content, solver with all parameters except
/// those that say where its program lies, implementation, for an external program the client that
/// talks to it, measurement, dt and steps. Not the scene's name, the host, the time or the commit.
/// `scene_digest` is digest(scene).
std::string case_key(const Scene& scene, const std::string& scene_digest, const SolverChoice&);

/// Digest of everything in this program that makes numbers: measurement() and every solver.
/// Findings of one build say nothing about another one.
std::string program_digest();

}  // namespace taut
