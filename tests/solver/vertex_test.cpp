// Vertex Block Descent and its augmented form against the papers' algorithms in plain loops.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference/dense.hpp"
#include "tests/solver/both_precisions.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::vertex_test {
namespace {

constexpr std::array kSoft{800.0, 300.0, 50.0};
const std::string kSoftText = "structural=800,shear=300,bend=50";

/// Both papers' algorithms, vertex by vertex in the scene's order. Each vertex searches all links
/// of the scene.
struct Textbook {
  Scene scene;
  bool augmented = false;
  double damping = 0, alpha = 0, beta = 0, gamma = 0, k_min = 1;
  std::vector<Vec3> x, v, v_before;
  std::vector<double> k, l;

  explicit Textbook(const Scene& s) : scene(s), x(s.start.x), v(s.start.v) {
    k.assign(s.links.size(), 0);
    l.assign(s.links.size(), 0);
  }

  void step(int sweeps) {
    const double h = scene.dt, g = scene.gravity.norm();
    const Vec3 down = scene.gravity / g;
    const std::vector<double> w = inverse_masses(scene);
    const std::vector<Vec3> start = x;
    std::vector<Vec3> y = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w[i] == 0) continue;
      y[i] = x[i] + h * v[i] + h * h * scene.gravity;
      const double acted =
          v_before.empty() ? g : std::clamp((v[i] - v_before[i]).dot(down) / h, 0.0, g);
      x[i] += h * v[i] + h * h * acted * down;
    }
    std::vector<double> left(k.size(), 0);
    for (std::size_t j = 0; augmented && j < k.size(); ++j) {
      left[j] = alpha * stretch(start, j);
      l[j] *= alpha * gamma;
      k[j] = std::clamp(gamma * k[j], k_min, 1e9);
    }
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (std::size_t i = 0; i < x.size(); ++i)
        if (w[i] > 0) move(i, w[i], y[i], start[i], left);
      for (std::size_t j = 0; augmented && j < k.size(); ++j) {
        const double c = stretch(x, j) - left[j];
        l[j] += k[j] * c;
        k[j] = std::min(k[j] + beta * std::abs(c), 1e9);
      }
    }
    v_before = v;
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - start[i]) / h;
  }

  void move(std::size_t i, double w, const Vec3& y, const Vec3& start,
            const std::vector<double>& left) {
    const double h = scene.dt;
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(3, 3) / (w * h * h);
    Eigen::VectorXd force = -(x[i] - y) / (w * h * h);
    for (std::size_t j = 0; j < scene.links.size(); ++j) {
      const Link& link = scene.links[j];
      if (to_index(link.a) != i && to_index(link.b) != i) continue;
      const std::size_t other = to_index(link.a) == i ? to_index(link.b) : to_index(link.a);
      const double n = (x[other] - x[i]).norm(), c = n - link.rest;
      const Vec3 u = (x[other] - x[i]) / n;
      const Eigen::Matrix3d along = u * u.transpose(), across = Eigen::Matrix3d::Identity() - along;
      if (augmented) {
        const double pull = k[j] * (c - left[j]) + l[j];
        force += pull * u;
        hessian += k[j] * along;
        for (int column = 0; column < 3; ++column)
          hessian(column, column) += (pull / n * across.col(column)).norm();
      } else {
        const double stiffness = kSoft[static_cast<std::size_t>(link.family)];
        const Eigen::Matrix3d part =
            stiffness * (along + std::max(0.0, 1 - link.rest / n) * across);
        force += stiffness * c * u - damping / h * part * (x[i] - start);
        hessian += (1 + damping / h) * part;
      }
    }
    x[i] += reference::solve(hessian, force);
  }

  double stretch(const std::vector<Vec3>& at, std::size_t j) const {
    const Link& link = scene.links[j];
    return (at[to_index(link.b)] - at[to_index(link.a)]).norm() - link.rest;
  }
};

TEST(VertexBlockDescent, FixedPointIsNewtonsStep) {
  for (const unsigned seed : {1u, 2u}) {
    const Scene scene = irregular_net(seed);
    const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
    for (const char* order : {"mesh", "coloured"}) {
      const State mine = after_one_step(
          scene, "vbd:iterations=5000,order=" + std::string(order) + "," + kSoftText);
      EXPECT_LT(largest_distance(mine.x, exact), 1e-8) << order << ", seed " << seed;
    }
  }
}

TEST(VertexBlockDescent, AgreesWithThePaperInPlainLoops) {
  const Scene scene = irregular_net(5);
  for (const double damping : {0.0, 2e-3}) {
    Textbook textbook(scene);
    textbook.damping = damping;
    for (int n = 0; n < 6; ++n) textbook.step(4);
    const State mine = simulate(
        scene, "vbd:iterations=4,order=mesh," + kSoftText + ",damping=" + std::to_string(damping),
        6);
    EXPECT_LT(largest_distance(mine.x, textbook.x), 1e-9);
    EXPECT_LT(largest_distance(mine.v, textbook.v), 1e-7);
  }
}

TEST(VertexBlockDescent, ChebyshevGoesToTheSamePointFaster) {
  const Scene scene = irregular_net(3);
  const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
  const auto error = [&](const std::string& more) {
    return largest_distance(after_one_step(scene, "vbd:" + kSoftText + more).x, exact);
  };
  EXPECT_LT(error(",iterations=3000,chebyshev=0.8"), 1e-8);
  EXPECT_LT(error(",iterations=30,chebyshev=0.8"), 0.7 * error(",iterations=30"));
}

TEST(AugmentedVertexBlockDescent, AgreesWithThePaperInPlainLoops) {
  const Scene scene = irregular_net(6);
  Textbook textbook(scene);
  textbook.augmented = true;
  textbook.alpha = 0.95;
  textbook.beta = 2000;
  textbook.gamma = 0.99;
  textbook.k_min = 50;
  for (int n = 0; n < 6; ++n) textbook.step(4);
  const State mine =
      simulate(scene, "avbd:iterations=4,order=mesh,beta=2000,k-min=50,alpha=0.95,gamma=0.99", 6);
  EXPECT_LT(largest_distance(mine.x, textbook.x), 1e-9);
}

TEST(AugmentedVertexBlockDescent, ItsLinksBecomeRigid) {
  Scene scene = hanging_sheet(1, 8, {true, false, false});
  for (std::size_t i = 1; i < scene.start.v.size(); ++i) scene.start.v[i] = {1, 0, 0};
  const State mine = after_one_step(scene, "avbd:iterations=3000,beta=1e5,k-min=100");
  for (const Link& l : scene.links)
    EXPECT_NEAR((mine.x[to_index(l.b)] - mine.x[to_index(l.a)]).norm(), l.rest, 1e-9);
}

TEST(VertexBlocks, FloatFollowsDouble) {
  for (const char* solver : {"vbd:iterations=20", "avbd:iterations=20"})
    expect_float_follows_double(solver);
}

TEST(VertexBlocks, ALinkOfNoLengthHasNoDirection) {
  for (const char* solver : {"vbd:iterations=1", "avbd:iterations=1"})
    expect_link_of_no_length_is_harmless(solver);
}

TEST(VertexBlocks, AnyNumberOfThreadsComputesTheSameBits) {
  Scene scene = crumpled(hanging_sheet(101, 100), 0.002);
  for (const char* solver : {"vbd:iterations=3", "avbd:iterations=3"}) {
    const State one = simulate(scene, solver, 3);
    const State three = simulate(scene, std::string(solver) + ",threads=3", 3);
    EXPECT_EQ(largest_distance(one.x, three.x), 0) << solver;
  }
}

}  // namespace
}  // namespace taut::vertex_test
