#include "experiments/render/image/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_truetype.h>
#pragma GCC diagnostic pop

namespace taut {

namespace {

/// Share of a pixel that lies inside an edge, from the signed distance of the pixel's centre to the
/// edge (negative inside).
double inner_share(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

double distance_to_rounded(double px, double py, double half_width, double half_height,
                           double radius) {
  const double x = std::abs(px) - half_width + radius, y = std::abs(py) - half_height + radius;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - radius;
}

/// Removes the first code point of `text` and returns it; a malformed byte yields U+FFFD.
int next_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length > text.size() || (first >= 0x80 && first < 0xC0)) {
    text.remove_prefix(1);
    return 0xFFFD;
  }
  unsigned code = length == 1 ? first : first & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3Fu);
  text.remove_prefix(length);
  return static_cast<int>(code);
}

std::string read_font(const std::string& file) {
  std::vector<std::string> folders{"/usr/share/fonts/truetype/dejavu",
                                   "/usr/share/fonts/dejavu-sans-fonts", "/usr/share/fonts/TTF",
                                   "/usr/share/fonts/dejavu"};
  if (const char* own = std::getenv("TAUT_FONTS")) folders = {own};
  std::string tried;
  for (const std::string& folder : folders) {
    std::ifstream in(folder + "/" + file, std::ios::binary);
    if (in) return {std::istreambuf_iterator<char>(in), {}};
    tried += "\n  " + folder;
  }
  throw InputError("pictures need the font " + file + "; looked in" + tried +
                   "\nInstall fonts-dejavu-core, or name its folder in TAUT_FONTS");
}

/// A TrueType font, rasterised by stb_truetype.
struct Font {
  explicit Font(std::string file_bytes) : bytes(std::move(file_bytes)) {
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    if (!stbtt_InitFont(&info, data, stbtt_GetFontOffsetForIndex(data, 0)))
      throw InputError("not a TrueType font: DejaVu Sans is damaged");
  }
  Font(const Font&) = delete;  // `info` points into `bytes`
  Font& operator=(const Font&) = delete;
  /// Calls `plot(x, y, coverage)` for each pixel of the text, whose baseline starts at (x, y), and
  /// returns the advance in pixels. `size` is the em in pixels.
  double draw(double x, double y, std::string_view utf8, double size,
              const std::function<void(int, int, double)>& plot) const;

  std::string bytes;
  stbtt_fontinfo info;
};

double Font::draw(double x, double y, std::string_view utf8, double size,
                  const std::function<void(int, int, double)>& plot) const {
  const float scale = stbtt_ScaleForMappingEmToPixels(&info, static_cast<float>(size));
  const double start = x;
  std::vector<unsigned char> glyph;
  for (int previous = 0; !utf8.empty();) {
    const int index = stbtt_FindGlyphIndex(&info, next_code_point(utf8));
    if (previous != 0)
      x += static_cast<double>(scale) * stbtt_GetGlyphKernAdvance(&info, previous, index);
    const double left = std::floor(x);
    const auto subpixel = static_cast<float>(x - left);
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    stbtt_GetGlyphBitmapBoxSubpixel(&info, index, scale, scale, subpixel, 0, &x0, &y0, &x1, &y1);
    const int width = x1 - x0, height = y1 - y0;
    glyph.assign(static_cast<std::size_t>(std::max(width * height, 0)), 0);
    if (!glyph.empty())
      stbtt_MakeGlyphBitmapSubpixel(&info, glyph.data(), width, height, width, scale, scale,
                                    subpixel, 0, index);
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column)
        plot(static_cast<int>(left) + x0 + column, static_cast<int>(std::lround(y)) + y0 + row,
             glyph[static_cast<std::size_t>(row * width + column)] / 255.0);
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(&info, index, &advance, &bearing);
    x += static_cast<double>(scale) * advance;
    previous = index;
  }
  return x - start;
}

/// DejaVu Sans from Debian's fonts-dejavu-core, read once. If it is missing, throws InputError,
/// which lists the folders searched: $TAUT_FONTS alone if it is set.
const Font& font(Weight weight) {
  if (weight == Weight::bold) {
    static const Font bold(read_font("DejaVuSans-Bold.ttf"));
    return bold;
  }
  static const Font regular(read_font("DejaVuSans.ttf"));
  return regular;
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
