#pragma once

#include <array>
#include <string_view>

#include "experiments/render/image/image.hpp"

namespace taut {

/// A point on a canvas in pixels, y downwards.
struct Point {
  double x = 0, y = 0;
};

enum class Weight { regular, bold };
enum class Align { left, centre, right };

/// Style of text. The typeface is DejaVu Sans, anti-aliased and kerned.
struct TextStyle {
  double size = 16;  ///< em in pixels
  Rgb8 colour;
  Weight weight = Weight::regular;
  Align align = Align::left;
};

/// Draws flat, anti-aliased shapes and text on an image.
class Canvas {
 public:
  explicit Canvas(Image& image) : image_(image) {}
  void fill(double x, double y, double width, double height, Rgb8);
  void fill_rounded(double x, double y, double width, double height, double radius, Rgb8,
                    double opacity = 1);
  void disc(Point centre, double radius, Rgb8);
  /// Accepts the corners in any order.
  void triangle(const std::array<Point, 3>&, Rgb8);
  /// Draws text whose baseline starts at `at` and returns its advance in pixels. Throws InputError
  /// if no font is found.
  double text(Point at, std::string_view utf8, const TextStyle&);

 private:
  void blend(int x, int y, Rgb8, double coverage);
  template <class Coverage>
  void cover(double x0, double y0, double x1, double y1, Rgb8, const Coverage&);
  Image& image_;
};

/// Advance of the text in pixels. Throws InputError if no font is found.
double text_width(std::string_view utf8, double size, Weight = Weight::regular);

}  // namespace taut
