#pragma once
#include "Common/Common.h"

namespace PBD {
struct XPBD {
  static bool solve_DistanceConstraint(const Vector3r& a, Real w_a, const Vector3r& b, Real w_b,
                                       Real rest, Real stiffness, Real dt, Real& lambda,
                                       Vector3r& move_a, Vector3r& move_b);
};
}  // namespace PBD
