#include "experiments/render/image/font.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include "core/model/input_error.hpp"

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_truetype.h>
#pragma GCC diagnostic pop

namespace taut {

struct Font::Face {
  std::string bytes;
  stbtt_fontinfo info;
};

namespace {

/// Takes one code point off the front of `text`; a malformed byte counts as U+FFFD.
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

}  // namespace

Font::Font(std::string file_bytes) : face_(std::make_unique<Face>()) {
  face_->bytes = std::move(file_bytes);
  const auto* data = reinterpret_cast<const unsigned char*>(face_->bytes.data());
  if (!stbtt_InitFont(&face_->info, data, stbtt_GetFontOffsetForIndex(data, 0)))
    throw InputError("not a TrueType font: DejaVu Sans is damaged");
}

Font::~Font() = default;

double Font::draw(double x, double y, std::string_view utf8, double size,
                  const std::function<void(int, int, double)>& plot) const {
  const stbtt_fontinfo* info = &face_->info;
  const float scale = stbtt_ScaleForMappingEmToPixels(info, static_cast<float>(size));
  const double start = x;
  std::vector<unsigned char> glyph;
  for (int previous = 0; !utf8.empty();) {
    const int index = stbtt_FindGlyphIndex(info, next_code_point(utf8));
    if (previous != 0)
      x += static_cast<double>(scale) * stbtt_GetGlyphKernAdvance(info, previous, index);
    const double left = std::floor(x);
    const auto subpixel = static_cast<float>(x - left);
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    stbtt_GetGlyphBitmapBoxSubpixel(info, index, scale, scale, subpixel, 0, &x0, &y0, &x1, &y1);
    const int width = x1 - x0, height = y1 - y0;
    glyph.assign(static_cast<std::size_t>(std::max(width * height, 0)), 0);
    if (!glyph.empty())
      stbtt_MakeGlyphBitmapSubpixel(info, glyph.data(), width, height, width, scale, scale,
                                    subpixel, 0, index);
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column)
        plot(static_cast<int>(left) + x0 + column, static_cast<int>(std::lround(y)) + y0 + row,
             glyph[static_cast<std::size_t>(row * width + column)] / 255.0);
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(info, index, &advance, &bearing);
    x += static_cast<double>(scale) * advance;
    previous = index;
  }
  return x - start;
}

const Font& font(Weight weight) {
  static const auto load = [](const char* file) { return std::make_unique<Font>(read_font(file)); };
  if (weight == Weight::bold) {
    static const auto bold = load("DejaVuSans-Bold.ttf");
    return *bold;
  }
  static const auto regular = load("DejaVuSans.ttf");
  return *regular;
}

}  // namespace taut
