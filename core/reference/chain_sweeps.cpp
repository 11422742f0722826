#include "core/reference/chain_sweeps.hpp"

#include <cmath>
#include <numbers>

#include "core/reference/dense.hpp"

namespace taut::reference {

namespace {

/// What a full correction of link j does to the strains: -1 on itself, its share on its neighbours.
/// The support does not move, so link 0 hands all of its strain to link 1.
Eigen::VectorXd correction(int n, int j) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  d[j] = -1;
  const double share = j == 0 ? 1.0 : 0.5;
  if (j > 0) d[j - 1] = share;
  if (j + 1 < n) d[j + 1] = share;
  return d;
}

}  // namespace

Eigen::MatrixXd chain_sweep(int n, Sweep sweep, double omega) {
  Eigen::MatrixXd g = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd start = g;
  for (int j = 0; j < n; ++j) {
    const Eigen::RowVectorXd seen = (sweep == Sweep::gauss_seidel ? g : start).row(j);
    g += omega * correction(n, j) * seen;
  }
  return g;
}

Eigen::VectorXd steady_strain(const Eigen::MatrixXd& sweep, int k, double a) {
  const auto n = sweep.rows();
  Eigen::MatrixXd power = Eigen::MatrixXd::Identity(n, n), square = sweep;
  for (int bits = k; bits > 0; bits >>= 1) {
    if (bits & 1) power = power * square;
    square = square * square;
  }
  const Eigen::VectorXd load = a * power.col(0);
  return solve(Eigen::MatrixXd::Identity(n, n) - power, load);
}

Eigen::MatrixXd transverse_sweeps(int n, int k, double a, double l) {
  Eigen::VectorXd e = steady_strain(chain_sweep(n, Sweep::gauss_seidel), k, a);
  e[0] += a;  // the fall
  Eigen::MatrixXd y = Eigen::MatrixXd::Identity(n, n);
  for (int sweep = 0; sweep < k; ++sweep)
    for (int j = 0; j < n; ++j) {
      const double share = (j == 0 ? 1.0 : 0.5) * e[j] / (l + e[j]);
      Eigen::RowVectorXd pull = share * y.row(j);
      if (j > 0) pull -= share * y.row(j - 1);
      y.row(j) -= pull;
      if (j > 0) y.row(j - 1) += pull;
      e += e[j] * correction(n, j);
    }
  return y;
}

double collapsed_strain(int n, int k, double a) {
  const double rate = std::numbers::pi * std::numbers::pi * k / (4.0 * n * n);
  double sum = 0;
  for (int j = 1; j * j * rate < 700; j += 2) sum += 1 / std::expm1(j * j * rate);
  return 2 * a / n * sum;
}

double chain_radius(int n, Sweep sweep) {
  const double c = std::cos(std::numbers::pi / (2 * n));
  return sweep == Sweep::gauss_seidel ? c * c : c;
}

std::complex<double> verlet_root(double mu) {
  const std::complex<double> root = std::sqrt(std::complex<double>(mu * mu - mu));
  const std::complex<double> a = mu + root, b = mu - root;
  return std::abs(a) >= std::abs(b) ? a : b;
}

}  // namespace taut::reference
