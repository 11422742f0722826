// Why the order of the links decides stability. One step of small motions without damping is x'' =
// P (2 x' - x), where P is the sweep. An eigenvalue mu of P gives two modes, z^2 - 2 mu z + mu = 0,
// which are neutral (|z| = 1) on the curve mu = z^2 / (2 z - 1). Near mu = 1, the place of all slow
// motions, this curve is a cusp: a mode is stable iff |arg mu| < (1 - |mu|)^(3/2). Sweeps with few
// colours have real mu and stay inside. A sweep along a line of links has mu = e^(2ik) / (2 e^(ik)
// - 1) for the wave number k, which is exactly the curve, with z = e^(ik): a wave travels with the
// sweep, one link a step, and neither grows nor decays. Corrections larger than the error make all
// waves grow, whether by over-relaxation or because the square-root-free projection overshoots by
// the strain. Smaller corrections make all waves decay.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <random>
#include <string>
#include <utility>

#include "core/reference/dense.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/simd/distance.hpp"
#include "tests/support/cloths.hpp"

namespace taut::order_stability_test {
namespace {

/// Matrix of the linearised sweep over `links`, in the plane of the sheet.
Eigen::MatrixXd sweep(const Scene& scene, const std::vector<Link>& links) {
  const std::vector<double> w = inverse_masses(scene);
  const auto n = static_cast<Eigen::Index>(2 * scene.mesh.rest.size());
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(n, n);
  for (const Link& link : links) {
    const double wa = w[static_cast<std::size_t>(link.a)], wb = w[static_cast<std::size_t>(link.b)];
    if (wa + wb == 0) continue;
    const Eigen::Vector2d d = (scene.mesh.rest[static_cast<std::size_t>(link.b)] -
                               scene.mesh.rest[static_cast<std::size_t>(link.a)])
                                  .head<2>()
                                  .normalized();
    const Eigen::RowVectorXd excess =
        d.transpose() * (p.middleRows<2>(2 * link.b) - p.middleRows<2>(2 * link.a)) / (wa + wb);
    p.middleRows<2>(2 * link.a) += wa * d * excess;
    p.middleRows<2>(2 * link.b) -= wb * d * excess;
  }
  return p;
}

struct Modes {
  double growth = 0;     ///< largest |z|, per step
  double imaginary = 0;  ///< largest |Im mu|
};

Modes modes(const Scene& scene, const std::vector<Link>& links) {
  Modes worst;
  const reference::Modes modes = reference::modes(sweep(scene, links));
  for (const std::complex<double> mu : modes.eigenvalues) {
    worst.imaginary = std::max(worst.imaginary, std::abs(mu.imag()));
    const std::complex<double> root = std::sqrt(mu * mu - mu);
    for (const auto z : {mu + root, mu - root})
      if (std::abs(z - 1.0) > 1e-5) worst.growth = std::max(worst.growth, std::abs(z));
  }
  return worst;
}

/// Largest |z| on an endless line of links that is swept from end to end, for waves of k radians a
/// link and corrections of `omega` times the error. With q = omega / 2 the value of a particle
/// after the link before it is S = (1 - q) + q S e^(-ik), and mu = (1 - q) S + q e^(ik).
double growth_along_a_line(double omega, double k) {
  const double q = omega / 2;
  const std::complex<double> forth = std::polar(1.0, k), back = std::polar(1.0, -k);
  const std::complex<double> mu = (1 - q) * (1 - q) / (1.0 - q * back) + q * forth;
  const std::complex<double> root = std::sqrt(mu * mu - mu);
  return std::max(std::abs(mu + root), std::abs(mu - root));
}

TEST(OrderStability, AWaveGrowsIffCorrectionsAreMoreThanWhole) {
  for (const double k : {0.01, 0.1, 0.5, 1.0, 2.0, 3.0}) {
    EXPECT_LT(growth_along_a_line(0.9, k), 1) << k;
    EXPECT_NEAR(growth_along_a_line(1, k), 1, 1e-12) << k;
    EXPECT_GT(growth_along_a_line(1.1, k), 1) << k;
  }
}

TEST(OrderStability, OvershootOfTheSquareRootFreeFormIsTheStrain) {
  // length of a link of rest length 1 between equal masses after a projection
  const auto after = [](double length) {
    return length * (1 - excess<Projection::sqrt_free>(length * length, 1.0));
  };
  for (const double strain : {0.01, 0.05}) {
    const double remains = (after(1 + strain + 1e-6) - after(1 + strain - 1e-6)) / 2e-6;
    EXPECT_NEAR(1 - remains, 1 + strain,
                2 * strain * strain);  // share of a small error that a projection removes
  }
}

/// Growth of the speed of small motions in the sheet's plane [decades].
struct Growth {
  double most = 0, last = 0;  ///< largest and last value, relative to the speed after four steps
};

/// Growth of motion from a random start with one sweep per step.
Growth growth(const Scene& scene, const std::vector<Link>& links, double omega, int steps) {
  const std::vector<double> w = inverse_masses(scene);
  std::mt19937 random(1);
  std::normal_distribution<> noise;
  std::vector<Eigen::Vector2d> now(w.size(), Eigen::Vector2d::Zero()), before = now;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) before[i] = Eigen::Vector2d(noise(random), noise(random));
  std::vector<double> speeds;
  for (int n = 0; n < steps; ++n) {
    for (std::size_t i = 0; i < w.size(); ++i)
      before[i] = std::exchange(now[i], Eigen::Vector2d(2 * now[i] - before[i]));
    for (const Link& link : links) {
      const auto a = static_cast<std::size_t>(link.a), b = static_cast<std::size_t>(link.b);
      if (w[a] + w[b] == 0) continue;
      const Eigen::Vector2d d = (scene.mesh.rest[b] - scene.mesh.rest[a]).head<2>().normalized();
      const Eigen::Vector2d move = omega * d.dot(now[b] - now[a]) / (w[a] + w[b]) * d;
      now[a] += w[a] * move;
      now[b] -= w[b] * move;
    }
    double square = 0;
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] > 0) square += (now[i] - before[i]).squaredNorm() / w[i];
    speeds.push_back(std::log10(square) / 2);
  }
  return {*std::max_element(speeds.begin() + 4, speeds.end()) - speeds[4],
          speeds.back() - speeds[4]};
}

TEST(OrderStability, OvershootingSweepsPumpWavesThatTravelWithThem) {
  const auto of = [](const LinkChoice& families, Order order, double omega) {
    const Scene scene = hanging_sheet(32, 32, families);
    return growth(scene, ordered(scene, order, 1), omega, 128);
  };
  const LinkChoice threads{.structural = true}, all{true, true, true};
  for (const Order order : {Order::mesh, Order::reversed}) {
    // along threads alone a wave grows until it leaves at the far edge, after about 32 steps
    EXPECT_GT(of(threads, order, 1.25).most, 3);
    EXPECT_LT(of(threads, order, 1.25).last, 0);
    EXPECT_GT(of(all, order, 1.1).last, 3);  // shear and bend links carry it back
    EXPECT_LT(of(all, order, 1).most, 0.2);
  }
  for (const Order order : {Order::coloured, Order::random})
    EXPECT_LT(of(all, order, 1.1).most, 0.2);
  // sweeping there and back is symmetric, so that its mu are real
  const Scene scene = hanging_sheet(32, 32, all);
  std::vector<Link> both = scene.links;
  both.insert(both.end(), scene.links.rbegin(), scene.links.rend());
  EXPECT_LT(growth(scene, both, 1.1, 128).most, 0.2);
}

TEST(OrderStability, SmallMotionsOfTheFlatSheetDieOutInEveryOrder) {
  for (const int n : {6, 9}) {
    const Scene scene = hanging_sheet(n, n);
    const auto of = [&](Order order) { return modes(scene, ordered(scene, order, 1)); };
    for (const Order order : {Order::mesh, Order::reversed, Order::coloured, Order::random})
      EXPECT_LT(of(order).growth, 1) << n;
    // sequential orders turn corrections into travelling waves; coloured orders hardly do
    EXPECT_GT(of(Order::mesh).imaginary, 3 * of(Order::coloured).imaginary) << n;
  }
}

TEST(OrderStability, AnUndampedSheetExplodesInSequentialOrders) {
  const Scene scene = hanging_sheet(32, 32);
  const auto fastest = [&](const std::string& order) {
    const State state =
        simulate(scene, listing("precision=double,iterations=1,order=" + order), 128);
    double most = 0;
    for (const Vec3& v : state.v) most = std::max(most, v.norm());
    return most;
  };
  for (const char* order : {"mesh", "reversed"}) EXPECT_GT(fastest(order), 1e6) << order;
  for (const char* order : {"coloured", "coloured,layout=batches", "random"})
    EXPECT_LT(fastest(order), 100) << order;
}

TEST(OrderStability, SmallerCorrectionsCureSequentialOrders) {
  const Scene scene = hanging_sheet(64, 64);
  const auto fastest = [&](const std::string& setting) {
    const State state =
        simulate(scene, "jakobsen:precision=double,iterations=1,substeps=8," + setting, 24);
    double most = 0;
    for (const Vec3& v : state.v) most = std::max(most, v.norm());
    return most;
  };
  for (const char* setting : {"order=mesh", "order=reversed"})
    EXPECT_GT(fastest(setting), 1e6) << setting;
  for (const char* setting : {"order=mesh,omega=0.8", "order=mesh,projection=exact",
                              "order=reversed,omega=0.8", "order=coloured", "order=random"})
    EXPECT_LT(fastest(setting), 50) << setting;
}

}  // namespace
}  // namespace taut::order_stability_test
