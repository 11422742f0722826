// One step in contact against the conditions of Signorini and Coulomb, taken from the positions
// alone: what the links and inertia leave over at a vertex is what the collider has to push with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/model/angle.hpp"
#include "core/reference/implicit_step.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::contact_conditions_test {
namespace {

constexpr double kStiffness = 100;  // N/m: stiffer, and pd would take 20 times as long
const std::string kSprings = "structural=100,shear=100,bend=0";

/// A sheet of 9 x 9, half a metre wide, that has fallen on to the collider; without friction it
/// soon slides off.
Scene lying_on(const Shape& shape, double height, double friction, double thickness = 0.005) {
  Scene scene;
  scene.name = "lying";
  scene.mesh = make_sheet({.nu = 9,
                           .nv = 9,
                           .width = 0.5,
                           .height = 0.5,
                           .origin = {-0.26, height, -0.23},
                           .v = Vec3::UnitZ(),
                           .mass = 0.1});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(81, Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {true, true, false});
  scene.dt = 1.0 / 64;
  scene.thickness = thickness;
  scene.colliders = {{.shape = shape, .motion = {}, .friction = friction}};
  scene.start = simulate(scene, "implicit:" + kSprings, friction > 0 ? 40 : 14);
  return scene;
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const double friction : {0.0, 0.3}) {
    all.push_back(lying_on(Ball{{0, 0, 0}, 0.2}, 0.21, friction));
    all.push_back(lying_on(Box{{0, 0, 0}, {0.15, 0.1, 0.12}}, 0.11, friction));
    all.push_back(lying_on(Capsule{{-0.3, 0, 0}, {0.3, 0.1, 0}, 0.1}, 0.2, friction));
    const double slope = 20 * kDegree;  // slides with .3
    all.push_back(lying_on(Plane{{std::sin(slope), std::cos(slope), 0}, 0}, 0.12, friction));
  }
  return all;
}

const char* name_of(const Scene& scene) { return type_name(scene.colliders[0].shape).data(); }

/// How far, in the motion of a vertex by its own inertia [m], x is from the conditions of contact.
double violation(const Scene& scene, const std::vector<Vec3>& x) {
  const ElasticStep step(scene, {kStiffness, kStiffness, 0});
  const Eigen::VectorXd left = step.gradient(x);
  const std::vector<double> w = inverse_masses(scene);
  const Collider& collider = scene.colliders[0];
  double worst = 0;
  int touching = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3 force = left.segment<3>(3 * static_cast<Eigen::Index>(i));
    const double per_force = w[i] * scene.dt * scene.dt;
    const Surface at = surface(collider.shape, x[i]);
    const double gap = at.distance - scene.thickness;
    worst = std::max(worst, -gap);
    if (gap > 1e-7) {
      worst = std::max(worst, per_force * force.norm());
      continue;
    }
    ++touching;
    const double push = at.normal.dot(force);
    const Vec3 rub = force - push * at.normal;
    Vec3 slip = x[i] - scene.start.x[i];
    slip -= at.normal.dot(slip) * at.normal;
    worst = std::max(worst, -per_force * push);
    const double most = collider.friction * std::max(0.0, push);
    if (slip.norm() > 1e-7)
      worst = std::max(worst, per_force * (rub + most * slip.normalized()).norm());
    else
      worst = std::max(worst, per_force * (rub.norm() - most));
  }
  EXPECT_GE(touching, 8) << name_of(scene) << ": or nothing was asked";
  return worst;
}

struct Converged {
  std::string solver;
  int few, many;  ///< iterations
};

/// The same scene, its start moved by what is lost in rounding.
Scene a_rounding_error_apart(Scene scene, int n) {
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.x[i].y() += 1e-13 * std::sin(static_cast<double>(i) * n);
  return scene;
}

/// Implicit's from eight starts: what rounding chooses has to end there, too.
TEST(ContactConditions, HoldForEverySolverOnceItHasConverged) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "half a million iterations; sanitizers see the same code in other tests";
#endif
  const std::vector<Converged> solvers{{"implicit", 1, 100},
                                       {"pd", 10, 20000},
                                       {"vbd", 10, 20000},
                                       {"admm:links=elastic", 10, 20000}};
  for (const Scene& scene : scenes())
    for (const Converged& one : solvers) {
      const auto after = [&](int iterations, int start = 0) {
        const std::string text =
            with(one.solver, kSprings + ",iterations=" + std::to_string(iterations));
        const Scene from = a_rounding_error_apart(scene, start);
        return violation(from, after_one_step(from, text).x);
      };
      const std::string where = one.solver + " on a " + name_of(scene) + ", friction " +
                                std::to_string(scene.colliders[0].friction);
      const int starts = one.solver == "implicit" ? 8 : 1;
      for (int n = 0; n < starts; ++n)
        EXPECT_LT(after(one.many, n), 1e-8) << where << ", start " << n;
      if (!std::holds_alternative<Plane>(scene.colliders[0].shape))  // there it is right at once
      {
        EXPECT_GT(after(one.few), 1e-6) << where;
      }
    }
}

/// A sheet that fell on a rough slope and lies there, pressed together by its weight: nothing is
/// left to move.
TEST(ContactConditions, LetASheetRestOnARoughSlope) {
  const double slope = 0.2;
  for (const int n : {9, 13}) {  // few contacts, and many
    Scene scene;
    scene.name = "slope";
    scene.mesh = make_sheet({.nu = n,
                             .nv = n,
                             .width = 0.5,
                             .height = 0.5,
                             .origin = {-0.26, 0.215, -0.27},
                             .v = Vec3::UnitZ(),
                             .mass = 0.1,
                             .lumping = Lumping::area});
    scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
    scene.links = grid_links(scene.mesh, {true, true, false});
    scene.dt = 1.0 / 64;
    scene.thickness = 0.005;
    scene.stiffness = {1000, 1000, std::numeric_limits<double>::infinity()};
    scene.colliders = {
        {.shape = Plane{{std::sin(slope), std::cos(slope), 0}, 0}, .motion = {}, .friction = 0.3}};
    scene.start = simulate(scene, "implicit", 40);
    scene.damping = 2;
    scene.start = simulate(scene, "implicit", 200);
    for (const std::string solver : {"implicit", "pd", "admm", "vbd"}) {
      double fastest = 0;
      for (const Vec3& v : simulate(scene, solver, 60).v) fastest = std::max(fastest, v.norm());
      EXPECT_LT(fastest, 1e-9) << solver << ", " << n << " x " << n;
    }
  }
}

TEST(ContactConditions, HoldForTheReference) {
  for (const Scene& scene : scenes()) {
    const reference::ImplicitStep step(scene, scene.start, 0, {kStiffness, kStiffness, 0});
    const auto minimum = step.minimum(scene.start.x);
    EXPECT_EQ(minimum.problem, "");
    EXPECT_LT(violation(scene, minimum.x), 1e-9)
        << name_of(scene) << ", friction " << scene.colliders[0].friction;
  }
}

}  // namespace
}  // namespace taut::contact_conditions_test
