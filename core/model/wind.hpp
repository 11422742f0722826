#pragma once

#include "core/model/scene.hpp"

namespace taut {

/// Force of the wind on each corner of a face [N], by Vasilovici's law (section 3): F = c (n . d) n
/// with the unit normal n, scaled by the face's area; every corner takes a third. Positions xa, xb,
/// xc [m]; face_velocity [m/s] is the mean of the corners' velocities, which the literal law
/// ignores. A face without area feels nothing. All solvers use this function.
inline Vec3 wind_on_corner(const Wind& wind, const Vec3& xa, const Vec3& xb, const Vec3& xc,
                           const Vec3& face_velocity) {
  const Vec3 twice_area = (xb - xa).cross(xc - xa);
  const double norm = twice_area.norm();
  if (norm == 0) return Vec3::Zero();
  const bool relative = wind.law == Wind::Law::relative;
  const Vec3 d = relative ? Vec3(wind.velocity - face_velocity) : wind.velocity;
  return wind.strength * twice_area.dot(d) / (6 * norm) * twice_area;
}

}  // namespace taut
