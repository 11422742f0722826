// Why the order of the links decides stability. One step without damping, linearised about the flat
// hanging sheet, is x'' = P (2 x' - x) with P the sweep. An eigenvalue mu of P gives two modes,
// z^2 - 2 mu z + mu = 0; real mu in [0, 1] has |z| <= 1, and so have all orders here, although the
// sequential ones have complex mu. What explodes is therefore no small motion: it takes the strains
// of order one that a large sheet has at one sweep per step.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <string>

#include "core/reference/modes.hpp"
#include "core/solver/order.hpp"
#include "tests/cloths.hpp"

namespace taut {
namespace {

/// The linearised sweep over `links`, in the plane of the sheet.
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

TEST(OrderStability, SmallMotionsOfTheFlatSheetDieOutInEveryOrder) {
  for (const int n : {6, 9}) {
    const Scene scene = hanging_sheet(n, n);
    const auto of = [&](Order order) {
      return modes(scene, ordered(scene.links, scene.mesh, order, 1));
    };
    for (const Order order : {Order::mesh, Order::reversed, Order::coloured, Order::random})
      EXPECT_LT(of(order).growth, 1) << n;
    // sequential orders turn corrections into travelling waves, coloured ones hardly do
    EXPECT_GT(of(Order::mesh).imaginary, 3 * of(Order::coloured).imaginary) << n;
  }
}

TEST(OrderStability, AtOneSweepALargeUndampedSheetExplodesInSequentialOrdersOnly) {
  const Scene scene = hanging_sheet(32, 32);
  const auto fastest = [&](const std::string& order) {
    const State state =
        simulate(scene, "jakobsen:precision=double,iterations=1,order=" + order, 128);
    double most = 0;
    for (const Vec3& v : state.v) most = std::max(most, v.norm());
    return most;
  };
  for (const char* order : {"mesh", "reversed"}) EXPECT_GT(fastest(order), 1e6) << order;
  for (const char* order : {"coloured", "coloured,layout=packed", "random"})
    EXPECT_LT(fastest(order), 100) << order;
}

}  // namespace
}  // namespace taut
