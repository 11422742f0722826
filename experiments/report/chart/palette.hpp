#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/case/record.hpp"

namespace taut::report {

/// A colour of the light theme (paper, figures) with its twin of the dark theme.
struct Colour {
  std::string_view light;  ///< "#0B6BCB"
  std::string_view dark;
};

/// How a solver is drawn in every picture: hue, marker and dash each tell solvers apart alone, so
/// that colour-blind readers, greyscale prints and coinciding lines lose nothing.
struct SolverStyle {
  Colour colour;
  std::string_view shape;      ///< of its marker, another for each solver: "circle"
  std::string_view marker;     ///< the same as gnuplot's point type: "7", "'★' ps 1.2"
  std::string_view dash = "";  ///< lengths of strokes and gaps: "9 4"; "": solid
};

/// By its name: the same in every figure, whatever else is drawn beside it.
SolverStyle solver_style(std::string_view solver);

/// Lengths of strokes and gaps of a solver's line; each further choice of its settings has another.
std::string_view dash_of(std::string_view solver, int variant);

/// How a status is drawn in maps, and the glyph that stands for it everywhere.
struct StatusStyle {
  Colour colour;
  std::string_view glyph;  ///< one character
  std::string_view help;   ///< a few words for the legend
  Colour ink;              ///< the glyph's colour on `colour`
};
StatusStyle status_style(Status::Kind);

/// What completed is drawn in maps in shades of "ok", by its RMS stretch.
struct StretchShade {
  double end;    ///< of the stretch; infinite: all beyond
  double share;  ///< of the colour of "ok"; the rest is the background
  std::string_view text;
};
std::span<const StretchShade> stretch_shades();  ///< ascending

}  // namespace taut::report
