#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// One step of implicit Euler from a state, as the minimisation that it is:
///
///     y = x_t + h exp(-damping h) v_t + h^2 (g + wind),   G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2
///     C^2
///
/// over the vertices that move, C = |x_b - x_a| - rest. With rigid links: the nearest placement to
/// y in the norm of G's first sum with C = 0. Vertices keep the scene's thickness from colliders as
/// they are at the end of the step, with Coulomb friction: a force along the normal where there is
/// no gap, and across it at most mu times that, against the slip where it is as much.
/// Self-collision is left out.
class ImplicitStep {
 public:
  /// From `from` at time t [s] to t + scene.dt.
  ImplicitStep(const Scene&, const State& from, double t, const Stiffness&);

  bool rigid() const { return rigid_; }                    ///< some links are
  bool in_contact() const { return !colliders_.empty(); }  ///< the scene has colliders
  const std::vector<Vec3>& prediction() const { return y_; }
  double energy(const std::vector<Vec3>& x) const;    ///< G [J], of elastic links alone
  double residual(const std::vector<Vec3>& x) const;  ///< |gradient of G| [N], likewise
  double stretch(const std::vector<Vec3>& x) const;   ///< root mean square of C [m]
  double distance(const std::vector<Vec3>& x, const std::vector<Vec3>& to) const;  ///< RMS [m]
  /// Mean square of the distance, weighted by mass [m^2].
  double square_distance(const std::vector<Vec3>& x, const std::vector<Vec3>& to) const;

  struct Minimum {
    std::vector<Vec3> x;          ///< m
    double residual = 0;          ///< N, of G and of the rigid links' multipliers
    double stretch = 0;           ///< m, largest |C| of rigid links
    double moved = 0;             ///< m, RMS: how far the last round of multipliers still moved x
    Vec3 contact = Vec3::Zero();  ///< N, sum of the colliders' forces on the cloth
    std::string problem;          ///< why x is no minimum; "": it is one
  };
  /// Newton with line search, sparse LDLT; rigid links and contact by an augmented Lagrangian
  /// around it. Four vertices in a plane, or three on a line, all rigidly linked, stay so: such
  /// relations are linear, and eliminated. Their links alone resist leaving the plane at second
  /// order, without finite multipliers. The minimum that `start` leads to: where links are
  /// compressed there may be others.
  Minimum minimum(const std::vector<Vec3>& start) const;

 private:
  struct Multiplied;
  void find_implied(const Scene&, const Stiffness&);
  struct Member {
    std::size_t a, b;
    double rest, stiffness;
  };
  struct Obstacle {
    taut::Shape shape;  ///< at the end of the step
    double friction;
    std::vector<Vec3> from;  ///< [n] m, where each vertex would be if it moved with the collider
  };
  std::vector<Obstacle> colliders_;
  double thickness_ = 0;  ///< m
  std::vector<Member> links_;
  std::vector<double> inertia_;  ///< m/h^2 [kg/s^2]; 0: a pin
  std::vector<double> mass_;
  std::vector<Vec3> y_;
  bool rigid_ = false;
  /// [n] x of each vertex as a sum of weights times x of others, which have themselves alone;
  /// empty: of all. Rigid links say it at second order only: four in a plane, three on a line.
  std::vector<std::map<std::size_t, double>> of_others_;
};

}  // namespace taut::reference
