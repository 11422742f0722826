#pragma once

#include <vector>

#include "experiments/render/opengl/camera.hpp"

namespace taut {

/// A distant light.
struct Light {
  Vec3f direction = Vec3f::UnitY();  ///< unit, towards the light
  float weight = 0;
};

/// A fixed set of distant lights that light a scene softly. A third of them form a key disc on the
/// camera's left, a sixth a broad fill on its right, and half a sky dome. Shadows are soft and
/// corners dark, without noise and the same in every frame. Precondition: 6 <= count <=
/// kMostLights.
std::vector<Light> light_set(int count, const Vec3f& up, const Camera&);

/// The plane that shows the shadows around the cloth and the ground lines.
struct Ground {
  Vec3f origin = Vec3f::Zero();                                       ///< its centre
  Vec3f u = Vec3f::UnitX(), v = Vec3f::UnitZ(), up = Vec3f::UnitY();  ///< unit, right-angled
  float half_side = 1;                                                ///< m, of the shaded square
};

/// How finely light is computed.
struct LightQuality {
  int lights = 32;       ///< at most kMostLights
  int depth_map = 384;   ///< texels along a side, one map per light
  int ground_map = 160;  ///< texels along a side
};
inline constexpr int kMostLights = 96;

/// A sphere that contains everything that casts shadows. Keep it constant over a video, or the
/// shadows shimmer.
struct Sphere {
  Vec3f centre = Vec3f::Zero();
  float radius = 1;
};

}  // namespace taut
