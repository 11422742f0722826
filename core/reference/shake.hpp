#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// A cloth of rods and springs in motion at chosen times, converged.
struct Trajectory {
  bool unique = false;  ///< false: no truth; nothing below but `reason` has a meaning
  std::string reason;
  std::string derivation;
  double dt = 0;              ///< s, the longest of the steps that it comes from
  std::vector<State> states;  ///< at each of the times asked for
  std::vector<double> floor;  ///< [times] m, largest vertex error, by self-convergence
};

/// Why the motion of this scene has no unique limit dt -> 0, one sentence each; empty: it has.
std::vector<std::string> refuse_dynamic(const Scene&);

/// Advances a scene in double by SHAKE (Ryckaert, Ciccotti, Berendsen 1977): Verlet, then
/// corrections along the directions of the rigid links at the step's start until each has its
/// length; J M^-1 J^T is factored once per step (sparse LDLT), chord Newton to rounding. Elastic
/// links and bending are forces of the step's start; a scene without rigid links is Verlet alone.
/// Damping and wind are taken with centred velocities, so the whole has order 2 in dt.
class Shake {
 public:
  /// dt [s], < sqrt(2 l/(n^2 g)) for n rigid links of length l in line, < 2/fastest_vibration().
  Shake(const Scene&, double dt);
  ~Shake();

  bool step();          ///< false: the projection did not converge (dt too long, or a slack start)
  State state() const;  ///< x [m]; v [m/s], centred: order 2
  double time() const;  ///< s

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// No vibration of elastic links and bending is faster [rad/s] (Gershgorin); 0: there are none.
double fastest_vibration(const Scene&);

/// States at `times` [s, ascending, > 0], each a multiple of dt: Richardson-extrapolated from dt
/// and dt/2. The floor is the distance between that and the same from dt/2 and dt/4. Where springs
/// vibrate faster, dt is halved until half a radian of the fastest vibration takes longer. A rigid
/// sheet with shear links that hangs by its first row and starts with straight rows is computed as
/// one column.
Trajectory converged_motion(const Scene&, const std::vector<double>& times, double dt);

}  // namespace taut::reference
