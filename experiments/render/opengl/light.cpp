#include "experiments/render/opengl/light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taut {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kGoldenAngle = 2.3999632f;  ///< Vogel's spiral covers discs and domes evenly

constexpr float kFarthest = -1e30f;  ///< of a depth map: nothing is seen there

/// What a distant light sees: the nearest surface along its direction, in an orthographic map that
/// covers a sphere.
class DepthMap {
 public:
  DepthMap(int size, const Vec3f& direction, const Vec3f& centre, float radius)
      : size_(size),
        centre_(centre),
        scale_(static_cast<float>(size - 4) / (2 * radius)),
        depth_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {
    aim(direction);
  }

  /// Starts again for another light.
  void aim(const Vec3f& direction) {
    axes_.row(0) = direction.unitOrthogonal();
    axes_.row(2) = direction;
    axes_.row(1) = direction.cross(Vec3f(axes_.row(0)));
    std::fill(depth_.begin(), depth_.end(), kFarthest);
  }

  void draw(const RenderMesh& mesh) {
    const float middle = static_cast<float>(size_) / 2;
    projected_.clear();
    for (const Vec3f& p : mesh.position) {
      const Vec3f q = scale_ * (axes_ * (p - centre_));
      projected_.emplace_back(q.x() + middle, q.y() + middle, q.z());
    }
    for (const auto& [a, b, c] : mesh.triangles)
      draw_triangle(projected_[a], projected_[b], projected_[c]);
  }

  /// Share of the four texels around p that see the light; p is moved towards it by one texel.
  /// Outside the map: 1.
  float visibility(const Vec3f& p) const {
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

  float texel() const { return 1 / scale_; }  ///< m

 private:
  /// Half-space rasterisation at texel centres; either winding.
  void draw_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(area) < 1e-12f) return;
    const auto first = [](float low) {
      return std::max(0, static_cast<int>(std::ceil(low - 0.5f)));
    };
    const auto last = [this](float high) {
      return std::min(size_ - 1, static_cast<int>(std::floor(high - 0.5f)));
    };
    const int x0 = first(std::min({a.x(), b.x(), c.x()})),
              x1 = last(std::max({a.x(), b.x(), c.x()}));
    const int y0 = first(std::min({a.y(), b.y(), c.y()})),
              y1 = last(std::max({a.y(), b.y(), c.y()}));
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

  int size_;
  Vec3f centre_;
  float scale_;  ///< texels per metre
  Eigen::Matrix3f axes_;
  std::vector<float> depth_;
  std::vector<Vec3f> projected_;
};

/// Directions spread over a disc of angular radius `spread` around `centre`.
void add_disc(std::vector<Light>& lights, int count, const Vec3f& centre, float spread,
              float weight) {
  const Vec3f a = centre.unitOrthogonal(), b = centre.cross(a);
  for (int k = 0; k < count; ++k) {
    const float radius =
        std::tan(spread) * std::sqrt((static_cast<float>(k) + 0.5f) / static_cast<float>(count));
    const float angle = kGoldenAngle * static_cast<float>(k);
    const Vec3f direction = centre + radius * (std::cos(angle) * a + std::sin(angle) * b);
    lights.push_back({direction.normalized(), weight / static_cast<float>(count)});
  }
}

/// Directions spread over the sky, evenly by solid angle.
void add_dome(std::vector<Light>& lights, int count, const Vec3f& up, const Vec3f& start,
              float weight) {
  const Vec3f b = up.cross(start);
  for (int k = 0; k < count; ++k) {
    const float height = 1 - (static_cast<float>(k) + 0.5f) / static_cast<float>(count) * 0.97f;
    const float level = std::sqrt(1 - height * height);
    const float angle = kGoldenAngle * static_cast<float>(k);
    lights.push_back({(height * up + level * (std::cos(angle) * start + std::sin(angle) * b)),
                      weight / static_cast<float>(count)});
  }
}

/// Replaces each value by the mean of itself and its neighbours', `times` over.
void smooth(const RenderMesh& mesh, std::vector<float>& values, int times) {
  std::vector<float> sum(values.size()), weight(values.size());
  for (int pass = 0; pass < times; ++pass) {
    sum = values;
    std::fill(weight.begin(), weight.end(), 1.0f);
    for (const auto& triangle : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
        sum[a] += 0.5f * values[b], sum[b] += 0.5f * values[a];
        weight[a] += 0.5f, weight[b] += 0.5f;
      }
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = sum[i] / weight[i];
  }
}

/// Binomial filter (1 2 1) in both directions, `times` over.
void smooth(GroundLight& ground, int times) {
  const int n = ground.size;
  std::vector<float> other(ground.light.size());
  const auto pass = [n](const std::vector<float>& from, std::vector<float>& to, bool rows) {
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const auto at = [&](int d) {
          const int i = std::clamp(x + (rows ? d : 0), 0, n - 1);
          const int j = std::clamp(y + (rows ? 0 : d), 0, n - 1);
          return from[static_cast<std::size_t>(j * n + i)];
        };
        to[static_cast<std::size_t>(y * n + x)] = 0.25f * (at(-1) + 2 * at(0) + at(1));
      }
  };
  for (int k = 0; k < times; ++k) pass(ground.light, other, true), pass(other, ground.light, false);
}

void light_mesh(const DepthMap& map, const Light& light, RenderMesh& mesh) {
  const float lift = 1.3f * map.texel();
  for (std::size_t i = 0; i < mesh.position.size(); ++i) {
    const float cosine = mesh.normal[i].dot(light.direction);
    const Vec3f point = mesh.position[i] + (cosine > 0 ? lift : -lift) * mesh.normal[i];
    const float received = light.weight * std::abs(cosine) * map.visibility(point);
    (cosine > 0 ? mesh.front : mesh.back)[i] += received;
  }
}

void light_ground(const DepthMap& map, const Light& light, GroundLight& ground) {
  const float cosine = ground.up.dot(light.direction);
  for (int y = 0; y < ground.size; ++y)
    for (int x = 0; x < ground.size; ++x) {
      const auto place = [&](int k) {
        return ground.half_side *
               (2 * (static_cast<float>(k) + 0.5f) / static_cast<float>(ground.size) - 1);
      };
      const Vec3f p = ground.origin + place(x) * ground.u + place(y) * ground.v;
      ground.light[static_cast<std::size_t>(y * ground.size + x)] +=
          light.weight * cosine * map.visibility(p);
    }
}

}  // namespace

std::vector<Light> light_set(int count, const Vec3f& up, const Camera& camera) {
  const Vec3f toward = (camera.back - up * up.dot(camera.back)).normalized();
  const Vec3f right = up.cross(toward);
  const auto from = [&](float azimuth, float elevation) {  // degrees; azimuth from the camera
    const float a = azimuth * kPi / 180, e = elevation * kPi / 180;
    return Vec3f(std::cos(e) * (std::cos(a) * toward + std::sin(a) * right) + std::sin(e) * up);
  };
  std::vector<Light> lights;
  const int key = count / 3, fill = count / 6;
  add_disc(lights, key, from(-62, 52), 9 * kPi / 180, 0.72f);
  add_disc(lights, fill, from(58, 34), 28 * kPi / 180, 0.24f);
  add_dome(lights, count - key - fill, up, toward, 0.52f);
  return lights;
}

void bake_light(const std::vector<Light>& lights, const LightQuality& quality,
                const Sphere& casters, std::vector<RenderMesh>& meshes, GroundLight& ground) {
  ground.size = quality.ground_map;
  const auto cells = static_cast<std::size_t>(ground.size);
  ground.light.assign(cells * cells, 0);
  for (RenderMesh& mesh : meshes) {
    mesh.front.assign(mesh.position.size(), 0);
    mesh.back.assign(mesh.position.size(), 0);
  }
  float open = 0;
  DepthMap map(quality.depth_map, ground.up, casters.centre, casters.radius);
  for (const Light& light : lights) {
    map.aim(light.direction);
    for (const RenderMesh& mesh : meshes) map.draw(mesh);
    for (RenderMesh& mesh : meshes) light_mesh(map, light, mesh);
    light_ground(map, light, ground);
    open += light.weight * std::max(0.0f, ground.up.dot(light.direction));
  }
  for (RenderMesh& mesh : meshes)
    for (std::vector<float>* side : {&mesh.front, &mesh.back}) {
      for (float& received : *side) received /= open;
      smooth(mesh, *side, 2);
    }
  for (float& received : ground.light) received /= open;
  smooth(ground, 2);
}

}  // namespace taut
