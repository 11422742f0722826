#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/model/bending.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/springs.hpp"

namespace taut {

/// The linear system of solvers that place all vertices at once from a wanted vector q [m] for each
/// link, with weights k [N/m]: x minimises
///
///     sum m/(2 h^2) |x - y|^2 + sum k/2 |(x_b - x_a) - q|^2 + bending,     pins where they are.
///
/// It is solved for x - y, with k (q - (y_b - y_a)) on the right-hand side: rounding in stiff
/// links, however stiff, is a force between their ends, which moves no centre of mass.
///
/// Its matrix, M/h^2 + sum k (e_b - e_a)(e_b - e_a)^T + sum k c c^T of the bending elements
/// (core/model/bending.hpp) over the vertices that move, is the same for
/// the three coordinates and from step to step: a sparse LLT, factored when made and again only if
/// h changes. Other pins, masses, links or weights are another system.
///
/// In contact x is the minimum outside of the colliders, with friction: what a force at a vertex
/// moves others by is a column of the inverse, solved for when the vertex first touches anything,
/// and the forces are those of CoupledContacts, from those of the last iteration on.
class GlobalSystem {
 public:
  /// Of what a solver is made; the springs' stiffness is the weight.
  GlobalSystem(const loop::Setup&, std::vector<Spring>);
  ~GlobalSystem();

  const std::vector<Spring>& springs() const { return springs_; }
  const std::vector<BendingElement>& bending() const { return bending_; }
  void restart();  ///< no force of contact
  /// The substep [t, t + h] begins: p.x is y, pins are where they have to be.
  void begin(const Particles<double>& p, double t, double h);
  /// Moves the vertices that are no pins. q: [springs] m. Places are NaN, which ends a case as
  /// exploded, if in double precision the matrix is not positive definite.
  void solve(std::span<const Vec3> q, Particles<double>& p);

  std::size_t factor_entries() const;
  /// One application: the vectors of the links, named `local`, and the solution by the factor.
  std::vector<PassCost> cost(std::string_view local, std::size_t bytes_of_local) const;

 private:
  void factor(double h);
  void resolve_contacts(Particles<double>& p);
  struct Factor;
  std::vector<Spring> springs_;
  std::vector<BendingElement> bending_;
  std::vector<int> row_;                  ///< of each vertex; -1: a pin
  std::vector<double> mass_;              ///< [rows] kg
  std::vector<Vec3> y_;                   ///< m, of this substep
  double factored_for_ = 0;               ///< s
  std::unique_ptr<Contacts> contacts_;    ///< null: none
  std::vector<TouchingVertex> touching_;  ///< of this iteration
  std::unique_ptr<Factor> factor_;
};

inline std::vector<Vec3> positions(const Particles<double>& p) {
  std::vector<Vec3> x(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) x[i] = p.x[i];
  return x;
}

}  // namespace taut
