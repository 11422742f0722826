#include "experiments/render/image/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/render/image/font.hpp"

namespace taut {

namespace {

/// Share of a pixel on the inner side of an edge whose signed distance (negative inside) from the
/// pixel's centre is known.
double inner_share(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

double distance_to_rounded(double px, double py, double half_width, double half_height,
                           double radius) {
  const double x = std::abs(px) - half_width + radius, y = std::abs(py) - half_height + radius;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - radius;
}

}  // namespace

void Canvas::blend(int x, int y, Rgb8 colour, double coverage) {
  if (x < 0 || y < 0 || x >= image_.width() || y >= image_.height() || coverage <= 0) return;
  Rgb8& pixel = image_.at(x, y);
  const auto mix = [coverage](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + (to - from) * std::min(coverage, 1.0)));
  };
  pixel = {mix(pixel.r, colour.r), mix(pixel.g, colour.g), mix(pixel.b, colour.b)};
}

template <class Coverage>
void Canvas::cover(double x0, double y0, double x1, double y1, Rgb8 colour,
                   const Coverage& coverage) {
  const int left = static_cast<int>(std::floor(x0)), right = static_cast<int>(std::ceil(x1));
  const int top = static_cast<int>(std::floor(y0)), bottom = static_cast<int>(std::ceil(y1));
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) blend(x, y, colour, coverage(x + 0.5, y + 0.5));
}

void Canvas::fill(double x, double y, double width, double height, Rgb8 colour) {
  cover(x, y, x + width, y + height, colour, [&](double px, double py) {
    const double across = std::min(px + 0.5, x + width) - std::max(px - 0.5, x);
    const double down = std::min(py + 0.5, y + height) - std::max(py - 0.5, y);
    return std::max(across, 0.0) * std::max(down, 0.0);
  });
}

void Canvas::fill_rounded(double x, double y, double width, double height, double radius,
                          Rgb8 colour, double opacity) {
  const double cx = x + width / 2, cy = y + height / 2;
  cover(x, y, x + width, y + height, colour, [&](double px, double py) {
    return opacity *
           inner_share(distance_to_rounded(px - cx, py - cy, width / 2, height / 2, radius));
  });
}

void Canvas::disc(Point centre, double radius, Rgb8 colour) {
  cover(centre.x - radius - 1, centre.y - radius - 1, centre.x + radius + 1, centre.y + radius + 1,
        colour, [&](double px, double py) {
          return inner_share(std::hypot(px - centre.x, py - centre.y) - radius);
        });
}

void Canvas::triangle(const std::array<Point, 3>& p, Rgb8 colour) {
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  if (area == 0) return;
  cover(left - 1, top - 1, right + 1, bottom + 1, colour, [&](double px, double py) {
    double outermost = -1e9;
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &a = p[i], &b = p[(i + 1) % 3];
      const double ex = b.x - a.x, ey = b.y - a.y;
      const double side = (ex * (py - a.y) - ey * (px - a.x)) / std::hypot(ex, ey);
      outermost = std::max(outermost, area > 0 ? -side : side);
    }
    return inner_share(outermost);
  });
}

double Canvas::text(Point at, std::string_view utf8, const TextStyle& style) {
  const double width = text_width(utf8, style.size, style.weight);
  const double shift = style.align == Align::left ? 0 : style.align == Align::right ? 1 : 0.5;
  font(style.weight)
      .draw(at.x - shift * width, at.y, utf8, style.size,
            [&](int x, int y, double coverage) { blend(x, y, style.colour, coverage); });
  return width;
}

double text_width(std::string_view utf8, double size, Weight weight) {
  return font(weight).draw(0, 0, utf8, size, [](int, int, double) {});
}

}  // namespace taut
