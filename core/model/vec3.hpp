#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace taut {

/// A point, direction or velocity in world space; right-handed, y up by convention of the shipped
/// scenes.
using Vec3 = Eigen::Vector3d;

}  // namespace taut
