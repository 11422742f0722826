#pragma once

#include <vector>

#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/newton/hessian.hpp"
#include "core/solver/springs.hpp"

namespace taut::solver::implicit {

/// G of one step (core/solver/implicit.cpp): inertia, springs, bending, membrane and contact. x:
/// [n] m. Gradients [N] and displacements [m] have three numbers for each vertex that moves, at
/// hessian.column().
struct StepEnergy {
  /// factored: solves H by a factor, otherwise by conjugate gradients.
  StepEnergy(const loop::Setup&, bool factored);
  StepEnergy(const StepEnergy&) = delete;  // the Hessian refers to springs and bending

  double energy(const std::vector<Vec3>& x, double h) const;  ///< J
  Vector gradient(const std::vector<Vec3>& x, double h) const;
  /// The gradient's part of links, bending, membrane and contact.
  Vector elastic(const std::vector<Vec3>& x) const;
  /// |g| in the norm of 1/M [N/sqrt(kg)].
  double in_norm_of_masses(const Vector& g) const;
  /// Sets the Hessian to that at x. clamped: compressed links and membranes do not push sideways,
  /// so that it is positive definite.
  void linearise(const std::vector<Vec3>& x, bool clamped);
  /// y - x of the vertices that move [m].
  Vector way_to_y(const std::vector<Vec3>& x) const;
  /// x + step * direction.
  std::vector<Vec3> moved(std::vector<Vec3> x, const Vector& direction, double step) const;

  std::vector<Spring> springs;
  DampedSprings damped;  ///< of springs
  std::vector<BendingElement> bending;
  MembraneModel membrane;
  Hessian hessian;
  std::vector<double> stiffness;  ///< N/m, sum over links, bending and membrane at each vertex
  AugmentedContacts contacts;
  Points<double> y;  ///< m, positions without links
};

}  // namespace taut::solver::implicit
