#pragma once

#include <string>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/membrane.hpp"
#include "core/model/scene.hpp"
#include "core/reference/rigid_relations.hpp"

namespace taut::reference {

/// A step of implicit Euler from a state, written as a minimisation:
///
///     y = x_t + h exp(-damping h) v_t + h^2 (g + wind)
///     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2 + membrane
///
/// over the vertices that move, with C = |x_b - x_a| - rest. Damped links have the K and the rest
/// lengths of this step (core/model/link_damping.hpp). With rigid links: the positions with
/// C = 0 that are nearest to y in the norm of G's first sum. Vertices stay at least the scene's
/// thickness away from the colliders at the end of the step. Contact pushes along the normal where
/// there is no gap. Coulomb friction acts across the normal with at most mu times that push, and
/// opposes slip where it reaches this limit. Self-collision is left out.
class ImplicitStep {
 public:
  /// The step from state `from` at time t [s] to t + scene.dt.
  ImplicitStep(const Scene&, const State& from, double t, const Stiffness&);

  bool rigid() const { return rigid_; }                    ///< some links are rigid
  bool in_contact() const { return !colliders_.empty(); }  ///< the scene has colliders
  const std::vector<Vec3>& prediction() const { return y_; }
  double energy(const std::vector<Vec3>& x) const;    ///< G [J], elastic links only
  double residual(const std::vector<Vec3>& x) const;  ///< |gradient of G| [N], elastic links only
  double stretch(const std::vector<Vec3>& x) const;   ///< root mean square of C [m]
  double distance(const std::vector<Vec3>& x, const std::vector<Vec3>& to) const;  ///< RMS [m]
  /// Mean square of the distance, weighted by mass [m^2].
  double square_distance(const std::vector<Vec3>& x, const std::vector<Vec3>& to) const;

  struct Minimum {
    std::vector<Vec3> x;          ///< m
    double residual = 0;          ///< N, |gradient| of G with the rigid links' multipliers
    double stretch = 0;           ///< m, largest |C| of rigid links
    double moved = 0;             ///< m, RMS displacement of x by the last round of multipliers
    Vec3 contact = Vec3::Zero();  ///< N, sum of the colliders' forces on the cloth
    std::string problem;          ///< why x is not a minimum; "": it is one
  };
  /// Finds the minimum by Newton's method with line search and sparse LDLT, inside an augmented
  /// Lagrangian for rigid links and contact. Four vertices in a plane, or three on a line, that are
  /// all rigidly linked stay so. These linear relations are eliminated (rigid_relations.hpp),
  /// because links alone resist leaving the plane at second order only, without finite multipliers.
  /// The minimum is the one to which `start` leads; where links are compressed there may be others.
  Minimum minimum(const std::vector<Vec3>& start) const;

 private:
  struct Multiplied;  // core/reference/multiplied_step.hpp
  struct Newton;
  struct Member {
    std::size_t a, b;
    double rest, stiffness;
  };
  struct Obstacle {
    taut::Shape shape;  ///< at the end of the step
    double friction;
    std::vector<Vec3> from;  ///< [n] m, position of each vertex if it moved with the collider
  };
  std::vector<Obstacle> colliders_;
  double thickness_ = 0;  ///< m
  std::vector<Member> links_;
  MembraneModel membrane_;
  std::vector<double> inertia_;  ///< m/h^2 [kg/s^2]; 0: a pin
  std::vector<double> mass_;
  std::vector<Vec3> y_;
  bool rigid_ = false;
  std::vector<Weights> of_others_;  ///< see rigid_relations()
};

}  // namespace taut::reference
