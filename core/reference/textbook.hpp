#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// TimeStep() of Jakobsen, Advanced Character Physics (GDC 2001), line by line, for particles of
/// any mass: an array of structures, the links as the scene lists them, the root and the divisions
/// where the listing has them. Every result and every speed of core/solver is compared with it. It
/// handles gravity, damping, links and pins at rest; nothing else.
template <class Real>
class Textbook {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;

  /// square_root: if false, uses the listing's projection without a root (simd/distance.hpp).
  Textbook(const Scene& scene, int iterations, bool square_root = true)
      : iterations_(iterations),
        square_root_(square_root),
        dt_(static_cast<Real>(scene.dt)),
        keep_(static_cast<Real>(std::exp(-scene.damping * scene.dt))),
        gravity_(scene.gravity.template cast<Real>()) {
    const std::vector<double> w = inverse_masses(scene);
    w_.assign(w.begin(), w.end());
    for (const Link& l : scene.links) {
      const auto a = static_cast<std::size_t>(l.a), b = static_cast<std::size_t>(l.b);
      if (w_[a] + w_[b] > 0) constraints_.push_back({a, b, static_cast<Real>(l.rest)});
    }
    load(scene.start);
  }

  void load(const State& state) {
    x_.clear();
    old_.clear();
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      x_.push_back(state.x[i].template cast<Real>());
      old_.push_back(x_[i] - dt_ * state.v[i].template cast<Real>());
    }
  }

  void step() {
    for (std::size_t i = 0; i < x_.size(); ++i) {  // Verlet
      const Point now = x_[i];
      if (w_[i] > 0) x_[i] += keep_ * (now - old_[i]) + gravity_ * dt_ * dt_;
      old_[i] = now;
    }
    lambda_.assign(constraints_.size(), 0);
    for (int k = 0; k < iterations_; ++k)  // SatisfyConstraints
      relax([this](std::size_t j, Real correction) { lambda_[j] += correction; });
  }

  /// Makes one pass over the constraints.
  void sweep() {
    relax([](std::size_t, Real) {});
  }

  const std::vector<Point>& x() const { return x_; }               ///< m
  std::size_t constraints() const { return constraints_.size(); }  ///< links that can move
  /// [constraints] kg m, of the last step: force times dt^2.
  const std::vector<Real>& lambda() const { return lambda_; }

 private:
  struct Constraint {
    std::size_t a, b;
    Real rest;
  };

  /// Corrects each constraint in turn and calls keep(j, correction of constraint j [kg m]).
  template <class Keep>
  void relax(const Keep& keep) {
    square_root_ ? relax<true>(keep) : relax<false>(keep);
  }
  template <bool square_root, class Keep>
  void relax(const Keep& keep) {
    for (std::size_t j = 0; j < constraints_.size(); ++j) {
      const Constraint& c = constraints_[j];
      Point &x1 = x_[c.a], &x2 = x_[c.b];
      const Real w1 = w_[c.a], w2 = w_[c.b];
      const Point delta = x2 - x1;
      Real diff;
      if constexpr (square_root) {
        const Real length = delta.norm();
        diff = (length - c.rest) / (length * (w1 + w2));
        keep(j, diff * length);
      } else {
        const Real square = delta.squaredNorm(), rest2 = c.rest * c.rest;
        diff = (square - rest2) / ((square + rest2) * (w1 + w2));
        keep(j, diff * std::sqrt(square));
      }
      x1 += w1 * diff * delta;
      x2 -= w2 * diff * delta;
    }
  }

  int iterations_;
  bool square_root_;
  Real dt_, keep_;
  Point gravity_;
  std::vector<Constraint> constraints_;
  std::vector<Real> w_, lambda_;
  std::vector<Point> x_, old_;
};

}  // namespace taut
