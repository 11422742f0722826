#pragma once

#include <string>
#include <string_view>

namespace taut::external {

/// Letters, digits, _ and -, at most 40, a letter first.
bool is_solver_name(std::string_view);

/// A name for a program or a file that the user gave none: what it is called, as far as a name may
/// hold it, and four digits of what it is told by, so that no two share theirs.
std::string name_for(std::string_view called, std::string_view told_by);

}  // namespace taut::external
