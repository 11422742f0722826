#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/case/record.hpp"

namespace taut::report {

/// A colour in the light theme (also paper and figures) and its counterpart in the dark theme.
struct Colour {
  std::string_view light;  ///< "#0B6BCB"
  std::string_view dark;
};

/// Style of a solver in every picture. Hue, marker and dash each distinguish solvers on their own,
/// so that nothing is lost to colour-blind readers, in greyscale prints and where lines coincide.
struct SolverStyle {
  Colour colour;
  std::string_view shape;      ///< shape of its marker, different for each solver: "circle"
  std::string_view marker;     ///< the same marker as gnuplot's point type: "7", "'★' ps 1.2"
  std::string_view dash = "";  ///< lengths of strokes and gaps: "9 4"; "": solid
};

/// Style of a solver, the same in every figure.
SolverStyle solver_style(std::string_view solver);

/// Lengths of strokes and gaps of a solver's line, different for each choice of its settings.
std::string_view dash_of(std::string_view solver, int variant);

inline constexpr Colour kDarkInk{"#1A1A19", "#1A1A19"};  ///< text on light shades

/// Style of a status in maps, and the glyph that represents it everywhere.
struct StatusStyle {
  Colour colour;
  std::string_view glyph;  ///< one character
  std::string_view help;   ///< a few words for the legend
  Colour ink;              ///< the glyph's colour on `colour`
};
StatusStyle status_style(Status::Kind);

/// A shade of "ok" in which maps show completed cases, chosen by RMS stretch.
struct StretchShade {
  double end;    ///< upper end of the stretch; infinite: everything beyond
  double share;  ///< share of the colour of "ok"; the rest is the background
  std::string_view text;
};
std::span<const StretchShade> stretch_shades();  ///< in ascending order

}  // namespace taut::report
