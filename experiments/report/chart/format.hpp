#pragma once

// Texts as files of other languages want them.

#include <string>
#include <string_view>

#include "experiments/answer/answer.hpp"

namespace taut::report {

/// For a page: & < > " ' escaped; control characters become U+FFFD.
std::string escape_html(std::string_view);
std::string gnuplot_string(std::string_view);  ///< a literal that no text can leave; one line
std::string base64(std::string_view bytes);

}  // namespace taut::report
