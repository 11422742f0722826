#pragma once

#include <vector>

#include "experiments/render/opengl/render_mesh.hpp"

namespace taut {

/// A distant light.
struct Light {
  Vec3f direction = Vec3f::UnitY();  ///< unit, towards the light
  float weight = 0;
};

/// A fixed set of distant lights that together light a scene softly: a third of them a key disc
/// from the camera's left, a sixth a broad fill from its right, half a sky dome. Shadows come out
/// soft, corners dark, without noise and the same in every frame. Precondition: count >= 6.
std::vector<Light> light_set(int count, const Vec3f& up, const Camera&);

/// Light that reaches the ground, in units of open ground.
struct GroundLight {
  Vec3f origin = Vec3f::Zero();  ///< a point of the ground, the map's centre
  Vec3f u = Vec3f::UnitX(), v = Vec3f::UnitZ(), up = Vec3f::UnitY();  ///< unit, right-angled
  float half_side = 1;                                                ///< m
  int size = 0;
  std::vector<float> light;  ///< [size x size]; 1: open
};

/// How finely light is computed.
struct LightQuality {
  int lights = 32;
  int depth_map = 384;   ///< texels along a side, one map per light
  int ground_map = 160;  ///< texels along a side
};

/// Computes `front` and `back` of every mesh, and the ground's map: for each light a depth map of
/// all meshes, then visibility times cosine at each vertex, twice smoothed. On the CPU: at these
/// sizes a depth map takes less time to draw here than to read back from OpenGL. What lies outside
/// the sphere casts no shadow; a sphere that stays the same over a video makes shadows that do not
/// shimmer.
struct Sphere {
  Vec3f centre = Vec3f::Zero();
  float radius = 1;
};
void bake_light(const std::vector<Light>&, const LightQuality&, const Sphere& casters,
                std::vector<RenderMesh>&, GroundLight&);

}  // namespace taut
