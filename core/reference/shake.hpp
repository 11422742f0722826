#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Converged motion of a cloth of rods and springs at chosen times.
struct Trajectory {
  bool unique = false;  ///< false: no truth; only `reason` has a meaning
  std::string reason;
  std::string derivation;
  double dt = 0;              ///< s, longest of the steps from which it was computed
  std::vector<State> states;  ///< at each requested time
  std::vector<double> floor;  ///< [times] m, largest vertex error, from self-convergence
};

/// Reasons, one sentence each, why the motion of this scene has no unique limit dt -> 0; empty: it
/// has one.
std::vector<std::string> refuse_dynamic(const Scene&);

/// Advances a scene in double by SHAKE (Ryckaert, Ciccotti, Berendsen 1977): Verlet, then
/// corrections along the directions of the rigid links at the step's start until each has its
/// length. J M^-1 J^T is factored once per step (sparse LDLT); chord Newton iterates to rounding.
/// Elastic links and bending are forces at the step's start; a scene without rigid links is Verlet
/// alone. Damping and wind use centred velocities, so the whole has order 2 in dt.
class Shake {
 public:
  /// dt [s] < sqrt(2 l/(n^2 g)) for n rigid links of length l in line, and < 2/fastest_vibration().
  Shake(const Scene&, double dt);
  ~Shake();

  /// Returns false if the projection did not converge (dt too long, or a slack start).
  bool step();
  State state() const;  ///< x [m]; v [m/s], centred: order 2
  double time() const;  ///< s

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Upper bound [rad/s] of the vibrations of elastic links and bending (Gershgorin); 0 without any.
double fastest_vibration(const Scene&);

/// States at `times` [s, ascending, > 0], each a multiple of dt, Richardson-extrapolated from dt
/// and dt/2. The floor is the distance between the results of dt and dt/2 and of dt/2 and dt/4.
/// Where springs vibrate fast, dt is halved until it is at most half a radian of the fastest
/// vibration. A rigid sheet with shear links that hangs by its first row and starts with straight
/// rows is computed as one column.
Trajectory converged_motion(const Scene&, const std::vector<double>& times, double dt);

}  // namespace taut::reference
