#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace taut {

/// A point, direction or velocity in world space, which is right-handed; y is up by convention of
/// the shipped scenes.
using Vec3 = Eigen::Vector3d;

}  // namespace taut
