#pragma once

#include <string_view>

namespace taut {

// Generated at build time (cmake/fingerprint.cpp). Comments and blank lines change no digest.

/// Digest of what a solver is made of: the sources that it uses, compiler, flags, library versions;
/// empty for a solver that is not part of the program (test doubles). `solver` is its name: that of
/// its TAUT_SOLVER line with hyphens for underscores.
std::string_view implementation(std::string_view solver);
/// Digest of all sources of the solver's layer, core/solver or bullet_ref, with core/model.
std::string_view layer_digest(std::string_view solver);
/// Digest of what turns states into numbers: metrics, divergence, run_case, references, and all
/// that these use.
std::string_view measurement();
/// Digest of the sources that run external programs as solvers and read the motions of others.
std::string_view external_client();
/// Digest of what draws pictures and films.
std::string_view pictures();
/// Compiler, flags and library versions, for people.
std::string_view toolchain();

}  // namespace taut
