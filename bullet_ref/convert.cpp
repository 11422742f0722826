#include "bullet_ref/convert.hpp"

#include <LinearMath/btTransform.h>

namespace taut {

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

Vec3 from_bullet(const btVector3& v) {
  return Eigen::Matrix<btScalar, 3, 1>(v.x(), v.y(), v.z()).cast<double>();
}

btTransform to_bullet(const Eigen::Quaterniond& rotation, const Vec3& origin) {
  const Eigen::Matrix3d m = rotation.toRotationMatrix();
  const auto at = [&](int i, int j) { return static_cast<btScalar>(m(i, j)); };
  const btMatrix3x3 basis(at(0, 0), at(0, 1), at(0, 2), at(1, 0), at(1, 1), at(1, 2), at(2, 0),
                          at(2, 1), at(2, 2));
  return btTransform(basis, to_bullet(origin));
}

}  // namespace taut
