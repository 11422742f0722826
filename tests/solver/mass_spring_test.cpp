// Vasilovici's section 3 and XPBD, compared with each other and with their formulas.
#include <gtest/gtest.h>

#include "experiments/truths/truth.hpp"

namespace taut::mass_spring_test {
namespace {

Scene hanging_sheet() {
  Scene s = bare::sheet(8, 8, {.shear = true});
  s.pins = {0, 7};
  s.gravity = {0, -kG, 0};
  s.wind = Wind{{1, 0, 2}, 0.1};
  s.damping = 0.5;
  return s;
}

TEST(MassSpring, SymplecticEulerAndVerletAreTheSameMotion) {
  const Scene s = hanging_sheet();
  Simulation euler(s, mass_spring("symplectic-euler", 0.5, 1e-3));
  Simulation verlet(s, mass_spring("verlet", 0.5, 1e-3));
  euler.step(64);
  verlet.step(64);
  EXPECT_LT(max_distance(euler.state().x, verlet.state().x), 1e-12);
}

TEST(MassSpring, SubstepsAreShorterSteps) {
  Scene s = hanging_sheet(), fine = s;
  fine.dt = s.dt / 4;
  Simulation a(s, with("mass-spring:precision=double", "substeps=4"));
  Simulation b(fine, with("mass-spring:precision=double", "substeps=1"));
  a.step(16);
  b.step(64);
  EXPECT_LT(max_distance(a.state().x, b.state().x), 1e-12);
}

TEST(MassSpring, FloatFollowsDouble) {
  const Scene s = hanging_sheet();
  Simulation a(s, "mass-spring:precision=double"), b(s, "mass-spring:precision=float");
  a.step(32);
  b.step(32);
  EXPECT_LT(max_distance(a.state().x, b.state().x), 1e-4);
}

TEST(MassSpring, SaysWhatItCannot) {
  Scene s = hanging_sheet();
  s.colliders.push_back({Ball{Vec3::Zero(), 1}, {}, 0});
  s.self_collision = SelfCollision{0.01};
  const SolverChoice choice = parse_solver("mass-spring:integrator=explicit-euler,drag-at=central");
  EXPECT_EQ(choice.entry->unsupported(s, choice.params).size(), 1u);
}

TEST(Xpbd, WithoutComplianceItIsJakobsensExactProjection) {
  Scene s = hanging_sheet();
  s.pin_motions.push_back({{7}, {.velocity = Vec3(-0.3, 0, 0)}});
  for (const int substeps : {1, 4}) {
    Simulation a(s, xpbd(substeps));
    Simulation b(s, jakobsen(1, "exact", "substeps=" + std::to_string(substeps)));
    a.step();
    b.step();
    EXPECT_LT(max_distance(a.state().x, b.state().x), 1e-15);
    a.step(63);
    b.step(63);
    EXPECT_LT(max_distance(a.state().x, b.state().x), 1e-10);
    EXPECT_LT(max_distance(a.state().v, b.state().v), 1e-7);
  }
}

TEST(Xpbd, AConvergedCompliantLinkIsASpring) {
  // A mass on a link of compliance alpha rests at alpha m g below the rest length.
  Scene s = bare::chain(1, 1, 0.5);
  s.gravity = {0, -kG, 0};
  s.damping = 4;
  Simulation sim(s, xpbd(4, "structural=0.01"));
  ASSERT_TRUE(settle(sim, 1e-9, 16, 4096));
  EXPECT_NEAR(sim.x(1).y(), -1 - 0.01 * 0.5 * kG, 1e-8);
}

// A link of compliance a rests under m g. If each sweep starts without a multiplier, n sweeps from
// Verlet's prediction leave (at/(w + at))^n of the way to the rest length. If the multiplier is
// kept, they end where the spring ends.
TEST(Xpbd, WithoutMultipliersTheComplianceIsLostBySweeps) {
  Scene s = bare::chain(1, 1, 0.5);
  const double stretch = 0.1, at = 0.01 / (s.dt * s.dt), w = 2;
  s.start.x[1].y() -= stretch;
  for (const int n : {1, 2, 5}) {
    const std::string sweeps =
        "xpbd:substeps=1,precision=double,structural=0.01,iterations=" + std::to_string(n);
    Simulation kept(s, sweeps), reset(s, sweeps + ",multipliers=reset");
    kept.step();
    reset.step();
    EXPECT_NEAR(-kept.x(1).y() - 1, stretch * at / (w + at), 1e-12) << "exact in one sweep";
    EXPECT_NEAR(-reset.x(1).y() - 1, stretch * std::pow(at / (w + at), n), 1e-12) << n;
  }
}

}  // namespace
}  // namespace taut::mass_spring_test
