#include "experiments/render/opengl/light.hpp"

#include <cmath>
#include <numbers>

namespace taut {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Angle between successive points of Vogel's spiral, which covers discs and domes evenly.
constexpr float kGoldenAngle = 2.3999632f;

/// Adds lights spread over a disc of angular radius `spread` around `centre`.
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

/// Adds lights spread over the sky, evenly by solid angle.
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

}  // namespace

std::vector<Light> light_set(int count, const Vec3f& up, const Camera& camera) {
  const Vec3f toward = (camera.back - up * up.dot(camera.back)).normalized();
  const Vec3f right = up.cross(toward);
  // Both in degrees; azimuth is relative to the camera.
  const auto from = [&](float azimuth, float elevation) {
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

}  // namespace taut
