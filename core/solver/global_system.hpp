#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "core/model/bending.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/layout/vertex_groups.hpp"
#include "core/solver/panel_factor.hpp"
#include "core/solver/springs.hpp"

namespace taut {

/// The linear system of solvers that place all vertices at once from a wanted vector q [m] for each
/// link, with weights k [N/m]: x minimises
///
///     sum m/(2 h^2) |x - y|^2 + sum k/2 |(x_b - x_a) - q|^2 + bending,     pins where they are.
///
/// It is solved for the way from where x is, by the force that this energy leaves there, minus its
/// gradient: rounding in stiff links, however stiff, is a force between their ends, which moves no
/// centre of mass, and the nearer x is, the less there is to round.
///
/// Its matrix, M/h^2 + sum k (e_b - e_a)(e_b - e_a)^T + sum k c c^T of the bending elements
/// (core/model/bending.hpp) over the vertices that move, is the same for
/// the three coordinates and from step to step: a sparse factor, made when the system is and again
/// only if h changes. Other pins, masses, links or weights are another system. The factor and what
/// it solves are in double whatever Real is: stiff links make it lose more digits than a float has.
///
/// Particles lie in the order of elimination. Links are computed in lanes, which threads divide;
/// bending, contact and the solution itself are one thread's.
///
/// In contact x is the minimum outside of the colliders, with friction: what a force at a vertex
/// moves others by is a column of the inverse, solved for when the vertex first touches anything,
/// and the forces are those of CoupledContacts, from those of the last iteration on.
template <class Real>
class GlobalSystem {
 public:
  /// Of what a solver is made; the springs' stiffness is the weight.
  GlobalSystem(const loop::Setup&, std::vector<Spring>);
  ~GlobalSystem();

  const std::vector<Spring>& springs() const { return springs_; }
  const std::vector<BendingElement>& bending() const { return bending_; }
  const VertexGroups& groups() const { return groups_; }
  const Layout& layout() const { return groups_.layout(); }
  /// As VertexGroups::make_slots, with rest and stiffness of the springs.
  template <class Slot, class Set>
  std::vector<Slot> make_slots(const Set& set) const {
    return slots_of_springs<Slot>(groups_, ends_, springs_, set);
  }

  void restart();                              ///< no force of contact
  void take_over(const GlobalSystem& before);  ///< the forces of contact
  /// The substep [t, t + h] begins: p.x is y, pins are where they have to be.
  void begin(const Particles<Real>& p, double t, double h);
  Points<Real>& target() { return y_; }  ///< Pass::target
  TouchingPieces* touching_pieces();     ///< Pass::touching_pieces
  const Points<Real>& target() const { return y_; }
  /// Moves the vertices that are no pins. forces(sweep, begin, end): of groups [begin, end), where
  /// each link pulls with k (d - q). Places are NaN, which ends a case as exploded, if in double
  /// precision the matrix is not positive definite.
  template <class Forces>
  void solve(Particles<Real>& p, const Forces& forces) {
    sweep(p, forces);
    solve_rows(p);
  }

  // The same in its parts, without contact, for who goes another way than the solution's. Vectors
  // have four numbers in each row, the last of them 0.

  std::size_t rows() const { return mass_.size(); }
  int row(std::size_t vertex) const { return row_[vertex]; }  ///< -1: a pin
  /// Minus the gradient of the energy at p.x [N], into `out`.
  template <class Forces>
  void find_forces(const Particles<Real>& p, const Forces& forces, std::span<double> out) {
    sweep(p, forces);
    add_bending(p);
    std::copy_n(rows_.data(), out.size(), out.begin());
  }
  /// The way [m] of the solution for these forces [N]; NaN: there is no factor.
  void solve_forces(std::span<double> forces);

  /// One application: the vectors of the links, named `local`, and the solution by the factor.
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
  void add_bending(const Particles<Real>& p);
  void factor(double h);
  void solve_rows(Particles<Real>& p);
  void move(Particles<Real>& p);
  void resolve_contacts(Particles<Real>& p);
  struct Contact;
  std::vector<Spring> springs_;
  std::vector<BendingElement> bending_;
  Adjacency ends_;
  PanelFactor factor_;
  VertexGroups groups_;
  std::vector<int> row_;              ///< of each vertex; -1: a pin
  std::vector<double> mass_;          ///< [rows] kg
  std::vector<Real> inertia_;         ///< [groups][kLanes] m/h^2 [N/m]
  Points<Real> y_;                    ///< m, of this substep
  Points<double> rows_;               ///< N, then m
  double factored_for_ = 0;           ///< s
  bool positive_ = false;             ///< there is a factor
  std::unique_ptr<Contact> contact_;  ///< null: none
  ThreadPool& pool_;
};

inline constexpr ParamSpec kGlobalPrecision =
    ParamSpec::choice("precision", "double", "float|double",
                      "scalar type of the simulation; the linear system is always in double");

template <class Real>
std::vector<Vec3> positions(const Particles<Real>& p) {
  std::vector<Vec3> x(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) x[i] = p.x[i].template cast<double>();
  return x;
}

}  // namespace taut
