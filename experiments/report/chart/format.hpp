#pragma once

// Texts in the form that other languages need.

#include <string>
#include <string_view>

#include "experiments/answer/answer.hpp"

namespace taut::report {

/// Text for a page: & < > " ' are escaped, control characters become U+FFFD.
std::string escape_html(std::string_view);
/// A literal on one line that no text can break out of.
std::string gnuplot_string(std::string_view);
std::string base64(std::string_view bytes);

}  // namespace taut::report
