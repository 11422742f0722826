#pragma once

#include <filesystem>
#include <string>

#include "experiments/answer/answer.hpp"

namespace taut {

/// What an iteration costs for each vertex by other people's code, which a reader fetched himself
/// to `checkout`, beside our solver of the same method and a sweep of Jakobsen's, in turns: builds
/// our adapter (experiments/beside) against it with $CXX or c++ in a folder that does not last, and
/// runs it. Throws InputError: no adapter knows the checkout, or it does not build or run; then
/// with the last of what the compiler said.
Answer bench_beside(const std::filesystem::path& checkout, int rounds);

}  // namespace taut
