#pragma once

// One implicit Euler step of springs, implemented a second time, dense and from the equations:
//     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 (|x_b - x_a| - r)^2,   y = x_t + h v_t + h^2 g

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/reference/dense.hpp"

namespace taut {

/// Irregular net: random places, masses, rest lengths and velocities, linked neighbours, two pins.
/// Some links are stretched at the start, some compressed.
inline Scene irregular_net(unsigned seed, int vertices = 40) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  Scene scene;
  scene.name = "net";
  scene.dt = 1.0 / 64;
  scene.steps = 1;
  // Draws in sequence: the order in which compilers evaluate arguments is unspecified.
  const auto point = [&](double side, double height, double low) {
    const double z = uniform(-height, height), y = uniform(low, side), x = uniform(low, side);
    return Vec3(x, y, z);
  };
  for (int i = 0; i < vertices; ++i) {
    scene.mesh.rest.push_back(point(1, 0.2, 0));
    scene.mesh.mass.push_back(uniform(0.002, 0.02));
    scene.start.v.push_back(point(1, 1, -1));
  }
  scene.start.x = scene.mesh.rest;
  scene.pins = {0, vertices / 2};
  for (const int pin : scene.pins) scene.start.v[to_index(pin)] = Vec3::Zero();
  for (const Family family : kFamilies)
    for (int i = 1; i < vertices; ++i)
      for (int j = 0; j < i; ++j) {
        const double length = (scene.start.x[to_index(i)] - scene.start.x[to_index(j)]).norm();
        const bool chain = family == Family::structural && j == i - 1;
        if (length < 0.3 * uniform(0.3, 1) || chain)
          scene.links.push_back({j, i, length * uniform(0.9, 1.1), family});
      }
  return scene;
}

inline State after_one_step(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  const auto instance = choice.entry->make(scene, choice.params);
  instance->load(scene.start);
  instance->step(0, scene.dt);
  State state;
  instance->store(state);
  return state;
}

class ElasticStep {
 public:
  /// Requires no contact, wind or damping, and pins at rest. stiffness: N/m by family.
  ElasticStep(const Scene& scene, const std::array<double, 3>& stiffness)
      : scene_(scene), w_(inverse_masses(scene)), y_(scene.start.x) {
    const double h = scene.dt;
    for (std::size_t i = 0; i < y_.size(); ++i)
      if (w_[i] > 0) y_[i] += h * scene.start.v[i] + h * h * scene.gravity;
    for (const Link& l : scene.links) k_.push_back(stiffness[static_cast<std::size_t>(l.family)]);
  }

  /// Positions [m] that inertia and gravity alone lead to; pins stay.
  const std::vector<Vec3>& prediction() const { return y_; }

  double energy(const std::vector<Vec3>& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w_[i] > 0) sum += (x[i] - y_[i]).squaredNorm() / (2 * w_[i] * scene_.dt * scene_.dt);
    for (std::size_t j = 0; j < k_.size(); ++j) sum += k_[j] / 2 * std::pow(stretch(x, j), 2);
    return sum;
  }

  /// Gradient of G, [3 n] N; zero for pins.
  Eigen::VectorXd gradient(const std::vector<Vec3>& x) const {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(x.size()));
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w_[i] > 0) at(g, i) += (x[i] - y_[i]) / (w_[i] * scene_.dt * scene_.dt);
    for (std::size_t j = 0; j < k_.size(); ++j) {
      const auto [a, b] = ends(j);
      const Vec3 u = (x[b] - x[a]).normalized();
      if (w_[a] > 0) at(g, a) -= k_[j] * stretch(x, j) * u;
      if (w_[b] > 0) at(g, b) += k_[j] * stretch(x, j) * u;
    }
    return g;
  }

  /// Newton direction H^-1 g, [3 n] m. `clamped` leaves the transverse parts of compressed links
  /// out of H.
  Eigen::VectorXd newton_direction(const std::vector<Vec3>& x, bool clamped = true) const {
    const auto n = 3 * static_cast<Eigen::Index>(x.size());
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double m = w_[i] > 0 ? 1 / (w_[i] * scene_.dt * scene_.dt) : 1;
      block(hessian, i, i) += m * Eigen::Matrix3d::Identity();
    }
    for (std::size_t j = 0; j < k_.size(); ++j) {
      const auto [a, b] = ends(j);
      const Vec3 d = x[b] - x[a], u = d.normalized();
      const double across = 1 - scene_.links[j].rest / d.norm();
      const Eigen::Matrix3d part =
          k_[j] * (u * u.transpose() + (clamped ? std::max(0.0, across) : across) *
                                           (Eigen::Matrix3d::Identity() - u * u.transpose()));
      if (w_[a] > 0) block(hessian, a, a) += part;
      if (w_[b] > 0) block(hessian, b, b) += part;
      if (w_[a] > 0 && w_[b] > 0) {
        block(hessian, a, b) -= part;
        block(hessian, b, a) -= part;
      }
    }
    return reference::solve(hessian, gradient(x));
  }

  std::vector<Vec3> moved(std::vector<Vec3> x, Eigen::VectorXd direction, double share = 1) const {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= share * at(direction, i);
    return x;
  }

  /// Minimum of G: descends with the clamped Hessian, then applies the full Newton method.
  std::vector<Vec3> minimum() const {
    std::vector<Vec3> x = y_;
    for (int k = 0; k < 500 && gradient(x).norm() > 1e-3; ++k) {
      const Eigen::VectorXd direction = newton_direction(x);
      double share = 1;
      while (share > 1e-9 && energy(moved(x, direction, share)) > energy(x)) share /= 2;
      x = moved(x, direction, share);
    }
    for (int k = 0; k < 8; ++k) x = moved(x, newton_direction(x, false));
    return x;
  }

  const std::vector<Vec3>& y() const { return y_; }
  double stiffness(std::size_t link) const { return k_[link]; }
  /// Constraint value C [m] of a link.
  double stretch(const std::vector<Vec3>& x, std::size_t link) const {
    const auto [a, b] = ends(link);
    return (x[b] - x[a]).norm() - scene_.links[link].rest;
  }

 private:
  std::pair<std::size_t, std::size_t> ends(std::size_t link) const {
    return {to_index(scene_.links[link].a), to_index(scene_.links[link].b)};
  }
  static Eigen::VectorBlock<Eigen::VectorXd, 3> at(Eigen::VectorXd& v, std::size_t i) {
    return v.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  static Eigen::Block<Eigen::MatrixXd, 3, 3> block(Eigen::MatrixXd& m, std::size_t i,
                                                   std::size_t j) {
    return m.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j));
  }

  Scene scene_;
  std::vector<double> w_, k_;
  std::vector<Vec3> y_;
};

}  // namespace taut
