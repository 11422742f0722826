#include "core/reference/closed_forms.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/model/mesh.hpp"
#include "core/reference/dense.hpp"

namespace taut::reference {

namespace {

using std::numbers::pi;

/// Nodes of the Gauss-Laguerre rule: eigenvalues of the Jacobi matrix of the Laguerre polynomials.
Eigen::VectorXd laguerre_roots(int n) {
  Eigen::VectorXd diagonal(n), beside(n - 1);
  for (int i = 0; i < n; ++i) diagonal[i] = 2 * i + 1;
  for (int i = 0; i + 1 < n; ++i) beside[i] = i + 1;
  return tridiagonal_eigenvalues(diagonal, beside);
}

/// Root of an increasing function between a and b, down to neighbouring doubles.
template <class F>
double bisect(double a, double b, const F& f) {
  for (int n = 0; n < 2000; ++n) {
    const double middle = a + (b - a) / 2;
    if (middle <= a || middle >= b) break;
    (f(middle) < 0 ? a : b) = middle;
  }
  return a + (b - a) / 2;
}

/// Effect of a full correction of link j on the strains: -1 on itself, its share on its neighbours.
/// The support does not move, so link 0 passes all of its strain on to link 1.
Eigen::VectorXd correction(int n, int j) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  d[j] = -1;
  const double share = j == 0 ? 1.0 : 0.5;
  if (j > 0) d[j - 1] = share;
  if (j + 1 < n) d[j + 1] = share;
  return d;
}

}  // namespace

double pendulum_period(double length, double g, double amplitude) {
  double a = 1, b = std::cos(amplitude / 2);
  for (int i = 0; i < 64 && std::abs(a - b) > 1e-16 * a; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return 2 * pi * std::sqrt(length / g) / a;
}

std::array<Vec3, 2> double_pendulum(std::array<double, 2> angles, double t, int steps) {
  constexpr double g = 9.81;
  using Y = Eigen::Array4d;  // both angles, both angular velocities
  const auto rate = [](const Y& y) -> Y {
    const double d = y[0] - y[1], s = std::sin(d), c = std::cos(d);
    // 2 a1 + c a2 = -s w2^2 - 2 g sin(th1);  c a1 + a2 = s w1^2 - g sin(th2)
    const double p = -s * y[3] * y[3] - 2 * g * std::sin(y[0]);
    const double q = s * y[2] * y[2] - g * std::sin(y[1]);
    const double det = 2 - c * c;
    return {y[2], y[3], (p - c * q) / det, (2 * q - c * p) / det};
  };
  Y y(angles[0], angles[1], 0, 0);
  const double h = t / steps;
  for (int n = 0; n < steps; ++n) {
    const Y k1 = rate(y), k2 = rate(y + h / 2 * k1), k3 = rate(y + h / 2 * k2),
            k4 = rate(y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  const Vec3 first(std::sin(y[0]), -std::cos(y[0]), 0);
  return {first, first + Vec3(std::sin(y[1]), -std::cos(y[1]), 0)};
}

double stick_next_angle(double phi) { return std::atan2(std::sin(phi), 2 - std::cos(phi)); }

std::vector<double> hanging_chain_frequencies(int n, double length, double g) {
  const Eigen::VectorXd xi = laguerre_roots(n);
  std::vector<double> w;
  for (const double root : xi) w.push_back(std::sqrt(g * n / length * root));
  return w;
}

std::vector<double> hanging_chain_mode(int n, int mode) {
  const double xi = laguerre_roots(n)[mode - 1];
  std::vector<double> shape;  // L_0, L_1, ..., L_{n-1}: from the free end upwards
  for (int i = 0; i < n; ++i) shape.push_back(std::laguerre(static_cast<unsigned>(i), xi));
  std::reverse(shape.begin(), shape.end());
  double largest = 0;
  for (const double s : shape) largest = std::max(largest, std::abs(s));
  for (double& s : shape) s /= largest;
  return shape;
}

double hanging_rope_frequency(int mode, double length, double g) {
  double j = (mode - 0.25) * pi;  // McMahon's first term
  for (int i = 0; i < 20; ++i) j += std::cyl_bessel_j(0, j) / std::cyl_bessel_j(1, j);
  return j / 2 * std::sqrt(g / length);
}

std::vector<double> spring_chain_frequencies(int n, double stiffness, double mass) {
  std::vector<double> w;
  for (int j = 1; j <= n; ++j)
    w.push_back(2 * std::sqrt(stiffness / mass) * std::sin((2 * j - 1) * pi / (2.0 * (2 * n + 1))));
  return w;
}

double spring_grid_eigenvalue(int nu, bool shear, bool bend) {
  const double side = nu - 1;
  const Mesh mesh = make_sheet({.nu = nu, .nv = nu, .width = side, .height = side, .mass = 1});
  const std::vector<Link> links = grid_links(mesh, {.shear = shear, .bend = bend});
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  std::vector<Vec3> u(at(mesh.size())), next;
  // Displacements in the plane without any symmetry of the grid.
  for (std::size_t i = 0; i < u.size(); ++i)
    u[i] = {std::sin(1.0 + 7.0 * static_cast<double>(i)),
            std::cos(2.0 + 3.0 * static_cast<double>(i)), 0};
  double value = 0, before = -1;
  for (int n = 0; n < 100000 && std::abs(value - before) > 1e-10 * value; ++n) {
    next.assign(u.size(), Vec3::Zero());
    for (const Link& l : links) {
      const Vec3 n12 = (mesh.rest[at(l.b)] - mesh.rest[at(l.a)]).normalized();
      const Vec3 pull = n12.dot(u[at(l.b)] - u[at(l.a)]) * n12;
      next[at(l.a)] -= pull;
      next[at(l.b)] += pull;
    }
    double square = 0;
    for (const Vec3& v : next) square += v.squaredNorm();
    before = value;
    value = std::sqrt(square);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = next[i] / value;
  }
  return value;
}

double capstan_ratio(double mu, double wrap, double link) {
  const double t = mu * std::tan(link / 2);
  return std::pow((1 + t) / (1 - t), wrap / link);
}

double capstan_ratio_of_links(double mu, double wrap, double link) {
  return std::exp(std::asinh(mu * std::sin(link)) * wrap / link);
}

double Catenary::sag() const { return -*std::min_element(y.begin(), y.end()); }

Catenary discrete_catenary(int links, double span, double link, double load, double stiffness) {
  assert(links >= 2 && load > 0 && span > 0);
  const auto slope = [&](int i, double h) { return load / h * (i + 1 - (links + 1) / 2.0); };
  const auto length = [&](int i, double h) {
    return link + h * std::hypot(1.0, slope(i, h)) / stiffness;
  };
  const auto gap = [&](double h) {
    double reach = 0;
    for (int i = 0; i < links; ++i) reach += length(i, h) / std::hypot(1.0, slope(i, h));
    return reach - span;
  };
  double high = load;
  while (gap(high) < 0) high *= 2;
  Catenary c;
  c.horizontal = bisect(0.0, high, gap);
  c.x = {0};
  c.y = {0};
  for (int i = 0; i < links; ++i) {
    const double t = slope(i, c.horizontal), l = length(i, c.horizontal), secant = std::hypot(1, t);
    c.tension.push_back(c.horizontal * secant);
    c.x.push_back(c.x.back() + l / secant);
    c.y.push_back(c.y.back() + l * t / secant);
  }
  return c;
}

double continuum_sag(double length, double span) {
  // u = span/2a: sinh(u)/u = length/span
  const double u = bisect(1e-9, 700.0, [&](double v) { return std::sinh(v) / v - length / span; });
  const double a = span / (2 * u);
  return a * (std::cosh(u) - 1);
}

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
