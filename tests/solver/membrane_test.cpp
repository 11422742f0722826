// The membrane in every solver that has it: one energy, the same step, the same bits.
#include "core/model/membrane.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/larger.hpp"
#include "core/reference/implicit_step.hpp"
#include "core/reference/linear_stability.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/springs.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "core/reference/step_error.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::membrane_solver_test {
namespace {

/// An irregular mesh, stretched, squeezed and in motion, without links, pinned in two vertices.
Scene moving(Membrane::Law law) {
  Scene s = hanging_sheet(5, 6, {false, false, false});
  const Scene places = crumpled(s, 0.04);
  for (std::size_t v = 0; v < s.mesh.rest.size(); ++v) {
    s.mesh.rest[v] = places.start.x[v];
    s.mesh.rest[v].z() = 0;
    s.start.v[v] = Vec3(0.1, 0.2, std::sin(static_cast<double>(v)));
  }
  s.mesh.grid.reset();
  s.start.x = s.mesh.rest;
  s = crumpled(s, 0.02);
  for (const int pin : s.pins) s.start.v[to_index(pin)].setZero();
  s.membrane = Membrane{.law = law, .warp = 300, .weft = 300, .poisson = 0, .shear = 150};
  if (law == Membrane::Law::stvk) {
    s.membrane->weft = 200;
    s.membrane->poisson = 0.3;
    s.membrane->shear = 90;
  }
  return s;
}

Scene damped() {
  Scene s = moving(Membrane::Law::stvk);
  s.membrane->damping = 0.02;
  return s;
}

constexpr Membrane::Law kLaws[] = {Membrane::Law::stvk, Membrane::Law::arap};

/// Gradient of implicit Euler's energy [N] after the step; the membrane's part by differences.
double left(const Scene& s, const std::vector<Vec3>& x) {
  Eigen::VectorXd g = ElasticStep(s, s.stiffness).gradient(x);
  const MembraneModel model = make_membrane(s);
  const auto damping = [&](const std::vector<Vec3>& y) {  // b (e - e_t).C (e - e_t)/(2 h)
    double sum = 0;
    for (const MembraneElement& e : model.elements) {
      const auto strain = [&](const std::vector<Vec3>& z) {
        return model.law.strain(e.deformation([&](std::size_t v) { return z[v]; })).value;
      };
      const Vec3 by = strain(y) - strain(s.start.x);
      sum += e.area * s.membrane->damping / (2 * s.dt) * by.dot(model.law.stiffness() * by);
    }
    return sum;
  };
  for (std::size_t v = 0; v < x.size(); ++v)
    for (int c = 0; c < 3 && !is_pinned(s, static_cast<int>(v)); ++c) {
      const auto moved = [&](double by) {
        std::vector<Vec3> y = x;
        y[v][c] += by;
        return model.energy(y) + damping(y);
      };
      g[3 * static_cast<int>(v) + c] += (moved(1e-6) - moved(-1e-6)) / 2e-6;
    }
  return g.norm();
}

TEST(MembraneSolvers, ImplicitFindsTheMinimum) {
  for (const Membrane::Law law : kLaws) {
    const Scene s = moving(law);
    const State exact = after_one_step(s, "implicit:iterations=200");
    EXPECT_LT(left(s, exact.x), 1e-6);
    EXPECT_GT(left(s, after_one_step(s, "implicit:iterations=0").x), 1e-2) << "it can fail";
  }
}

TEST(MembraneSolvers, EverySolverOfEnergiesTakesTheSameStep) {
  for (const Membrane::Law law : kLaws) {
    Scene s = moving(law);
    for (const bool bent : {false, true}) {
      if (bent) s.bending = Bending{1e-3, 1e-3};
      const State exact = after_one_step(s, "implicit:iterations=200");
      for (const char* solver : {"implicit:iterations=200,linear=cg", "vbd:iterations=1000",
                                 "vbd:iterations=1000,order=mesh", "implicit:start=inertia"})
        EXPECT_LT(largest_distance(exact.x, after_one_step(s, solver).x), 1e-9) << solver;
      if (law == Membrane::Law::arap) {
        for (const char* solver :
             {"pd:iterations=3000", "pd:iterations=300,anderson=5",
              "pd:iterations=300,method=lbfgs", "pd:iterations=1000,method=ncg"})
          EXPECT_LT(largest_distance(exact.x, after_one_step(s, solver).x), 1e-8) << solver;
      }
      EXPECT_LT(
          largest_distance(exact.x, after_one_step(s, "vbd:iterations=1000,precision=float").x),
          1e-5);
    }
  }
}

// XPBD leaves out how the rows J turn within a substep: at least of order h^2.
TEST(MembraneSolvers, XpbdConvergesToTheStepAsTheStepShrinks) {
  for (const Membrane::Law law : kLaws) {
    const auto off = [&](double h) {
      Scene s = moving(law);
      s.start.x = s.mesh.rest;  // at rest, so that it is the step that strains
      s.dt = h;
      return largest_distance(
          after_one_step(s, "implicit:iterations=200").x,
          after_one_step(s, "xpbd:substeps=1,iterations=300,precision=double").x);
    };
    const double coarse = off(1.0 / 128), fine = off(1.0 / 512);
    EXPECT_LT(coarse, 1e-6);
    EXPECT_GT(coarse, 1e-9) << "it can shrink";
    EXPECT_LT(fine, coarse / 16);
  }
}

TEST(MembraneSolvers, MassSpringAddsTheForceOfTheEnergy) {
  for (const Membrane::Law law : kLaws) {
    Scene s = moving(law);
    s.dt = 1e-6;
    const State after = after_one_step(s, "mass-spring:substeps=1");
    const std::vector<double> w = inverse_masses(s);
    const MembraneModel model = make_membrane(s);
    for (std::size_t v = 0; v < w.size(); ++v)
      for (int c = 0; c < 3; ++c) {
        if (w[v] == 0) continue;
        const auto moved = [&](double by) {
          std::vector<Vec3> y = s.start.x;
          y[v][c] += by;
          return model.energy(y);
        };
        const double force = -(moved(1e-6) - moved(-1e-6)) / 2e-6;
        const double got = (after.v[v][c] - s.start.v[v][c]) / s.dt - s.gravity[c];
        EXPECT_NEAR(got, w[v] * force, 1e-3 * (1 + std::abs(got))) << v;
      }
  }
}

TEST(MembraneSolvers, OneThreadAndTwoAndEveryInstructionSetHaveTheSameBits) {
  const Scene s = [] {
    Scene big = crumpled(hanging_sheet(40, 40, {false, false, false}), 0.004);
    big.membrane = Membrane{.warp = 300, .weft = 200, .poisson = 0.2, .shear = 100};
    return big;
  }();
  for (const std::string solver : {"vbd:iterations=4", "vbd:iterations=4,precision=float",
                                   "xpbd:substeps=4", "mass-spring:substeps=64"}) {
    const State one = simulate(s, solver, 3);
    const auto with = [&](const std::string& more) { return simulate(s, solver + "," + more, 3); };
    for (const State& other : {with("threads=2"), with("simd=scalar"), with("simd=sse2")}) {
      EXPECT_EQ(largest_distance(one.x, other.x), 0) << solver;
      EXPECT_EQ(largest_distance(one.v, other.v), 0) << solver;
    }
    EXPECT_GT(largest_distance(one.x, s.start.x), 1e-3) << solver;
  }
}

TEST(MembraneSolvers, ItStandsOnWhatIsInItsWay) {
  Scene s = sheet_above(0.02);
  s.links.clear();
  s.membrane = Membrane{.warp = 100, .weft = 100, .poisson = 0.3, .shear = 100 / 2.6};
  s.colliders = {{.shape = Ball{.center = {0, -0.3, 0.02}, .radius = 0.3}}};
  for (const char* solver : {"implicit", "vbd", "xpbd:substeps=16", "mass-spring:substeps=64"}) {
    const State end = simulate(s, solver, 40);
    double deepest = 0, lowest = 0;
    for (const Vec3& x : end.x) {
      deepest = std::max(deepest, 0.305 - (x - Vec3(0, -0.3, 0.02)).norm());
      lowest = std::min(lowest, x.y());
    }
    EXPECT_LT(deepest, 1e-3) << solver;
    EXPECT_LT(lowest, -0.1) << solver << ": it drapes";
    EXPECT_GT(lowest, -1) << solver << ": it is held";
  }
}

// The largest stable step of explicit integration is 2/w of the fastest mode.
TEST(MembraneSolvers, TheLargestStableStepIsThatOfTheFastestMode) {
  Scene s = hanging_sheet(7, 7, {false, false, false});
  s.gravity.setZero();
  s.membrane = Membrane{.warp = 300, .weft = 200, .poisson = 0.3, .shear = 100};
  for (std::size_t v = 0; v < s.start.v.size(); ++v)
    if (!is_pinned(s, static_cast<int>(v)))
      s.start.v[v] = 1e-7 * Vec3(std::sin(3.0 * static_cast<double>(v)),
                                 std::cos(2.0 * static_cast<double>(v)), 0);
  s.dt = 1e-3;
  const auto margin = [&](double dt) {  // (w dt/2)^2 without damping
    s.dt = dt;
    return linear_stability(s, parse_solver("mass-spring:substeps=1"))->margin;
  };
  const double most = 1e-3 / std::sqrt(margin(1e-3));
  const auto speed_after = [&](double dt) {
    s.dt = dt;
    double fastest = 0;
    for (const Vec3& v : simulate(s, "mass-spring:substeps=1", 3000).v)
      fastest = larger(fastest, v.norm());
    return fastest;
  };
  EXPECT_LT(speed_after(0.98 * most), 1e-4);
  EXPECT_FALSE(speed_after(1.02 * most) < 1);
  s.membrane->damping = most / 2;  // w^2 dt^2 + 2 b w^2 dt = 4, where w = 2/most
  const double less = most * (std::sqrt(1.25) - 0.5);
  EXPECT_NEAR(margin(less), 1, 1e-9);
  EXPECT_LT(speed_after(0.98 * less), 1e-4);
  EXPECT_FALSE(speed_after(1.02 * less) < 1);
}

TEST(MembraneSolvers, TheExactStepIsThatOfImplicitAndStepErrorMeasuresFromIt) {
  for (const Membrane::Law law : kLaws) {
    const Scene s = moving(law);
    const State exact = after_one_step(s, "implicit:iterations=200");
    const auto minimum = reference::ImplicitStep(s, s.start, 0, s.stiffness).minimum(s.start.x);
    EXPECT_EQ(minimum.problem, "");
    EXPECT_LT(largest_distance(minimum.x, exact.x), 1e-9);
    reference::StepError error(s, s.stiffness);
    EXPECT_LT(error.of(s.start, 0, s.dt, exact.x).distance, 1e-9);
    Scene off = s;
    off.start.x = exact.x;
    for (const double amount : {1e-5, 1e-3}) {
      const std::vector<Vec3> x = crumpled(off, amount).start.x;
      double sum = 0;
      for (std::size_t v = 0; v < x.size(); ++v) sum += (x[v] - exact.x[v]).squaredNorm();
      const double rms = std::sqrt(sum / static_cast<double>(x.size() - s.pins.size()));
      const auto estimate = error.of(s.start, 0, s.dt, x);
      EXPECT_TRUE(estimate.believed);
      EXPECT_NEAR(estimate.distance / rms, 1, 0.05) << amount;
    }
  }
}

TEST(MembraneSolvers, DampingIsTheSameEnergyInAll) {
  const Scene s = damped();
  const double at_first = left(s, s.start.x);
  for (const char* solver : {"implicit:iterations=200", "implicit:iterations=200,linear=cg",
                             "vbd:iterations=3000", "vbd:iterations=3000,order=mesh"})
    EXPECT_LT(left(s, after_one_step(s, solver).x) / at_first, 1e-6) << solver;
  Scene undamped = s;
  undamped.membrane->damping = 0;
  const State exact = after_one_step(s, "implicit:iterations=200"),
              other = after_one_step(undamped, "implicit:iterations=200");
  EXPECT_GT(left(s, other.x) / at_first, 0.01);
  const auto minimum = reference::ImplicitStep(s, s.start, 0, s.stiffness).minimum(s.start.x);
  EXPECT_EQ(minimum.problem, "");
  EXPECT_LT(largest_distance(minimum.x, exact.x), 1e-9);
  reference::StepError error(s, s.stiffness);
  EXPECT_LT(error.of(s.start, 0, s.dt, exact.x).distance, 1e-9);
  EXPECT_GT(error.of(s.start, 0, s.dt, other.x).distance, 1e-4);
}

TEST(MembraneSolvers, DampedOnesHaveTheSameBitsForEveryInstructionSetAndNumberOfThreads) {
  const Scene s = damped();
  for (const char* solver : {"vbd:iterations=3", "vbd:iterations=2,precision=float", "xpbd",
                             "mass-spring", "implicit:iterations=3"}) {
    const auto same = [&](const char* more) {
      return largest_distance(simulate(s, solver + std::string(more), 4).x,
                              simulate(s, solver, 4).x) == 0;
    };
    const std::string more = std::string(solver).find(':') == std::string::npos ? ":" : ",";
    for (const char* one : {"simd=scalar", "threads=2"})
      EXPECT_TRUE(same((more + one).c_str())) << solver << ' ' << one;
  }
}

TEST(MembraneSolvers, ReferencesOfMotionHaveIt) {
  for (const Membrane::Law law : kLaws) {
    Scene s = moving(law);
    s.start.x = s.mesh.rest;
    s.dt = 1.0 / 64;
    const State fine = simulate(s, "mass-spring:substeps=1024", 8);
    reference::Shake shake(s, 1.0 / 16384);
    reference::Springs springs(s, 1e6, 1.0 / 16384);
    ASSERT_LT(reference::fastest_vibration(s) / 16384, 1);
    while (shake.time() < 8.0 / 64 - 1e-9) ASSERT_TRUE(shake.step());
    while (springs.time() < 8.0 / 64 - 1e-9) springs.step();
    EXPECT_LT(largest_distance(shake.state().x, fine.x), 2e-4);
    EXPECT_LT(largest_distance(springs.state().x, fine.x), 2e-4);
    EXPECT_GT(largest_distance(s.start.x, fine.x), 0.02);
    EXPECT_TRUE(reference::refuse_dynamic(s).empty());
    ASSERT_EQ(reference::refuse_static(s).size(), 1u);
    EXPECT_NE(reference::refuse_static(s)[0].find("membrane"), std::string::npos);
  }
}

TEST(MembraneSolvers, OthersRefuseItAndSayWhy) {
  const Scene s = moving(Membrane::Law::stvk);
  for (const char* solver : {"jakobsen", "pd", "admm", "avbd", "xpbd:method=global,primal=on",
                             "implicit:multipliers=keep", "vbd:damping=1e-3"}) {
    const SolverChoice choice = parse_solver(solver);
    const auto reasons = choice.entry->unsupported(s, choice.params);
    ASSERT_EQ(reasons.size(), 1u) << solver;
    EXPECT_NE(reasons[0].find("membrane"), std::string::npos) << reasons[0];
  }
  for (const char* solver : {"implicit", "vbd", "xpbd", "mass-spring"}) {
    const SolverChoice choice = parse_solver(solver);
    EXPECT_TRUE(choice.entry->unsupported(s, choice.params).empty()) << solver;
    EXPECT_TRUE(choice.entry->unsupported(damped(), choice.params).empty()) << solver;
  }
  const SolverChoice choice = parse_solver("implicit:integrator=bdf2");
  EXPECT_TRUE(choice.entry->unsupported(s, choice.params).empty());
  EXPECT_EQ(choice.entry->unsupported(damped(), choice.params).size(), 1u);
  for (const auto& reasons :
       {reference::refuse_dynamic(damped()), reference::refuse_springs(damped())})
    EXPECT_EQ(reasons, std::vector<std::string>{"damping of the membrane"});
}

}  // namespace
}  // namespace taut::membrane_solver_test
