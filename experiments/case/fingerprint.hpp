#pragma once

#include <string_view>

namespace taut {

/// Digest of what a solver is made of: sources, compiler, flags, library versions; empty for a
/// solver that is not part of the program (test doubles). `solver` is its name: that of its
/// TAUT_SOLVER line with hyphens for underscores. Generated at build time
/// (cmake/fingerprint.cmake).
std::string_view implementation(std::string_view solver);
/// Digest of what turns states into numbers: metrics, divergence, run_case. Generated likewise.
std::string_view measurement();
/// Compiler, flags and library versions, for people. Generated likewise.
std::string_view toolchain();

}  // namespace taut
