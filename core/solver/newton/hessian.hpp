#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "core/model/bending.hpp"
#include "core/solver/panel_factor.hpp"
#include "core/solver/spring.hpp"

namespace taut::solver::implicit {

using Vector = Eigen::VectorXd;

/// Hessian of one spring: isotropic I + axial u u^T [N/m].
struct SpringHessian {
  double isotropic = 0, axial = 0;
  Vec3 u = Vec3::UnitX();
  Eigen::Matrix3d matrix() const {
    return isotropic * Eigen::Matrix3d::Identity() + axial * u * u.transpose();
  }
  Vec3 times(const Vec3& v) const { return isotropic * v + axial * u.dot(v) * u; }
};

/// H = M/h^2 + springs + bending + membrane + contact, over the vertices that move. Vectors have
/// three numbers for each of them. Linear systems are solved by a sparse LDLT, whose pattern is
/// analysed once, or by conjugate gradients with a block Jacobi preconditioner.
class Hessian {
 public:
  /// Springs and bending must outlive it. w: inverse masses [1/kg]. beside: pairs of vertices
  /// between which add_contact() and add_membrane() may add a block, besides those of springs and
  /// bending.
  Hessian(const std::vector<Spring>& springs, const std::vector<BendingElement>& bending,
          std::span<const double> w, bool factored, Simd simd,
          std::span<const std::pair<int, int>> beside = {});

  int size() const { return 3 * static_cast<int>(mass_.size()); }
  /// First entry of the vertex in vectors; kPinned: it does not move.
  int column(std::size_t vertex) const { return column_[vertex]; }
  double mass(std::size_t vertex) const { return mass_[to_index(column_[vertex]) / 3]; }
  SpringHessian& block(std::size_t spring) { return blocks_[spring]; }
  void clear_membrane() { stretched_.clear(); }
  /// Adds a block of the membrane [N/m], minus d force_a/d x_b, and its transpose for b and a.
  void add_membrane(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    stretched_.push_back({a, b, block});
  }
  void clear_contacts() { contacts_.clear(); }
  /// Adds a block of contact [N/m] at a vertex that moves.
  void add_contact(std::size_t vertex, const Eigen::Matrix3d& block) {
    add_contact(vertex, vertex, block);
  }
  /// Adds a block of contact [N/m] between two vertices, for both of them.
  void add_contact(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    contacts_.push_back({a, b, block});
  }
  bool factored() const { return !diagonal_.empty(); }
  static constexpr int kPinned = -1;

  /// Solves H p = right [N] for p [m]. Returns false if H is not positive definite.
  bool solve(double h, const Vector& right, Vector& p);

  /// H v without the masses; pins do not move.
  Vector elastic_times(const Vector& v) const {
    return elastic_times(v, [](std::size_t) { return Vec3(Vec3::Zero()); });
  }
  /// H v without the masses; pin(vertex) is the displacement of a pin [m].
  template <class Pin>
  Vector elastic_times(const Vector& v, const Pin& pin) const {
    Vector out = Vector::Zero(v.size());
    const auto at = [&](std::size_t vertex) -> Vec3 {
      return column_[vertex] < 0 ? pin(vertex) : Vec3(v.segment<3>(column_[vertex]));
    };
    for (std::size_t j = 0; j < springs_.size(); ++j) {
      const auto& [a, b, rest, stiffness] = springs_[j];
      const Vec3 pull = blocks_[j].times(at(b) - at(a));
      if (column_[a] >= 0) out.segment<3>(column_[a]) -= pull;
      if (column_[b] >= 0) out.segment<3>(column_[b]) += pull;
    }
    for (const BendingElement& e : bending_) {
      const Vec3 pull = e.stiffness * e.value(at);
      for (std::size_t i = 0; i < e.size; ++i)
        if (const int c = column_[to_index(e.vertex[i])]; c >= 0)
          out.segment<3>(c) += e.weight[i] * pull;
    }
    for (const auto& [a, b, block] : stretched_) {
      if (column_[a] >= 0) out.segment<3>(column_[a]) += block * at(b);
      if (a != b && column_[b] >= 0) out.segment<3>(column_[b]) += block.transpose() * at(a);
    }
    for (const auto& [a, b, block] : contacts_) {
      if (column_[a] >= 0) out.segment<3>(column_[a]) += block * at(b);
      if (a != b && column_[b] >= 0) out.segment<3>(column_[b]) += block * at(a);
    }
    return out;
  }

  std::size_t factor_entries() const { return factor_.entries(); }
  std::size_t bytes() const;

 private:
  /// A block of 3 x 3 numbers in the matrix; null: one end is pinned.
  struct Block {
    double* first = nullptr;
    std::size_t stride = 0;
    double& operator()(int r, int c) const { return first[to_index(r) * stride + to_index(c)]; }
  };

  struct PairBlock {
    std::size_t a, b;  ///< vertices
    Eigen::Matrix3d block;
  };

  void analyse(Simd simd, std::span<const std::pair<int, int>> beside);
  /// The block of two vertices that move, in either order. Precondition: the matrix has it.
  Block place(int column, int other);
  template <class Add>
  void each_bending(const Add& add) const;
  void add_diagonal(int column, const Eigen::Matrix3d& block);
  void fill(double h);
  Vector times(double h, const Vector& v) const;
  bool conjugate_gradients(double h, const Vector& right, Vector& p) const;

  const std::vector<Spring>& springs_;
  const std::vector<BendingElement>& bending_;
  std::vector<int> column_;
  std::vector<double> mass_;  ///< kg, of the vertices that move
  std::vector<SpringHessian> blocks_;
  std::vector<PairBlock> stretched_, contacts_;
  PanelFactor factor_;                          ///< empty: conjugate gradients
  std::vector<Block> diagonal_;                 ///< [vertices that move]
  std::vector<Block> beside_;                   ///< [springs]
  std::vector<std::pair<Block, double>> bent_;  ///< bending [N/m] in each block, times the identity
  std::vector<std::size_t> rank_;  ///< [vertices that move] in the order of elimination
  Vector in_order_;                ///< right-hand side, then solution, in that order
};

}  // namespace taut::solver::implicit
