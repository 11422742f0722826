#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Motion of a cloth of springs in steps so short that they resolve every spring: leapfrog, in
/// double, one vertex after the other. No solver of the testbed takes part.
///
/// A vertex that ends a step nearer to a body than the thickness is put back along the normal by
/// its depth d; its displacement along the surface, relative to the body, then loses at most mu d.
/// With masses in the vertices this is the exact law of Signorini and Coulomb for the step, without
/// any iteration (Moreau, Unilateral Contact and Dry Friction in Finite Freedom Dynamics, 1988).
class Springs {
 public:
  /// Links that are rigid in the scene have the stiffness `rigid` [N/m]. Precondition:
  /// refuse_springs(scene) is empty, and dt [s] <= longest_step().
  Springs(const Scene&, double rigid, double dt);
  ~Springs();

  void step();
  State state() const;  ///< x [m]; v [m/s] at the same time, order 2 between contacts
  double time() const;  ///< s

  /// A step of 1/64 s halved until it is at most half of the longest stable one [s].
  static double longest_step(const Scene&, double rigid);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reasons, one sentence each, why Springs cannot run the scene; empty: it can.
std::vector<std::string> refuse_springs(const Scene&);

/// The position outside of all bodies at time t [s], at the cloth's thickness, that is reached from
/// x by going along their normals.
Vec3 pushed_out(const Scene&, const Vec3& x, double t);

}  // namespace taut::reference
