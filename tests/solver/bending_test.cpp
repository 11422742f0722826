// Bending: the elements are compared with the plate that they discretise, and every solver with the
// same energy.
#include "core/model/bending.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/reference/linear_stability.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::bending_test {
namespace {

const Vec3 kWarp = -Vec3::UnitY();

/// Flat sheet without links whose interior vertices are displaced at random within the plane.
Scene irregular_sheet(int nu, int nv, double off) {
  Scene s = hanging_sheet(nu, nv, {false, false, false});
  const Scene moved = crumpled(s, off);
  for (int j = 1; j + 1 < nv; ++j)
    for (int i = 1; i + 1 < nu; ++i) {
      const std::size_t v = to_index(s.mesh.grid->index(i, j));
      s.mesh.rest[v] = moved.start.x[v];
      s.mesh.rest[v].z() = 0;
    }
  s.mesh.grid.reset();
  s.pins.clear();
  s.start.x = s.mesh.rest;
  return s;
}

/// Positions x with the height q(p) = (a p_warp^2 + b p_weft^2)/2 + c p_warp p_weft.
std::vector<Vec3> bent(const Scene& s, double a, double b, double c) {
  std::vector<Vec3> x = s.mesh.rest;
  for (Vec3& p : x) {
    const double warp = -p.y(), weft = p.x();
    p.z() = (a * warp * warp + b * weft * weft) / 2 + c * warp * weft;
  }
  return x;
}

TEST(Bending, SecondDerivativesOfQuadraticsAreExact) {
  Scene s = irregular_sheet(9, 11, 0.02);
  s.bending = Bending{1, 1, kWarp};
  const std::vector<Vec3> x = bent(s, 0.7, -0.4, 0.9);
  const std::vector<BendingElement> elements = make_bending(s);
  std::array<int, 3> inner{};
  for (const BendingElement& e : elements) {
    const Vec3 value = e.value([&](std::size_t v) { return x[v]; });
    EXPECT_LT(value.head<2>().norm(), 1e-9) << "a flat sheet is not bent";
    if (e.size < 6) continue;
    const double want[] = {0.7, -0.4, std::sqrt(2.0) * 0.9};
    std::size_t which = 3;
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(std::abs(value.z()) - std::abs(want[k])) < 1e-9) which = k;
    ASSERT_LT(which, 3u) << value.z();
    ++inner[which];
  }
  for (const int n : inner) EXPECT_GT(n, 80) << "of 160 triangles";
}

/// Energy of a sheet bent along a line at `angle` to the warp. Curvatures [1/m]: `along` the line,
/// `across` it, and `twist`. The triangles at the edges are left out.
double energy_at(double angle, const Bending& bending, double along, double across, double twist) {
  Scene s = hanging_sheet(41, 41, {false, false, false});
  s.pins.clear();
  s.bending = bending;
  const double c = std::cos(angle), d = std::sin(angle);
  const std::vector<Vec3> x = bent(s, along * c * c + across * d * d - 2 * twist * c * d,
                                   along * d * d + across * c * c + 2 * twist * c * d,
                                   (along - across) * c * d + twist * (c * c - d * d));
  double energy = 0;
  for (const BendingElement& e : make_bending(s)) {
    const auto inside = [&](int v) {
      const int i = v % 41, j = v / 41;
      return std::min({i, j, 40 - i, 40 - j}) >= 5;
    };
    if (std::all_of(e.vertex.begin(), e.vertex.begin() + static_cast<long>(e.size), inside))
      energy += bending_energy({e}, x);
  }
  return energy;
}

/// Stiffness of a sheet that is rolled up: it bends along the line alone.
double stiffness_at(double angle, const Bending& bending) {
  return energy_at(angle, bending, 1, 0, 0);
}

/// Stiffness of a sheet that is also free to bend across the line and to twist, whichever needs
/// least energy.
double free_stiffness_at(double angle, const Bending& bending) {
  const auto energy = [&](double a, double b, double t) {
    return energy_at(angle, bending, a, b, t);
  };
  const double b = energy(0, 1, 0), t = energy(0, 0, 1), a = energy(1, 0, 0);
  const double bt = energy(0, 1, 1) - b - t, ab = energy(1, 1, 0) - a - b,
               at = energy(1, 0, 1) - a - t;
  return a - (t * ab * ab - bt * ab * at + b * at * at) / (4 * b * t - bt * bt);
}

TEST(Bending, AStripAtAnAngleToTheWarpTwistsIfItMay) {
  const double isotropic = stiffness_at(0, {1, 1, kWarp});
  for (const double angle : {0.0, 0.3, 0.7854, 1.2, 1.5708}) {
    const double c = std::cos(angle), d = std::sin(angle);
    EXPECT_NEAR(free_stiffness_at(angle, {4, 1, kWarp}) / isotropic,
                1 / std::pow(c * c / 2 + d * d, 2), 0.06)
        << angle;
  }
}

TEST(Bending, AStripAtAnAngleToTheWarpIsAsStiffAsThePlate) {
  const double isotropic = stiffness_at(0, {1, 1, kWarp});
  for (const double angle : {0.3, 0.7854, 1.2, 1.5708}) {
    EXPECT_NEAR(stiffness_at(angle, {1, 1, kWarp}) / isotropic, 1, 0.03) << angle;
    const double c = std::cos(angle), d = std::sin(angle);
    EXPECT_NEAR(stiffness_at(angle, {4, 1, kWarp}) / isotropic, std::pow(2 * c * c + d * d, 2),
                0.12)
        << angle;
  }
}

TEST(Bending, AGridHasSecondDifferencesAndTwists) {
  Scene s = hanging_sheet(5, 9, {false, false, false});
  s.pins.clear();
  s.bending = Bending{3, 2, kWarp};
  const std::vector<BendingElement> elements = make_bending(s);
  EXPECT_EQ(elements.size(), 5u * 7 + 3 * 9 + 4 * 8) << "along v, along u, twists";
  const double l = 0.25;  // rows 1 to 7 are bent, each of width l
  EXPECT_NEAR(bending_energy(elements, bent(s, 1, 0, 0)), 3.0 / 2 * 7 * l * 1, 1e-12);
  EXPECT_NEAR(bending_energy(elements, bent(s, 0, 1, 0)), 2.0 / 2 * 3 * l * 2, 1e-12);
  for (const BendingElement& e : elements) EXPECT_LE(e.size, 4u);
}

TEST(Bending, AShellIsUnfoldedAndFixedPinsCostNothing) {
  Scene s = hanging_sheet(3, 9, {false, false, false});
  s.bending = Bending{1, 1, kWarp};
  const std::vector<Vec3> flat = s.mesh.rest;
  std::vector<BendingElement> of_flat = make_bending(s);
  for (Vec3& x : s.mesh.rest) x = Vec3(x.x(), -std::sin(-x.y()), std::cos(-x.y()));
  const std::vector<BendingElement> of_roll = make_bending(s);
  EXPECT_NEAR(bending_energy(of_roll, flat), 0, 1e-20) << "what is flat is not bent";
  EXPECT_NEAR(bending_energy(of_roll, s.mesh.rest) / bending_energy(of_flat, s.mesh.rest), 1, 0.05);
  s.mesh.rest = flat;
  for (int v = 0; v < 6; ++v) s.pins.push_back(v);
  std::ranges::sort(s.pins);
  s.pins.erase(std::unique(s.pins.begin(), s.pins.end()), s.pins.end());
  EXPECT_LT(make_bending(s).size(), of_flat.size());
}

/// Bent sheet in motion on soft links, with two rows pinned.
Scene clamped(double stiffness) {
  Scene s = crumpled(hanging_sheet(5, 8, {true, true, false}), 0.03);
  s.pins.clear();
  for (int v = 0; v < 10; ++v) {
    s.pins.push_back(v);
    s.start.x[to_index(v)] = s.mesh.rest[to_index(v)];
  }
  for (std::size_t v = 10; v < s.start.v.size(); ++v)
    s.start.v[v] = Vec3(0.1, 0.2, std::sin(static_cast<double>(v)));
  s.stiffness = {800, 300, kRigid[2]};
  s.bending = Bending{stiffness, 2 * stiffness, kWarp};
  return s;
}

/// Gradient of the energy after a step [N]; the bending part is taken by finite differences.
double left(const Scene& s, const std::vector<Vec3>& x) {
  const ElasticStep step(s, s.stiffness);
  Eigen::VectorXd g = step.gradient(x);
  const std::vector<BendingElement> elements = make_bending(s);
  for (std::size_t v = 10; v < x.size(); ++v)
    for (int c = 0; c < 3; ++c) {
      const auto moved = [&](double by) {
        std::vector<Vec3> y = x;
        y[v][c] += by;
        return bending_energy(elements, y);
      };
      // exact, as the energy is quadratic
      g[3 * static_cast<int>(v) + c] += (moved(1e-4) - moved(-1e-4)) / 2e-4;
    }
  return g.norm();
}

TEST(Bending, EverySolverOfEnergiesTakesTheSameStep) {
  for (const double stiffness : {1e-3, 1e-2}) {
    const Scene s = clamped(stiffness);
    Scene unbent = s;
    unbent.bending.reset();
    const State exact = after_one_step(s, "implicit:iterations=200");
    EXPECT_LT(left(s, exact.x), 1e-7);
    EXPECT_GT(largest_distance(exact.x, after_one_step(unbent, "implicit:iterations=200").x), 1e-4);
    for (const char* solver : {"implicit:iterations=200,linear=cg", "pd:iterations=3000",
                               "pd:iterations=300,anderson=5", "admm:links=elastic,iterations=3000",
                               "vbd:iterations=3000", "vbd:iterations=3000,order=mesh"})
      EXPECT_LT(largest_distance(exact.x, after_one_step(s, solver).x), 1e-6)
          << solver << " at " << stiffness;
  }
}

// Without links the step is one linear system, which projections solve exactly as well.
TEST(Bending, AloneItIsTheSameStepForEverySolver) {
  Scene s = clamped(1e-3);
  s.links.clear();
  s.stiffness = kRigid;
  const State exact = after_one_step(s, "implicit");
  for (const char* solver : {"jakobsen:substeps=1,iterations=3000,precision=double",
                             "jakobsen:substeps=1,iterations=3000,precision=double,method=jacobi",
                             "xpbd:substeps=1,iterations=3000,precision=double", "pd:iterations=1",
                             "admm:iterations=1", "vbd:iterations=3000", "avbd:iterations=3000"})
    EXPECT_LT(largest_distance(exact.x, after_one_step(s, solver).x), 1e-9) << solver;
  EXPECT_GT(largest_distance(exact.x, after_one_step(s, "xpbd:substeps=1,iterations=1").x), 1e-5);
}

TEST(Bending, MovesNoCentreOfMassAndHasTheSameBits) {
  Scene s = crumpled(hanging_sheet(20, 20, {true, true, false}), 0.01);
  s.pins.clear();
  s.bending = Bending{1e-4, 5e-5, kWarp};
  const auto centre = [&](const State& state) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < state.x.size(); ++i) sum += s.mesh.mass[i] * state.x[i];
    return Vec3(sum / 0.2);
  };
  Scene unbent = s;
  unbent.bending.reset();
  for (const char* solver : {"jakobsen:precision=double", "xpbd:precision=double", "pd", "implicit",
                             "mass-spring:precision=double"}) {
    const State with = simulate(s, solver, 20), without = simulate(unbent, solver, 20);
    EXPECT_LT((centre(with) - centre(without)).norm(), 1e-8) << solver;
    EXPECT_GT(largest_distance(with.x, without.x), 1e-5) << solver;
  }
  for (const char* solver : {"jakobsen:", "xpbd:", "vbd:"}) {
    const std::string name = solver;
    const State one = simulate(s, name + "simd=scalar", 5);
    for (const char* how : {"simd=auto", "threads=2", "threads=5"})
      EXPECT_EQ(largest_distance(one.x, simulate(s, name + how, 5).x), 0) << name << how;
  }
}

// The shortest wave, from vertex to vertex, decides: h < 2/w, w^2 ~ 64 B/(m/A l^4).
TEST(Bending, ExplicitStepsAreStableUpToLinearTheory) {
  Scene s = hanging_sheet(8, 8, {true, false, false});
  s.bending = Bending{0.02, 0.02, kWarp};
  s.gravity = Vec3::Zero();
  s.start.x = crumpled(s, 1e-9).start.x;
  const auto grown = [&](double factor) {
    Scene faster = s;
    const std::string solver = "mass-spring:substeps=1,structural=1,precision=double";
    faster.dt = 1e-4;
    const auto slow = linear_stability(faster, parse_solver(solver));
    faster.dt = factor * 1e-4 / std::sqrt(slow->margin);
    EXPECT_EQ(linear_stability(faster, parse_solver(solver))->stable(), factor < 1);
    return largest_distance(simulate(faster, solver, 100).x, s.mesh.rest);
  };
  EXPECT_LT(grown(0.99), 1e-7);
  EXPECT_GT(grown(1.01), 1e-3);
}

}  // namespace
}  // namespace taut::bending_test
