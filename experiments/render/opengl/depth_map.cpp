#include "experiments/render/opengl/depth_map.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {
constexpr float kNothing = -1e30f;
}

DepthMap::DepthMap(int size, const Vec3f& direction, const Vec3f& centre, float radius)
    : size_(size),
      centre_(centre),
      scale_(static_cast<float>(size - 4) / (2 * radius)),
      depth_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {
  aim(direction);
}

void DepthMap::aim(const Vec3f& direction) {
  axes_.row(0) = direction.unitOrthogonal();
  axes_.row(2) = direction;
  axes_.row(1) = direction.cross(Vec3f(axes_.row(0)));
  std::fill(depth_.begin(), depth_.end(), kNothing);
}

void DepthMap::draw(const RenderMesh& mesh) {
  const float middle = static_cast<float>(size_) / 2;
  projected_.clear();
  for (const Vec3f& p : mesh.position) {
    const Vec3f q = scale_ * (axes_ * (p - centre_));
    projected_.emplace_back(q.x() + middle, q.y() + middle, q.z());
  }
  for (const auto& [a, b, c] : mesh.triangles)
    draw_triangle(projected_[a], projected_[b], projected_[c]);
}

/// Half-space rasterisation at texel centres; either winding.
void DepthMap::draw_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (std::abs(area) < 1e-12f) return;
  const auto first = [](float low) { return std::max(0, static_cast<int>(std::ceil(low - 0.5f))); };
  const auto last = [this](float high) {
    return std::min(size_ - 1, static_cast<int>(std::floor(high - 0.5f)));
  };
  const int x0 = first(std::min({a.x(), b.x(), c.x()})), x1 = last(std::max({a.x(), b.x(), c.x()}));
  const int y0 = first(std::min({a.y(), b.y(), c.y()})), y1 = last(std::max({a.y(), b.y(), c.y()}));
  if (x0 > x1 || y0 > y1) return;
  const float inverse = 1 / area;
  // Barycentric weights of b and c, and depth, are linear over the map.
  const float wb_x = (c.y() - a.y()) * inverse, wb_y = -(c.x() - a.x()) * inverse;
  const float wc_x = -(b.y() - a.y()) * inverse, wc_y = (b.x() - a.x()) * inverse;
  for (int y = y0; y <= y1; ++y) {
    const float dy = static_cast<float>(y) + 0.5f - a.y();
    float* row = &depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_)];
    for (int x = x0; x <= x1; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - a.x();
      const float wb = wb_x * dx + wb_y * dy, wc = wc_x * dx + wc_y * dy;
      if (wb < 0 || wc < 0 || wb + wc > 1) continue;
      const float depth = a.z() + wb * (b.z() - a.z()) + wc * (c.z() - a.z());
      row[x] = std::max(row[x], depth);
    }
  }
}

float DepthMap::visibility(const Vec3f& p) const {
  const float middle = static_cast<float>(size_) / 2;
  const Vec3f q = scale_ * (axes_ * (p - centre_));
  const float fx = q.x() + middle - 0.5f, fy = q.y() + middle - 0.5f;
  if (!(fx >= 0 && fy >= 0 && fx < static_cast<float>(size_ - 1) &&
        fy < static_cast<float>(size_ - 1)))
    return 1;
  const auto x = static_cast<std::size_t>(fx), y = static_cast<std::size_t>(fy);
  const float sx = fx - static_cast<float>(x), sy = fy - static_cast<float>(y);
  const float z = q.z() + 1;
  const auto row = static_cast<std::size_t>(size_);
  const float* texel = &depth_[y * row + x];
  const auto open = [z](float depth) { return depth <= z ? 1.0f : 0.0f; };
  return (1 - sy) * ((1 - sx) * open(texel[0]) + sx * open(texel[1])) +
         sy * ((1 - sx) * open(texel[row]) + sx * open(texel[row + 1]));
}

}  // namespace taut
