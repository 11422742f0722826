#pragma once

#include <string>
#include <string_view>

namespace taut {

/// A text from outside as a terminal may have it: each control character but tab and line feed
/// becomes '?', and what is beyond 2000 bytes "...". The text of every Diagnostic is.
std::string printable(std::string_view);

}  // namespace taut
