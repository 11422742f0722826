#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace taut::report {

/// Fewest digits that carry `digits` significant ones, no exponent between 1e-4 and 1e6:
/// 0.01234 -> "0.012", 22.04 -> "22", 3.4e-13 -> "3.4×10⁻¹³". NaN and infinities give "–" and "∞".
std::string significant(double value, int digits = 2);
/// So many decimals: -0.934 -> "−0.93"; never "−0.00".
std::string fixed(double value, int decimals);
/// The decimals that a value deserves whose uncertainty spans `width`: one digit of it, two where
/// the first is below 3; at most six.
int decimals_for(double width);
/// Every bit, shortest form: for data files. NaN gives "".
std::string exact(double value);
/// Plain text with the signs that a keyboard lacks: "dt^2 >= 2e-5, mu x 2" ->
/// "dt² ≥ 2×10⁻⁵, μ × 2".
std::string typeset(std::string_view);

/// For a page: & < > " ' escaped; control characters become U+FFFD.
std::string escape_html(std::string_view);
std::string csv_field(
    std::string_view);  ///< quoted if it must be; one line always, as gnuplot wants; what begins
                        ///< with = + - @ gets a ' in front: a spreadsheet would run it
std::string gnuplot_string(std::string_view);  ///< a literal that no text can leave; one line
std::string base64(std::string_view bytes);
/// Letters, digits, '-', '_' and '.' only, '-' and '.' not first, at most 129: safe as a file name
/// and as an HTML id. A text of which something was replaced or cut off gets a digest: two texts
/// never share one.
std::string slug(std::string_view);

/// With a capital first letter, if it is a plain one: for headings.
std::string capitalised(std::string);

/// "ball, box and plane"
std::string joined(const std::vector<std::string>& names);

}  // namespace taut::report
