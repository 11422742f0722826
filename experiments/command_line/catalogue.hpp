#pragma once

#include <string>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Tables of what exists: "scenes", "solvers", "metrics", "studies", "keys", "fabrics",
/// "assertions", "record", "answers". "" stands for all; the name of a solver gives that solver
/// with its parameters. Throws InputError if nothing has this name.
Answer catalogue(const std::string& what);

}  // namespace taut
