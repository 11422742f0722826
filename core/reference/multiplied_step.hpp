#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/reference/implicit_step.hpp"

namespace taut::reference {

using Points = std::vector<Vec3>;

/// Initial K of rigid links, as a multiple of the largest m/h^2.
inline constexpr double kHardness = 1e4;

/// G with rigid links as springs K that a multiplier l [N] shifts: l C + K/2 C^2. Contact is an
/// augmented Lagrangian, too, with forces and tangent planes that are updated in rounds.
struct ImplicitStep::Multiplied {
  const ImplicitStep& step;
  std::vector<double> stiffness, multiplier;
  std::vector<Eigen::Index> column;  ///< of each vertex in gradients; -1: a pin
  Eigen::Index size = 0;
  /// Forces [N] of collider k on vertex i, [i][k], that shift its part of the energy.
  struct Touch {
    double push = 0, bound = 0;
    Vec3 rub = Vec3::Zero();
  };
  std::vector<Touch> touches = {};
  /// Tangent plane of collider k at its point nearest to vertex i, [i][k]. It is fixed while G is
  /// minimised: with planes that turn, the gradient would not be that of an energy.
  struct TangentPlane {
    Vec3 normal = Vec3::Zero();
    double offset = 0;  ///< m, at the scene's thickness above the surface
  };
  std::vector<TangentPlane> planes = {};
  double hardness = 0;  ///< N/m, stiffness of contact

  /// rigid: K of rigid links [N/m].
  Multiplied(const ImplicitStep&, double rigid);
  /// Sets K of rigid links [N/m] from now on.
  void harden(double rigid);
  double stretch(const Points& x, std::size_t j) const {
    const auto& [a, b, rest, k] = step.links_[j];
    return (x[b] - x[a]).norm() - rest;
  }
  double energy(const Points& x) const;             ///< J
  Eigen::VectorXd gradient(const Points& x) const;  ///< N, indexed by `column`
  Vec3 contact_force(const Points& x) const;        ///< N
  void lay_planes(const Points& x);                 ///< sets the tangent planes to those at x
  /// Sets planes and forces to those at x. Returns how far x is from the conditions of contact [m].
  double update_contact(const Points& x);

  /// Effect of a collider on a vertex: energy, force and Hessian of the push (push - k gap)+ and of
  /// the friction rub - k slip, which is no longer than the bound.
  struct Held {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    double push = 0;
    Vec3 rub = Vec3::Zero();
    double gap = 0, slip = 0;  ///< m; slip: what friction has to take back
  };
  Held held(std::size_t i, std::size_t k, const Vec3& x) const {
    const Obstacle& obstacle = step.colliders_[k];
    const Touch& touch = touches[i * step.colliders_.size() + k];
    const TangentPlane& at = planes[i * step.colliders_.size() + k];
    Held out;
    out.gap = at.normal.dot(x) - at.offset;
    out.push = touch.push - hardness * out.gap;
    if (out.push <= 0) return {.gap = out.gap};
    const Eigen::Matrix3d along = at.normal * at.normal.transpose(),
                          across = Eigen::Matrix3d::Identity() - along;
    out.energy = out.push * out.push / (2 * hardness);
    out.force = out.push * at.normal;
    out.hessian = hardness * along;
    const Vec3 slip = across * (x - obstacle.from[i]);
    out.rub = across * touch.rub - hardness * slip;
    const double length = out.rub.norm();
    if (touch.bound == 0) {
      out.rub.setZero();
    } else if (length <= touch.bound) {
      out.slip = slip.norm();
      out.energy += length * length / (2 * hardness);
      out.hessian += hardness * across;
    } else {
      const Vec3 u = out.rub / length;
      out.energy += touch.bound / hardness * (length - touch.bound / 2);
      out.hessian += hardness * touch.bound / length * (across - u * u.transpose());
      out.rub = touch.bound * u;
    }
    out.force += out.rub;
    return out;
  }
  /// Calls visit(i, k, effect of collider k on vertex i).
  template <class Visit>
  void each_held(const Points& x, const Visit& visit) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; column[i] >= 0 && k < step.colliders_.size(); ++k)
        visit(i, k, held(i, k, x[i]));
  }
  /// Calls add(row, column, block) for the Hessian's blocks of three rows and columns, in its lower
  /// triangle; on the diagonal each is symmetric. clamped: links that push add nothing across their
  /// direction, nor does the membrane.
  template <class Add>
  void each_block(const Points& x, bool clamped, const Add& add) const {
    for (std::size_t i = 0; i < x.size(); ++i)
      if (column[i] >= 0) add(column[i], column[i], step.inertia_[i] * Eigen::Matrix3d::Identity());
    for (std::size_t j = 0; j < stiffness.size(); ++j) {
      const auto& [a, b, rest, k] = step.links_[j];
      const double length = (x[b] - x[a]).norm();
      const Vec3 u = (x[b] - x[a]) / length;
      const double pull = multiplier[j] + stiffness[j] * (length - rest);
      const double across = clamped ? std::max(0.0, pull / length) : pull / length;
      const Eigen::Matrix3d along = u * u.transpose();
      const Eigen::Matrix3d part =
          stiffness[j] * along + across * (Eigen::Matrix3d::Identity() - along);
      for (const std::size_t v : {a, b})
        if (column[v] >= 0) add(column[v], column[v], part);
      if (column[a] >= 0 && column[b] >= 0)
        add(std::max(column[a], column[b]), std::min(column[a], column[b]), -part);
    }
    for (const MembraneElement& e : step.membrane_.elements)
      step.membrane_.add_second(
          e, [&](std::size_t v) { return x[v]; }, clamped,
          [&](std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
            const Eigen::Index row = column[a], col = column[b];
            if (row < 0 || col < 0) return;
            if (row >= col)
              add(row, col, block);
            else
              add(col, row, Eigen::Matrix3d(block.transpose()));
          });
    each_held(x, [&](std::size_t i, std::size_t, const Held& now) {
      if (now.push > 0) add(column[i], column[i], now.hessian);
    });
  }
};

}  // namespace taut::reference
