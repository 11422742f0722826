#pragma once

#include <string>
#include <string_view>

namespace taut {

enum class Colour { red = 31, green = 32, yellow = 33 };

/// The text in a colour if stdout is a terminal and $NO_COLOR is not set; else as it is.
std::string coloured(std::string_view text, Colour);

}  // namespace taut
