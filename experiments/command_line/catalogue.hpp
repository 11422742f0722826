#pragma once

#include <string>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Tables of what there is: "scenes", "solvers", "metrics", "studies", "keys", "fabrics",
/// "assertions", "record", "answers"; all for "", one solver with its parameters for its name.
/// Throws InputError: there is nothing of this name.
Answer catalogue(const std::string& what);

}  // namespace taut
