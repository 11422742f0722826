#pragma once

#include <string>
#include <vector>

#include "experiments/render/image/image.hpp"

namespace taut {

/// A colour map: a table of sRGB colours over [0, 1]. Everything that shows data (cloth, colour
/// bar, inset) takes its colours from one of these.
class ColourMap {
 public:
  static constexpr int kSize = 513;  ///< odd, so that the middle is an entry
  /// Blue to near-white to red. Its lightness is symmetric in OKLab (Ottosson 2020), so that folds
  /// stay visible and neither sign stands out more than the other.
  static const ColourMap& diverging();
  /// Near-white to violet, for penetration.
  static const ColourMap& violet();
  /// Near-white to deep teal, for speed.
  static const ColourMap& teal();

  Rgb8 at(double s) const;  ///< s is clamped to [0, 1]
  const std::vector<Rgb8>& table() const { return table_; }

 private:
  explicit ColourMap(std::vector<Rgb8> table) : table_(std::move(table)) {}
  std::vector<Rgb8> table_;
};

/// The quantity that colours the cloth.
enum class ColourBy {
  strain,       ///< mean signed strain of the structural and shear links at a vertex
  penetration,  ///< depth below the surface of a collider, m
  speed         ///< m/s
};

ColourBy parse_colour_by(const std::string&);  ///< throws InputError

/// Maps numbers to colours. [low, high] is the range of the colour bar; values beyond it get the
/// colour of the nearer end, as the arrows of the bar show.
struct ColourScale {
  ColourBy colour_by = ColourBy::strain;
  double high = 1;  ///< SI units, > 0; low is -high for strain, 0 otherwise

  double low() const { return colour_by == ColourBy::strain ? -high : 0; }
  double position(double value) const { return (value - low()) / (high - low()); }
  const ColourMap& map() const;
  Rgb8 colour(double value) const { return map().at(position(value)); }
  double shown() const;                  ///< displayed units per SI unit: 100 for %
  std::string title() const;             ///< "mean edge strain ε at each vertex"
  std::string text(double value) const;  ///< three significant digits: "+2 %", "1.5 mm", "0.8 m/s"
  std::vector<double> ticks() const;     ///< both ends, and round numbers between them
};

/// Smallest round number (1, 1.5, 2, 3, 4, 5, 6, 8 x 10^k) that is at least max(value, least).
/// Precondition: both positive.
double round_up(double value, double least);

double linear_of(std::uint8_t srgb);  ///< sRGB transfer function: [0, 255] -> [0, 1]

}  // namespace taut
