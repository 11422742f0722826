#pragma once

#include <filesystem>
#include <string>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Compares the cost per iteration and vertex of public code with that of taut's solver of the same
/// method and of a sweep of Jakobsen's, timed in turns. The user has fetched the code to
/// `checkout`. Builds our adapter (experiments/beside) against it with $CXX or c++ in a temporary
/// folder, and runs it. Throws InputError if no adapter knows the checkout, or if the adapter does
/// not build or run; the message then ends with the compiler's last output.
Answer bench_beside(const std::filesystem::path& checkout, int rounds);

}  // namespace taut
