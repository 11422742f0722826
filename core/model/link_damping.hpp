#pragma once

#include "core/model/scene.hpp"

namespace taut {

/// Damping of links in proportion to their stiffness (`links.damping`, b [s]): the force b K dn/dt
/// along a link of length n, by backward Euler over a step of h. With n_t the length at its start,
///
///     K/2 (n - r)^2 + b K/(2 h) (n - n_t)^2 = K (1 + q)/2 (n - r')^2 + what n does not change,
///     q = b/h,   r' = r + q/(1 + q) (n_t - r)
///
/// so that a damped link is, for one step, a link of another stiffness and rest length. A rigid
/// link has no damping: b K is nothing that it could take.
class LinkDamping {
 public:
  LinkDamping(const Scene& scene, double h)
      : q_(scene.link_damping > 0 ? scene.link_damping / h : 0) {}

  bool on() const { return q_ > 0; }
  double stiffer() const { return 1 + q_; }  ///< by what K is multiplied
  double share() const { return q_ / (1 + q_); }
  /// r' [m]. own: r; before: n_t.
  double rest(double own, double before) const { return own + share() * (before - own); }

 private:
  double q_;  ///< b/h
};

}  // namespace taut
