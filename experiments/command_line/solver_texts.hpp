#pragma once

#include <string>
#include <vector>

namespace taut {

/// Throws InputError with everything that is wrong with any of these solvers' texts.
void check_solvers(const std::vector<std::string>& texts);

}  // namespace taut
