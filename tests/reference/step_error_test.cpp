// Estimated distance from the exact step, compared with the true distance.
#include "core/reference/step_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/reference/implicit_step.hpp"
#include "experiments/case/case.hpp"
#include "experiments/metrics/metric.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::step_error_test {
namespace {

constexpr double kRigidLinks = std::numeric_limits<double>::infinity();

double rms_of_free(const Scene& scene, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!is_pinned(scene, static_cast<int>(i))) {
      sum += (a[i] - b[i]).squaredNorm();
      ++n;
    }
  return std::sqrt(sum / static_cast<double>(n));
}

/// Displaces each vertex by up to `amount` [m], irregularly.
std::vector<Vec3> pushed(const Scene& scene, std::vector<Vec3> x, double amount) {
  Scene moved = scene;
  moved.start.x = std::move(x);
  return crumpled(moved, amount).start.x;
}

TEST(StepError, IsTheDistanceFromTheExactStepOfElasticLinks) {
  for (const unsigned seed : {1u, 2u, 3u, 4u})
    for (const double k : {1e3, 1e5}) {
      Scene scene = irregular_net(seed);
      const Stiffness all{k, k, k / 10};
      const ElasticStep step(scene, {k, k, k / 10});
      const std::vector<Vec3> exact = step.minimum();
      reference::StepError error(scene, all);
      for (const double amount : {1e-5, 1e-3}) {
        const std::vector<Vec3> x = pushed(scene, exact, amount);
        const auto estimate = error.of(scene.start, 0, scene.dt, x);
        EXPECT_TRUE(estimate.believed);
        EXPECT_NEAR(estimate.distance / rms_of_free(scene, x, exact), 1, 0.1)
            << seed << ", " << k << " N/m, " << amount;
      }
      EXPECT_LT(error.of(scene.start, 0, scene.dt, exact).distance, 1e-9);
    }
}

/// A frozen cloth keeps its links' lengths: the distance detects it, strain does not.
TEST(StepError, TellsAFrozenClothFromARightOne) {
  Scene scene = hanging_sheet(9, 9);
  scene.stiffness = {1e6, 1e6, 1e4};
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.x[i] = {scene.start.x[i].x(), 0, -scene.start.x[i].y()};  // swung out to the side
  scene.start = simulate(scene, "implicit", 20);
  const std::vector<Vec3> frozen = after_one_step(scene, "pd:iterations=10").x,
                          right = after_one_step(scene, "implicit:iterations=100").x;
  reference::StepError error(scene, scene.stiffness);
  const auto of_frozen = error.of(scene.start, 0, scene.dt, frozen);
  EXPECT_NEAR(of_frozen.distance / rms_of_free(scene, frozen, right), 1, 0.05);
  EXPECT_GT(of_frozen.distance, 5e-4);
  EXPECT_LT(error.of(scene.start, 0, scene.dt, right).distance, 1e-8);
}

TEST(StepError, OfRigidLinksIsTheDistanceFromTheNearest) {
  Scene scene = hanging_sheet(6, 6, {true, false, false});
  scene.pins = {0};  // a row between two pins would resist in second order only
  scene.stiffness = {1e5, 1e5, 1e5};
  scene.start = simulate(scene, "implicit", 20);
  scene.stiffness = kRigid;
  const Stiffness rigid{kRigidLinks, kRigidLinks, kRigidLinks};
  const reference::ImplicitStep step(scene, scene.start, 0, rigid);
  const auto exact = step.minimum(scene.start.x);
  ASSERT_EQ(exact.problem, "");
  reference::StepError error(scene, rigid);
  for (const char* solver :
       {"jakobsen:iterations=4,substeps=1", "xpbd:iterations=16,substeps=1", "admm:iterations=4"}) {
    const std::vector<Vec3> x = after_one_step(scene, solver).x;
    const auto estimate = error.of(scene.start, 0, scene.dt, x);
    EXPECT_TRUE(estimate.believed) << solver;
    EXPECT_NEAR(estimate.distance / rms_of_free(scene, x, exact.x), 1, 0.1) << solver;
  }
  EXPECT_LT(error.of(scene.start, 0, scene.dt, exact.x).distance, 1e-7);
}

/// Only `implicit` computes an exact step with bending; its exactness is checked by other tests.
TEST(StepError, OfABentClothKnowsItsBending) {
  Scene scene = hanging_sheet(6, 6);
  scene.stiffness = {1e3, 1e3, 10};
  scene.bending = Bending{.warp = 1e-3, .weft = 1e-3};
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.v[i] = {
        0, 0, is_pinned(scene, static_cast<int>(i)) ? 0 : std::sin(7 * static_cast<double>(i))};
  const std::vector<Vec3> exact = after_one_step(scene, "implicit:iterations=100").x;
  reference::StepError error(scene, scene.stiffness);
  EXPECT_LT(error.of(scene.start, 0, scene.dt, exact).distance, 1e-8);
  const std::vector<Vec3> x = pushed(scene, exact, 1e-4);
  EXPECT_NEAR(error.of(scene.start, 0, scene.dt, x).distance / rms_of_free(scene, x, exact), 1,
              0.05);
}

/// Particle on a slope, whose exact step has a closed form.
TEST(StepError, InContactHoldsWhatPushesAndRubsWhatSlips) {
  Scene scene;
  scene.name = "slope";
  const double slope = std::atan(0.5), h = 1.0 / 64, g = 9.81;
  scene.mesh.rest = {Vec3(0, 0, 0)};
  scene.mesh.mass = {0.3};
  scene.start = {{Vec3(0, 0, 0)}, {Vec3(0, 0, 0)}};
  scene.dt = h;
  scene.steps = 1;
  const Vec3 normal(std::sin(slope), std::cos(slope), 0),
      down(std::cos(slope), -std::sin(slope), 0);
  scene.colliders = {{.shape = Plane{normal, 0}}};
  for (const double friction : {0.0, 0.3, 0.7}) {
    scene.colliders[0].friction = friction;
    const double slides = std::max(0.0, g * h * h * (std::sin(slope) - friction * std::cos(slope)));
    reference::StepError error(scene, {1, 1, 1});
    const Vec3 exact = slides * down;
    EXPECT_LT(error.of(scene.start, 0, h, {exact}).distance, 1e-6) << friction;
    for (const Vec3& off : {Vec3(2e-4 * down), Vec3(1e-3 * normal), Vec3(-1e-3 * normal),
                            Vec3(0, 0, 3e-4), Vec3(-2e-4 * down)}) {
      const auto estimate = error.of(scene.start, 0, h, {exact + off});
      EXPECT_TRUE(estimate.believed) << friction << ", " << off.transpose();
      EXPECT_NEAR(estimate.distance, off.norm(), 2e-6) << friction << ", " << off.transpose();
    }
  }
}

TEST(StepError, OfASheetThatLiesOnABodyIsThatOfTheReference) {
  for (const double friction : {0.0, 0.3}) {
    Scene scene;
    scene.name = "lying";
    scene.mesh = make_sheet({.nu = 9,
                             .nv = 9,
                             .width = 0.5,
                             .height = 0.5,
                             .origin = {-0.26, 0.21, -0.23},
                             .v = Vec3::UnitZ(),
                             .mass = 0.1});
    scene.start = {scene.mesh.rest, std::vector<Vec3>(81, Vec3::Zero())};
    scene.links = grid_links(scene.mesh, {true, true, false});
    scene.stiffness = {200, 200, 200};
    scene.dt = 1.0 / 64;
    scene.steps = 1;
    scene.thickness = 0.005;
    scene.colliders = {{.shape = Ball{{0, 0, 0}, 0.2}, .motion = {}, .friction = friction}};
    scene.start = simulate(scene, "implicit", friction > 0 ? 40 : 14);
    const auto exact =
        reference::ImplicitStep(scene, scene.start, 0, scene.stiffness).minimum(scene.start.x);
    ASSERT_EQ(exact.problem, "");
    reference::StepError error(scene, scene.stiffness);
    for (const char* solver :
         {"pd:iterations=3", "vbd:iterations=3", "xpbd:substeps=1,iterations=3"}) {
      const std::vector<Vec3> x = after_one_step(scene, solver).x;
      const auto estimate = error.of(scene.start, 0, scene.dt, x);
      EXPECT_TRUE(estimate.believed) << solver << friction;
      EXPECT_NEAR(estimate.distance / rms_of_free(scene, x, exact.x), 1, 0.25)
          << solver << ", friction " << friction;
    }
  }
}

/// On slack cloth, steps of Newton's method with a clamped Hessian shrink by a factor; the error
/// sums the steps that are still to come.
TEST(StepError, OfSlackClothSumsWhatIsStillToCome) {
  Scene scene = hanging_sheet(6, 6);
  scene.stiffness = {1e3, 1e3, 1e3};
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    scene.start.x[i] *= 0.97;
    if (is_pinned(scene, static_cast<int>(i))) scene.start.x[i] = scene.mesh.rest[i];
    if (!is_pinned(scene, static_cast<int>(i)))
      scene.start.x[i].z() = 0.02 * std::sin(3 * static_cast<double>(i));
  }
  const std::vector<Vec3> exact = after_one_step(scene, "implicit:iterations=200").x;
  reference::StepError error(scene, scene.stiffness);
  int within = 0, all = 0;
  for (const char* solver :
       {"pd:iterations=2", "pd:iterations=8", "vbd:iterations=4", "admm:iterations=4",
        "xpbd:substeps=1,iterations=4", "implicit:iterations=2", "implicit:iterations=3"}) {
    const std::vector<Vec3> x = after_one_step(scene, solver).x;
    const double distance = error.of(scene.start, 0, scene.dt, x).distance;
    within += std::abs(distance / rms_of_free(scene, x, exact) - 1) <= 0.1;
    ++all;
  }
  EXPECT_EQ(within, all);
}

TEST(StepError, OfPlacesThatAreNoNumbersIsNone) {
  const Scene scene = hanging_sheet(3, 3);
  reference::StepError error(scene, {1e3, 1e3, 1e3});
  std::vector<Vec3> x = scene.start.x;
  x[4].y() = std::nan("");
  EXPECT_FALSE(error.of(scene.start, 0, scene.dt, x).believed);
}

// Tests of the metric.

struct Measured {
  std::map<std::string, double> values;
  std::string remark;
};
/// Values of the metric that has the value `of`, and its remark.
Measured measured(const Scene& scene, const std::string& solver,
                  const std::string& of = "step.error") {
  const auto [entry, value] = find_value(of);
  const auto metric = entry->make(scene);
  const SolverChoice choice = parse_solver(solver);
  metric->declare(declared_step(*choice.entry, scene, choice.params));
  const auto instance = choice.entry->make(scene, choice.params);
  instance->load(scene.start);
  State state;
  int step = 0;
  instance->visit_substeps([&](double t) {
    if (!metric->follows(step)) return;
    instance->store(state);
    metric->observe_within({step, t, state});
  });
  for (step = 0; step <= scene.steps; ++step) {
    if (step > 0) instance->step((step - 1) * scene.dt, scene.dt);
    instance->store(state);
    metric->observe({step, step * scene.dt, state});
  }
  Measured out{{}, metric->remark()};
  const std::vector<double> numbers = metric->finish();
  for (std::size_t k = 0; k < numbers.size(); ++k)
    out.values[std::string(entry->values[k].name)] = numbers[k];
  return out;
}

Scene swinging() {
  Scene scene = hanging_sheet(8, 8);
  scene.stiffness = {1e4, 1e4, 100};
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.x[i] = {scene.start.x[i].x(), 0, -scene.start.x[i].y()};
  return scene;
}

TEST(StepErrorMetric, IsZeroOfTheExactSolverAndOfEachOfItsSubsteps) {
  const Scene scene = swinging();
  for (const char* solver : {"implicit", "implicit:substeps=4"}) {
    const Measured of = measured(scene, solver);
    EXPECT_LT(of.values.at("step.error.peak"), 1e-7) << solver;
    EXPECT_EQ(of.values.at("step.error.believed"), 1) << solver;
    EXPECT_EQ(of.remark, "from one implicit Euler step of a substep");
  }
  EXPECT_GT(measured(scene, "pd:iterations=5,substeps=4").values.at("step.error"), 1e-6);
}

/// Newton's last step is here longer than the one before. As the start of a geometric series it
/// made 1.6 m of 23 mm, and the step was believed.
TEST(StepErrorMetric, StepsThatGrowHaveNoSum) {
  const Case one = make_case({"box", {"cloth.thickness=0.005", "time.duration=1"}, "admm"});
  const Measured of = measured(*one.scene, "admm");
  EXPECT_EQ(of.values.at("step.error.believed"), 0.5);
  EXPECT_LT(of.values.at("step.error.peak"), 0.05);
}

TEST(StepErrorMetric, SaysWhyThereIsNone) {
  Scene scene = swinging();
  for (const auto& [solver, why] :
       {std::pair<const char*, const char*>{"mass-spring", "no value: it is explicit"},
        {"vbd:damping=0.1", "no value: the exact step leaves out its damping"}}) {
    const Measured of = measured(scene, solver);
    EXPECT_EQ(of.remark, why);
    EXPECT_TRUE(std::isnan(of.values.at("step.error"))) << solver;
  }
  scene.self_collision = SelfCollision{.radius = 0.001};
  EXPECT_EQ(measured(scene, "pd").remark, "no value: the exact step leaves out self-collision");
  EXPECT_EQ(measured(scene, "pd:self=off").remark, "from one implicit Euler step of a substep");
  Scene large = hanging_sheet(52, 52);
  large.steps = 1;
  EXPECT_EQ(measured(large, "jakobsen").remark, "no value: more than 2500 free vertices");
}

}  // namespace
}  // namespace taut::step_error_test
