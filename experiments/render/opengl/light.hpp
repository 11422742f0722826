#pragma once

#include <vector>

#include "experiments/render/opengl/camera.hpp"

namespace taut {

/// A distant light.
struct Light {
  Vec3f direction = Vec3f::UnitY();  ///< unit, towards the light
  float weight = 0;
};

/// A fixed set of distant lights that together light a scene softly: a third of them a key disc
/// from the camera's left, a sixth a broad fill from its right, half a sky dome. Shadows come out
/// soft, corners dark, without noise and the same in every frame. Precondition:
/// 6 <= count <= kMostLights.
std::vector<Light> light_set(int count, const Vec3f& up, const Camera&);

/// Where shadows fall beside the cloth, and where the ground's lines lie.
struct Ground {
  Vec3f origin = Vec3f::Zero();                                       ///< its centre
  Vec3f u = Vec3f::UnitX(), v = Vec3f::UnitZ(), up = Vec3f::UnitY();  ///< unit, right-angled
  float half_side = 1;                                                ///< m, of what is shaded
};

/// How finely light is computed.
struct LightQuality {
  int lights = 32;       ///< at most kMostLights
  int depth_map = 384;   ///< texels along a side, one map per light
  int ground_map = 160;  ///< texels along a side
};
inline constexpr int kMostLights = 96;

/// What casts shadows lies in it. One that stays the same over a video makes shadows that do not
/// shimmer.
struct Sphere {
  Vec3f centre = Vec3f::Zero();
  float radius = 1;
};

}  // namespace taut
