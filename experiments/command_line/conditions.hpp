#pragma once

#include <string>
#include <vector>

#include "experiments/command_line/arguments.hpp"

namespace taut {

// Conditions on what an option gets. Their complaints name the word and what is expected.

Condition above_zero();
Condition above_zero_seconds();  ///< at most kLongestSeconds
Condition in_range(int least, int most);
Condition in_range(double least, double most);
Condition existing_file();
Condition only(const std::string& name);
Condition either(const Condition&, const Condition&);

/// One of these names. The complaint suggests the nearest and lists all if they are few.
Condition known(const std::string& what, std::vector<std::string> names);

/// The name of a metric's value, such as "stretch.rms".
Condition metric_value();

}  // namespace taut
