#include "experiments/render/opengl/light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/render/opengl/depth_map.hpp"

namespace taut {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kGoldenAngle = 2.3999632f;  ///< Vogel's spiral covers discs and domes evenly

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
