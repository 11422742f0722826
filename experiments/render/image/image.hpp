#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// An sRGB colour, 8 bits a channel.
struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb8&) const = default;
};

/// "#242A34" as a colour: rgb(0x242A34).
constexpr Rgb8 rgb(std::uint32_t hex) {
  return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8),
          static_cast<std::uint8_t>(hex)};
}

/// Opaque sRGB pixels, rows from the top.
class Image {
 public:
  Image() = default;
  Image(int width, int height, Rgb8 fill = {})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}
  int width() const { return width_; }
  int height() const { return height_; }
  /// Preconditions: 0 <= x < width(), 0 <= y < height().
  Rgb8& at(int x, int y) { return pixels_[index(x, y)]; }
  const Rgb8& at(int x, int y) const { return pixels_[index(x, y)]; }
  const std::vector<Rgb8>& pixels() const { return pixels_; }
  /// Copies `part` to (x, y) and drops the pixels that fall outside.
  void paste(const Image& part, int x, int y);

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  int width_ = 0, height_ = 0;
  std::vector<Rgb8> pixels_;
};

/// The mean of each k x k block. Precondition: k divides both sides.
Image shrunk(const Image&, int k);

/// PNG without a time stamp: the same image gives the same bytes.
std::string png_bytes(const Image&);
void write_png(const std::filesystem::path&, const Image&);  ///< throws InputError

}  // namespace taut
