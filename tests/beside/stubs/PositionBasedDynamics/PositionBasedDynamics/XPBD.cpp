#include "XPBD.h"

bool PBD::XPBD::solve_DistanceConstraint(const Vector3r& a, Real w_a, const Vector3r& b, Real w_b,
                                         Real, Real, Real, Real&, Vector3r& move_a,
                                         Vector3r& move_b) {
  move_a = 1e-9f * w_a * (b - a);
  move_b = 1e-9f * w_b * (a - b);
  return true;
}
