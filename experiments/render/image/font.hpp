#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "experiments/render/image/canvas.hpp"

namespace taut {

/// A TrueType font, rasterised by stb_truetype.
class Font {
 public:
  explicit Font(std::string file_bytes);
  ~Font();
  /// Calls `plot(x, y, coverage)` for each pixel of the text whose baseline starts at (x, y); gives
  /// the advance in pixels. `size` is the em in pixels.
  double draw(double x, double y, std::string_view utf8, double size,
              const std::function<void(int, int, double)>& plot) const;

 private:
  struct Face;
  std::unique_ptr<Face> face_;
};

/// DejaVu Sans of Debian's fonts-dejavu-core; read once. Throws InputError that lists the folders
/// searched ($TAUT_FONTS first).
const Font& font(Weight);

}  // namespace taut
