// Reports of solvers about a scene: the settings in effect, refusals with their reasons, and the
// applicable theory.
#include "tests/support/settings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "core/reference/linear_stability.hpp"
#include "core/solver/simd/kernels.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"
#include "tests/support/numbers.hpp"

namespace taut::solver_settings_test {
namespace {

Scene with_contact() {
  Scene scene = hanging_sheet(3, 3);
  scene.damping = 0.5;
  scene.colliders = {{.shape = Ball{{9, 9, 9}, 1}, .friction = 0.5}};
  scene.self_collision = SelfCollision{0.01};
  return scene;
}

TEST(SolverSettings, OfJakobsenAreTheseLines) {
  const Lines plain{{"time step", "0.00390625 s x 4"},
                    {"integration", "Verlet"},
                    {"projection", "exact, weighted by inverse mass"},
                    {"link order", "the scene's"},
                    {"gravity", "the scene's"},
                    {"precision", "double"}};
  EXPECT_EQ(settings(hanging_sheet(3, 3),
                     "jakobsen:substeps=4,projection=exact,precision=double,order=mesh"),
            plain);
  const Lines all{{"time step", "0.0078125 s x 2"},
                  {"integration", "Verlet"},
                  {"projection", "sqrt-free, weighted by inverse mass"},
                  {"link order", "coloured (links of a colour share no vertex)"},
                  {"gravity", "the scene's"},
                  {"precision", "float"},
                  {"damping", "velocity x " + shortest(std::exp(-0.5 / 128)) + " per substep"},
                  {"contact response", "discrete"},
                  {"friction", "Coulomb: tangential correction at most mu times the depth"},
                  {"contact distance", "the scene's thickness"},
                  {"contact of faces", "on"},
                  {"self-collision", "octree"}};
  EXPECT_EQ(settings(with_contact(), "jakobsen:substeps=2,contact=discrete,faces=on,self=octree"),
            all);
}

/// A sheet 1000 m from the origin falls for a tenth of a second, too short to change its
/// coordinate's exponent.
TEST(SolverSettings, SayHowFarGravityIsOffInFloatAndItIs) {
  Scene scene = hanging_sheet(3, 3);
  scene.pins.clear();
  for (Vec3& x : scene.mesh.rest) x.y() += 1000;
  scene.start.x = scene.mesh.rest;
  scene.dt = 1.0 / 64;
  scene.steps = 6;
  const double fall = scene.gravity.norm() * scene.duration();
  double worst = 0;
  for (const int substeps : {1, 2, 3}) {
    const std::string solver = "jakobsen:iterations=0,substeps=" + std::to_string(substeps);
    std::string said = settings(scene, solver).back().second;
    const CaseRun run = run_case(scene, parse_solver(solver));
    const double off = std::abs(run.last.v[0].y() + fall) / fall;
    if (said != "float") {
      EXPECT_EQ(said.substr(0, said.find(" by up to")),
                "float: rounding in coordinates of 1000 m changes gravity")
          << said;
      said.erase(0, said.find("up to ") + 6);
    }
    EXPECT_LE(off, said == "float" ? 0.01 : 0.01 * number_at(said) + 0.005) << solver;
    worst = std::max(worst, off);
  }
  EXPECT_GT(worst, 0.03);
  EXPECT_EQ(settings(scene, "jakobsen:substeps=8,precision=double").back().second, "double");
}

TEST(SolverSettings, OfTheOthersAreTheseLines) {
  EXPECT_EQ(settings(hanging_sheet(3, 3), "mass-spring:structural=7,bend=0.5"),
            (Lines{{"time step", "0.00048828125 s x 32"},
                   {"integration", "Verlet"},
                   {"links", "Hooke springs: structural 7 N/m, shear 50 N/m, bend 0.5 N/m"},
                   {"work unit", "spring evaluations, not projections"},
                   {"gravity", "the scene's"},
                   {"precision", "double"}}));
  Scene elastic = hanging_sheet(3, 3);
  EXPECT_EQ(settings(elastic, "xpbd:precision=double,shear=0.5,order=mesh"),
            (Lines{{"time step", "0.001953125 s x 8"},
                   {"integration", "Verlet"},
                   {"projection", "exact, multipliers keep"},
                   {"links", "compliance in m/N: structural 0, shear 0.5, bend 0"},
                   {"link order", "the scene's"},
                   {"gravity", "the scene's"},
                   {"precision", "double"}}));
  const auto links = [&](const std::string& solver) {
    for (const auto& [name, text] : settings(elastic, solver))
      if (name == "links") return text;
    return std::string();
  };
  elastic.stiffness = {500, 50, kRigid[2]};
  EXPECT_EQ(links("xpbd:shear=0.5"), "compliance in m/N: structural 0.002, shear 0.02, bend 0");
  EXPECT_EQ(links("xpbd:shear=0.5,material=own"),
            "compliance in m/N: structural 0, shear 0.5, bend 0");
  elastic.stiffness[2] = 5;
  EXPECT_EQ(links("mass-spring"), "Hooke springs: structural 500 N/m, shear 50 N/m, bend 5 N/m");
  EXPECT_EQ(links("mass-spring:material=own"),
            "Hooke springs: structural 50 N/m, shear 50 N/m, bend 5 N/m");
}

TEST(SolverRefusals, AreSaidForEachThingThatASolverWouldMisread) {
  Scene scene = with_contact();
  for (const char* solver : {"jakobsen", "xpbd", "mass-spring", "mass-spring:drag-at=central"})
    EXPECT_TRUE(refused(scene, solver).empty()) << solver;
  EXPECT_EQ(refused(scene, "mass-spring:drag-at=central,integrator=symplectic-euler"),
            std::vector<std::string>{"drag-at=central needs integrator=verlet"});
}

// Coordinates just below 1 m are rounded to multiples of 2^-24 m: g (dt/n)^2 is four of them at
// least, which loses an eighth at most, up to n = 100.
TEST(SolverRefusals, OfSubstepsThatFloatLosesSayHowManyItKeeps) {
  Scene scene = hanging_sheet(3, 3);
  const auto reason = [&](int substeps) {
    const auto reasons = refused(scene, "jakobsen:substeps=" + std::to_string(substeps));
    return reasons.empty() ? "" : reasons.front();
  };
  EXPECT_EQ(reason(100), "");
  EXPECT_EQ(reason(101),
            "float: rounding in coordinates of 1 m changes gravity by up to 13 %: at most 100 "
            "substeps, or precision=double");
  EXPECT_TRUE(refused(scene, "jakobsen:substeps=101,precision=double").empty());
  for (Vec3& x : scene.start.x) x.z() -= 1e6;
  EXPECT_NE(reason(2).find("at most 1 substeps"), std::string::npos);
  scene.gravity.setZero();
  EXPECT_EQ(reason(101), "") << "nothing to lose";
}

/// The limit counts moving vertices, not all vertices.
TEST(SolverSettings, ImplicitFactorsUpToAHundredThousandVertices) {
  Scene scene = hanging_sheet(317, 317);  // 100489
  scene.pins.clear();
  for (const int pins : {488, 489}) {
    while (static_cast<int>(scene.pins.size()) < pins)
      scene.pins.push_back(static_cast<int>(scene.pins.size()));
    std::string solved;
    for (const auto& [name, value] : settings(scene, "implicit"))
      if (name == "links solved") solved = value;
    EXPECT_EQ(solved.ends_with("conjugate gradients"), pins == 488) << solved;
  }
}

TEST(SolverSettings, AnInstructionSetThatTheMachineLacksIsAnError) {
  const Scene scene = hanging_sheet(3, 3);
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512}) {
    const std::string name(to_string(simd));
    const SolverChoice choice = parse_solver("jakobsen:simd=" + name);
    try {
      choice.entry->make(scene, choice.params);
      EXPECT_TRUE(available(simd)) << name;
    } catch (const InputError& error) {
      EXPECT_FALSE(available(simd)) << name;
      EXPECT_EQ(error.what(), "jakobsen: simd=" + name + ": this machine does not have it; its " +
                                  "widest is " + std::string(to_string(widest())));
    }
  }
}

/// Chain on its first vertex, without gravity or damping.
Scene chain(int links) {
  Scene scene = hanging_sheet(1, links + 1, {true, false, false}, Lumping::equal);
  scene.gravity.setZero();
  return scene;
}

TEST(LinearTheory, HoldsForSweepsInTheScenesOrder) {
  const auto growth = [](const Scene& scene, const std::string& solver) -> double {
    const auto theory = linear_stability(scene, parse_solver(solver));
    return theory ? theory->growth : -1;
  };
  const Scene scene = chain(9);
  const double three = growth(scene, listing("iterations=3"));
  EXPECT_NEAR(three, std::pow(std::cos(std::acos(-1.0) / 18), 3), 1e-6) << "rho^(k/2)";
  EXPECT_NEAR(growth(scene, "xpbd:order=mesh,iterations=3,substeps=1"), three, 1e-12);
  EXPECT_NEAR(growth(scene, "bullet:iterations=3"), three, 1e-12);
  const double relaxed = growth(scene, listing("iterations=2,omega=1.2"));
  EXPECT_GT(std::abs(relaxed - growth(scene, listing("iterations=2"))), 1e-3);
  EXPECT_NEAR(growth(scene, "bullet:iterations=2,stiffness=1.2"), relaxed, 1e-12);
  Scene damped = scene, fine = scene;
  damped.damping = fine.damping = 3;
  fine.dt = scene.dt / 4;
  for (const std::string solver :
       {"jakobsen:order=mesh,iterations=2", "xpbd:order=mesh,iterations=2"}) {
    EXPECT_NEAR(growth(damped, solver + ",substeps=4"), growth(fine, solver + ",substeps=1"),
                1e-12);
    EXPECT_LT(growth(damped, solver + ",substeps=1"), growth(damped, solver + ",substeps=4"));
  }
  EXPECT_GT(growth(scene, listing("iterations=1,method=jacobi")), 2);
  for (const char* unknown :
       {"jakobsen", "jakobsen:order=reversed", "xpbd", "xpbd:order=mesh,bend=1",
        "bullet:reorder=on", "bullet-deformable", "jakobsen:order=mesh,method=jacobi-averaged",
        "xpbd:order=mesh,tethers=on"})
    EXPECT_EQ(growth(scene, unknown), -1) << unknown;
  EXPECT_EQ(growth(damped, "bullet"), -1);
  EXPECT_GT(growth(chain(128), listing()), 0);
  EXPECT_EQ(growth(chain(129), listing()), -1) << "too many links for a dense sweep";
}

/// Explicit Euler with drag is stable while no mode grows, including modes across the chain, where
/// no force acts. z = 1 + h l with l^2 + y l + w^2 = 0, y = c/m.
TEST(LinearTheory, OfDraggedExplicitEulerIsThatOfAllModes) {
  const Scene scene = chain(3);
  const double k = 92, mass = 0.05, h = scene.dt;
  int stable = 0, unstable = 0;
  for (double drag = 0.5; drag < 12; drag *= 1.07) {
    double largest = 0;
    for (const int mode : {0, 1, 3, 5}) {  // w^2 = 4 k/m sin^2(mode pi/14)
      const double y = drag / mass,
                   w = 2 * std::sqrt(k / mass) * std::sin(mode * std::acos(-1.0) / 14);
      const std::complex<double> root = std::sqrt(std::complex<double>(y * y / 4 - w * w));
      for (const double sign : {-1.0, 1.0})
        largest = std::max(largest, std::abs(1.0 + h * (-y / 2 + sign * root)));
    }
    const auto theory = linear_stability(
        scene, parse_solver("mass-spring:substeps=1,integrator=explicit-euler,structural=92,drag=" +
                            shortest(drag)));
    ASSERT_TRUE(theory);
    EXPECT_EQ(theory->stable(), largest < 1 + 1e-9) << drag << ": " << largest;
    ++(theory->stable() ? stable : unstable);
  }
  EXPECT_GE(stable, 4);
  EXPECT_GT(unstable, 5);
}

TEST(LinearTheory, OfSpringsKnowsTheirFamiliesAndTheirDrag) {
  Scene scene = hanging_sheet(4, 5);
  scene.gravity.setZero();
  const auto theory = [&](const std::string& more) {
    return linear_stability(scene, parse_solver("mass-spring:substeps=1," + more));
  };
  const double all = theory("structural=40,shear=20,bend=10")->margin;
  EXPECT_NEAR(theory("structural=80,shear=40,bend=20")->margin, 2 * all, 1e-9 * all);
  for (const char* other : {"structural=20,shear=40,bend=10", "structural=40,shear=10,bend=20",
                            "structural=10,shear=20,bend=40"})
    EXPECT_GT(std::abs(theory(other)->margin / all - 1), 1e-4) << other;
  EXPECT_EQ(theory("structural=40")->law, "substep < 2/w, w the fastest mode of the springs");
  EXPECT_EQ(theory("structural=40,drag=1,drag-at=central")->law, theory("structural=40")->law);
  EXPECT_EQ(theory("structural=40,drag=1")->law,
            "substep < (2/w)(sqrt(1 + zeta^2) - zeta), w the fastest mode of the springs");
  const auto euler = theory("structural=40,shear=20,bend=10,integrator=explicit-euler");
  EXPECT_NEAR(euler->growth, std::sqrt(1 + 4 * all), 1e-9) << "margin is w^2 h^2/4";
  EXPECT_EQ(euler->law, "explicit Euler grows by sqrt(1 + w^2 dt^2) at any dt");
  EXPECT_FALSE(theory("integrator=explicit-euler,drag=1"));
  EXPECT_FALSE(theory("structural=0,shear=0,bend=0"));
  scene.wind = Wind{};
  EXPECT_FALSE(theory("structural=40"));
  EXPECT_TRUE((LinearStability{1, 1, ""}).stable());
  EXPECT_FALSE((LinearStability{1.00001, 1, ""}).stable());
}

TEST(Settings, ProductsAreDividedAlikeOnEveryMachine) {
  const SolverChoice choice = parse_solver("jakobsen");
  choice.entry->make(hanging_sheet(3, 3), choice.params);
  EXPECT_EQ(Eigen::l1CacheSize(), 48 << 10) << "a box under `admm` had other bits with 32 KiB";
}

}  // namespace
}  // namespace taut::solver_settings_test
