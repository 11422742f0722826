#include "experiments/render/image/image.hpp"

#include <png.h>

#include <cassert>

#include "experiments/system/files.hpp"

namespace taut {

void Image::paste(const Image& part, int x, int y) {
  for (int row = 0; row < part.height(); ++row)
    for (int column = 0; column < part.width(); ++column) {
      const int to_x = x + column, to_y = y + row;
      if (to_x >= 0 && to_x < width_ && to_y >= 0 && to_y < height_)
        at(to_x, to_y) = part.at(column, row);
    }
}

Image shrunk(const Image& image, int k) {
  assert(image.width() % k == 0 && image.height() % k == 0);
  if (k == 1) return image;
  Image out(image.width() / k, image.height() / k);
  const auto mean = [k](int sum) { return static_cast<std::uint8_t>((sum + k * k / 2) / (k * k)); };
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      int r = 0, g = 0, b = 0;
      for (int j = 0; j < k; ++j)
        for (int i = 0; i < k; ++i) {
          const Rgb8 pixel = image.at(x * k + i, y * k + j);
          r += pixel.r;
          g += pixel.g;
          b += pixel.b;
        }
      out.at(x, y) = {mean(r), mean(g), mean(b)};
    }
  return out;
}

std::string png_bytes(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  [[maybe_unused]] const int good =
      png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels().data(), 0, nullptr);
  assert(good);
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  write_file(path, png_bytes(image));
}

}  // namespace taut
