#pragma once

#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

using Vec3f = Eigen::Vector3f;

/// Direction from which the scene is seen, relative to its up direction. Azimuth turns from +z
/// towards +x.
struct View {
  double azimuth = 32;      ///< degrees
  double elevation = 20;    ///< degrees, in (-90, 90)
  bool either_side = true;  ///< the azimuth may change its sign if that shows more of the cloth
};

/// "three-quarter" (the default), "front", "back", "left", "right", "top", or "AZIMUTH,ELEVATION"
/// in degrees; throws InputError.
View parse_view(const std::string&);

/// A perspective camera.
struct Camera {
  Vec3f eye = Vec3f::Zero(), right = Vec3f::UnitX(), up = Vec3f::UnitY(), back = Vec3f::UnitZ();
  float tan_half_height = 0.2f;  ///< tangent of half the vertical field of view
  float near_plane = 0.01f, far_plane = 100;

  /// Transform from world to clip space for a picture with this aspect ratio (width / height).
  Eigen::Matrix4f world_to_clip(float aspect) const;
};

/// Direction opposite to gravity; +y without gravity.
Vec3 up_direction(const Scene&);

/// The part of the picture that the points have to fill, in [-1, 1] with y upwards.
struct FitRegion {
  double left = -0.8, right = 0.8, bottom = -0.62, top = 0.8;
  /// Lower left corner of an inset, which hides points that are both right of and above it.
  double inset_left = 2, inset_bottom = 2;
  static FitRegion beside_inset() { return {-0.84, 0.66, -0.62, 0.78, 0.53, 0.39}; }
};

/// Places the camera so that the points just fill the region. If the inset would hide one of them,
/// the points go below or beside it, whichever shows them larger. Precondition: points not empty.
Camera fit_camera(const std::vector<Vec3>& points, const Vec3& up, const View&, double aspect,
                  const FitRegion&);

}  // namespace taut
