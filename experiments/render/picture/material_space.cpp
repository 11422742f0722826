#include <algorithm>
#include <cmath>

#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

Image SceneRenderer::material_space(std::size_t index, double t, int longest_side) const {
  if (!scene_.mesh.grid) return {};
  const Grid& grid = *scene_.mesh.grid;
  const auto& frame = runs_[index].at(t);
  const std::vector<double> values = vertex_values(scene_, scale_.quantity, frame.state, frame.t);
  const auto side = [&](int from, int to) {
    return (scene_.mesh.rest[static_cast<std::size_t>(to)] -
            scene_.mesh.rest[static_cast<std::size_t>(from)])
        .norm();
  };
  const double across = side(grid.index(0, 0), grid.index(grid.nu - 1, 0));
  const double down = side(grid.index(0, 0), grid.index(0, grid.nv - 1));
  const double scale = longest_side / std::max(across, down);
  Image image(std::max(longest_side / 9, static_cast<int>(std::lround(across * scale))),
              std::max(longest_side / 9, static_cast<int>(std::lround(down * scale))));
  // Linear between the vertices; the outermost vertices lie on the border.
  const auto locate = [](int pixel, int pixels, int vertices) {
    const double s = std::clamp((pixel + 0.5) / pixels, 0.0, 1.0) * (vertices - 1);
    const int i = std::min(static_cast<int>(s), std::max(vertices - 2, 0));
    return std::pair{i, s - i};
  };
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto [i, a] = locate(x, image.width(), grid.nu);
      const auto [j, b] = locate(y, image.height(), grid.nv);
      const auto at = [&, i = i, j = j](int di, int dj) {
        return values[static_cast<std::size_t>(
            grid.index(std::min(i + di, grid.nu - 1), std::min(j + dj, grid.nv - 1)))];
      };
      image.at(x, y) = scale_.colour((1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) +
                                     b * ((1 - a) * at(0, 1) + a * at(1, 1)));
    }
  return image;
}

}  // namespace taut
