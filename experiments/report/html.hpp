#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/comparison.hpp"
#include "experiments/report/figures.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

/// The solver's name in its colour.
std::string solver_name(const Contender&);
std::string solver_name(const std::string& solver, const std::string& label);
/// A dot in the solver's colour.
std::string solver_dot(const std::string& solver);

/// "ball, box and plane"; escaped.
std::string listed(const std::vector<std::string>& names);

/// A swatch with its glyph and a name for each status; `explained`: with a few words more.
std::string status_legend(const std::set<Status::Kind>&, bool explained);

/// <table> with a caption for screen readers; the first column heads its row. Cells are escaped. On
/// a phone its rows become lists, each cell below its column's name.
std::string html_table(const Table&, const std::string& caption);

/// <details> with the table and a link that saves it as CSV. `csv` may be empty.
std::string html_data(const Table&, const std::string& caption, const std::string& csv,
                      const std::string& file);

/// A link that saves `text`; the bytes are in the page.
std::string download_link(const std::string& text, const std::string& file,
                          const std::string& label);

/// A line for what was not produced, with the command that produces it (may be empty).
std::string absent(const std::string& what, const std::string& command);

/// An SVG of gnuplot as a part of the page: colours become CSS variables, ids vanish (markers are
/// defined once, by svg_markers()), fonts are inherited, title and description are announced.
std::string inline_svg(std::string svg, const std::string& id, const std::string& title,
                       const std::string& description);

/// The marker shapes that all inlined SVGs use.
std::string svg_markers();

/// ":root{...}" with both themes; dark by the system's wish or by data-theme.
std::string theme_css();

}  // namespace taut::report
