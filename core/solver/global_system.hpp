#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/layout/vertex_groups.hpp"
#include "core/solver/panel_factor.hpp"
#include "core/solver/springs.hpp"

namespace taut {

/// The linear system of solvers that place all vertices at once, given a target vector q [m] and a
/// weight k [N/m] for each link. x minimises
///
///     sum m/(2 h^2) |x - y|^2 + sum k/2 |(x_b - x_a) - q|^2 + bending + sum A Y/2 |F - R|^2,
///
/// with pins where they are and R the rotation nearest to F at the current x, in each triangle of a
/// membrane with law = "arap".
///
/// The unknown is the displacement from the current x, and the right-hand side is minus the
/// gradient of this energy there. Rounding in stiff links is then a force between their ends, which
/// moves no centre of mass, and it shrinks as x approaches the solution.
///
/// The matrix, M/h^2 + sum k (e_b - e_a)(e_b - e_a)^T + sum k c c^T of the bending elements
/// (core/model/bending.hpp) + sum A Y g_a . g_b of the membrane (core/model/membrane.hpp) over the
/// vertices that move, is the same for the three coordinates and from step to step. Its sparse
/// factor is made with the system, and again only if h changes. Other pins, masses, links or
/// weights need another system. The factor and the solution are in double whatever Real is: stiff
/// links lose more digits than a float has.
///
/// Particles are stored in the order of elimination. Links are computed in lanes and divided among
/// threads; bending, membrane, contact and the solution run on one thread.
///
/// In contact, x is the minimum outside the colliders, with friction. The displacements per force
/// at a vertex are a column of the inverse, which is solved for when the vertex first touches
/// anything. The contact forces are those of CoupledContacts, warm-started from the last iteration.
template <class Real>
class GlobalSystem {
 public:
  /// Makes the system from a solver's setup; the springs' stiffness is the weight.
  GlobalSystem(const loop::Setup&, std::vector<Spring>);
  ~GlobalSystem();

  const std::vector<Spring>& springs() const { return springs_; }
  /// Rest lengths may change from substep to substep.
  std::vector<Spring>& springs() { return springs_; }
  const std::vector<BendingElement>& bending() const { return bending_; }
  const MembraneModel& membrane() const { return membrane_; }
  const VertexGroups& groups() const { return groups_; }
  const Layout& layout() const { return groups_.layout(); }
  /// Like VertexGroups::make_slots, with rest length and stiffness of the springs filled in.
  template <class Slot, class Set>
  std::vector<Slot> make_slots(const Set& set) const {
    return slots_of_springs<Slot>(groups_, ends_, springs_, set);
  }

  void restart();                              ///< forgets the contact forces
  void take_over(const GlobalSystem& before);  ///< keeps the contact forces
  /// Begins the substep [t, t + h]: p.x is y, pins are at their positions at t + h.
  void begin(const Particles<Real>& p, double t, double h);
  Points<Real>& target() { return y_; }  ///< Pass::target
  TouchingPieces* touching_pieces();     ///< Pass::touching_pieces
  const Points<Real>& target() const { return y_; }
  /// Moves all vertices but the pins. forces(sweep, begin, end) computes groups [begin, end), where
  /// each link pulls with k (d - q). If the matrix is not positive definite in double precision,
  /// positions become NaN, which ends a case as exploded.
  template <class Forces>
  void solve(Particles<Real>& p, const Forces& forces) {
    sweep(p, forces);
    solve_rows(p);
  }

  // Parts of solve(), without contact, for solvers that do not step straight to the solution.
  // Vectors have four numbers in each row, the last of them 0.

  std::size_t rows() const { return mass_.size(); }
  int row(std::size_t vertex) const { return row_[vertex]; }  ///< -1: a pin
  /// Writes minus the gradient of the energy at p.x [N] into `out`.
  template <class Forces>
  void find_forces(const Particles<Real>& p, const Forces& forces, std::span<double> out) {
    sweep(p, forces);
    add_surface(p);
    std::copy_n(rows_.data(), out.size(), out.begin());
  }
  /// Replaces forces [N] by the displacements [m] that they cause; NaN if there is no factor.
  void solve_forces(std::span<double> forces);

  /// Cost of one application: the links' vectors, named `local`, and the solution by the factor.
  std::vector<PassCost> cost(std::string_view local, std::size_t bytes_of_local) const;

 private:
  template <class Forces>
  void sweep(const Particles<Real>& p, const Forces& forces) {
    const ForceSweep<Real> sweep{.groups = groups_.data(),
                                 .x = p.x.data(),
                                 .y = y_.data(),
                                 .inertia = inertia_.data(),
                                 .rows = rows_.data()};
    pool_.run(
        groups_.size(), [&](std::size_t begin, std::size_t end) { forces(sweep, begin, end); },
        groups_.size() * kLanes >= ThreadPool::kWorthSharing / 4);
  }
  void add_surface(const Particles<Real>& p);
  void factor(double h);
  void solve_rows(Particles<Real>& p);
  void move(Particles<Real>& p);
  void resolve_contacts(Particles<Real>& p);
  struct Contact;
  std::vector<Spring> springs_;
  std::vector<BendingElement> bending_;
  MembraneModel membrane_;
  Adjacency ends_;
  PanelFactor factor_;
  VertexGroups groups_;
  std::vector<int> row_;              ///< of each vertex; -1: a pin
  std::vector<double> mass_;          ///< [rows] kg
  std::vector<Real> inertia_;         ///< [groups][kLanes] m/h^2 [N/m]
  Points<Real> y_;                    ///< m, positions without links in this substep
  Points<double> rows_;               ///< forces [N], replaced by displacements [m]
  double factored_for_ = 0;           ///< s, the substep for which it was factored
  bool positive_ = false;             ///< the matrix has a factor
  std::unique_ptr<Contact> contact_;  ///< null: no contact
  ThreadPool& pool_;
};

inline constexpr ParamSpec kGlobalPrecision =
    ParamSpec::choice("precision", "double", "float|double",
                      "scalar type of the simulation; the linear system is always in double")
        .as(ParamSpec::Role::precision);

template <class Real>
std::vector<Vec3> positions(const Particles<Real>& p) {
  std::vector<Vec3> x(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) x[i] = p.x[i].template cast<double>();
  return x;
}

}  // namespace taut
