#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/case/record.hpp"

namespace taut::report {

/// A colour of the light theme (paper, figures) with its twin of the dark theme. In the report it
/// is the CSS variable --name, so that one picture serves both themes.
struct Colour {
  std::string_view name;
  std::string_view light;  ///< "#0B6BCB"
  std::string_view dark;
};

/// How a solver is drawn in every picture: hue, marker and dash each tell solvers apart alone, so
/// that colour-blind readers, greyscale prints and coinciding lines lose nothing.
struct SolverStyle {
  Colour colour;
  int marker = 7;              ///< gnuplot point type, filled
  int hollow = 6;              ///< the same shape, not filled
  double marker_size = 1;      ///< relative to the figure's
  std::string_view dash = "";  ///< gnuplot dash pattern; "": solid
};

/// The same for a name in every figure, whatever else is drawn beside it. `variant` counts the
/// settings of one solver that share a figure: same hue and marker, another dash.
SolverStyle solver_style(std::string_view solver, int variant = 0);

/// What people call a solver: "jakobsen" -> "Jakobsen", "bullet" -> "Bullet".
std::string solver_title(std::string_view solver);

/// How a status is drawn in maps, and the glyph that stands for it on curves.
struct StatusStyle {
  Colour colour;
  std::string_view glyph;  ///< "" for ok
  std::string_view help;   ///< a few words for the legend
  Colour ink;              ///< the glyph's colour on `colour`
};
StatusStyle status_style(Status::Kind);

/// Neutral colours: ink, muted, axis, grid, stair, page.
Colour neutral(std::string_view name);

/// All colours, for style sheets and for the translation of figures into CSS variables.
std::span<const Colour> colours();

}  // namespace taut::report
