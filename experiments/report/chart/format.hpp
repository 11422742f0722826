#pragma once

// Texts as files of other languages want them.

#include <string>
#include <string_view>

#include "experiments/answer/answer.hpp"

namespace taut::report {

/// For a page: & < > " ' escaped; control characters become U+FFFD.
std::string escape_html(std::string_view);
using taut::csv_field;
std::string gnuplot_string(std::string_view);  ///< a literal that no text can leave; one line
std::string base64(std::string_view bytes);
/// Letters, digits, '-', '_' and '.' only, '-' and '.' not first, at most 129: safe as a file name
/// and as an HTML id. A text of which something was replaced or cut off gets a digest: two texts
/// never share one.
std::string slug(std::string_view);

}  // namespace taut::report
