#pragma once

#include <string_view>

#include "core/model/collider.hpp"

class btVector3;
class btTransform;

namespace taut {

/// The scalar type of the Bullet library that this copy of the code is compiled for.
#ifdef BT_USE_DOUBLE_PRECISION
inline constexpr bool kBulletIsDouble = true;
#else
inline constexpr bool kBulletIsDouble = false;
#endif
inline constexpr std::string_view kBulletPrecision = kBulletIsDouble ? "double" : "float";

btVector3 to_bullet(const Vec3&);
Vec3 from_bullet(const btVector3&);
btTransform to_bullet(const Eigen::Quaterniond& rotation, const Vec3& origin);

}  // namespace taut
