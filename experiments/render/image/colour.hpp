#pragma once

#include <string>
#include <vector>

#include "experiments/render/image/image.hpp"

namespace taut {

/// A colour map: a table of sRGB colours over [0, 1]. Everything that shows data (cloth, colour
/// bar, inset) takes its colours from here.
class ColourMap {
 public:
  static constexpr int kSize = 513;  ///< odd: the middle is an entry
  /// Blue, near-white in the middle, red: symmetric in OKLab lightness, so that folds stay visible
  /// and neither sign looks louder. OKLab: Ottosson 2020.
  static const ColourMap& diverging();
  /// Near-white to violet (penetration) or to deep teal (speed).
  static const ColourMap& violet();
  static const ColourMap& teal();

  Rgb8 at(double s) const;  ///< s is clamped to [0, 1]
  const std::vector<Rgb8>& table() const { return table_; }

 private:
  explicit ColourMap(std::vector<Rgb8> table) : table_(std::move(table)) {}
  std::vector<Rgb8> table_;
};

/// What colours the cloth.
enum class ColourBy {
  strain,       ///< mean strain of the structural links at a vertex, signed
  penetration,  ///< depth below the surface of a collider, m
  speed         ///< m/s
};

ColourBy parse_colour_by(const std::string&);  ///< throws InputError

/// How numbers become colours: [low, high] is the bar; what lies beyond takes the end's colour and
/// is announced by the bar's arrows.
struct ColourScale {
  ColourBy colour_by = ColourBy::strain;
  double high = 1;  ///< SI units, > 0; low is -high for strain, 0 otherwise

  double low() const { return colour_by == ColourBy::strain ? -high : 0; }
  double position(double value) const { return (value - low()) / (high - low()); }
  const ColourMap& map() const;
  Rgb8 colour(double value) const { return map().at(position(value)); }
  double shown() const;                  ///< number of shown units in one of SI: 100 for %
  std::string title() const;             ///< "mean edge strain ε at each vertex"
  std::string text(double value) const;  ///< "+2 %", "1.5 mm", "0.8 m/s": three digits
  std::vector<double> ticks() const;     ///< both ends and round numbers between
};

/// The smallest round number (1, 1.5, 2, 3, 4, 5, 6, 8 x 10^k) that is not below `value`; at least
/// `least`. Precondition: both positive.
double round_up(double value, double least);

double linear_of(std::uint8_t srgb);  ///< sRGB transfer function: [0, 255] -> [0, 1]

}  // namespace taut
