// Every solver in core/solver against a second implementation, step for step, with moving and
// turning pins and colliders, wind, damping, substeps, friction and accelerators.
#include "tests/solver/second_implementation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/model/text.hpp"
#include "tests/support/cloths.hpp"

namespace taut::second_implementation_test {
namespace {

using second::Cloth;
using second::Relaxing;

/// Sheet whose vertices have different masses and random starts, with moving pins and wind; all
/// masses are multiplied by `heavier`.
Scene busy_sheet(bool shear, bool bend, double heavier = 1) {
  Scene s = crumpled(hanging_sheet(6, 5, {true, shear, bend}), 0.03);
  for (std::size_t i = 0; i < s.mesh.mass.size(); ++i) {
    s.mesh.mass[i] *= heavier * (0.5 + static_cast<double>(i * 7 % 11) / 6);
    s.start.v[i] = Vec3(std::sin(0.3 * double(i)), std::cos(0.7 * double(i)), 0.5);
  }
  s.gravity = {0.5, -9, 1};
  s.damping = 0.7;
  s.pins = {0, 1, 5, 14, 29};
  s.pin_motions = {
      {{5},
       {.velocity = {-0.4, 0.1, 0.3},
        .path = {{0.05, {0.1, 0, 0}}, {0.2, {0, 0.2, 0}}, {0.3, {0, 0, -0.1}}}}},
      {{14, 29}, {.velocity = {0, 0.2, 0}, .spin = {0.5, 1, -2}, .pivot = {0.5, -0.2, 0.1}}}};
  return s;
}

void expect_same_path(const Scene& scene, const std::string& solver, Relaxing second,
                      int steps = 25) {
  const SolverChoice choice = parse_solver(solver);
  const auto first = choice.entry->make(scene, choice.params);
  first->load(scene.start);
  State state;
  for (int n = 0; n < steps; ++n) {
    first->step(n * scene.dt, scene.dt);
    second.step(n * scene.dt);
    first->store(state);
    ASSERT_LT(largest_distance(state.x, second.state().x), 1e-10) << solver << " step " << n;
    ASSERT_LT(largest_distance(state.v, second.state().v), 1e-7) << solver << " step " << n;
  }
  EXPECT_GT(largest_distance(state.x, scene.start.x), 0.1) << solver;
}

std::string in_double(const std::string& params) {
  return "jakobsen:precision=double,projection=exact,order=mesh," + params;
}

TEST(SecondImplementation, OfPinsWindDampingAndSubsteps) {
  for (const int substeps : {1, 3}) {
    Scene scene = busy_sheet(true, true);
    scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2};
    const std::string params = "iterations=4,substeps=" + std::to_string(substeps);
    expect_same_path(scene, in_double(params),
                     Relaxing(scene, {.iterations = 4, .substeps = substeps}));
    expect_same_path(scene, in_double(params + ",omega=0.8"),
                     Relaxing(scene, {.iterations = 4, .substeps = substeps, .omega = 0.8}));
  }
}

// Masses above 1 kg give inverse masses below 1; all other tests have inverse masses far above 1.
TEST(SecondImplementation, OfHeavyCloth) {
  Scene scene = busy_sheet(true, true, 1000);
  scene.thickness = 0.02;
  scene.colliders = {{.shape = Ball{{0.4, -0.4, 0.2}, 0.15}, .friction = 0.3}};
  for (const double w : inverse_masses(scene)) ASSERT_LT(w, 1);
  expect_same_path(scene, in_double("iterations=2,substeps=2,levels=3,tethers=on"),
                   Relaxing(scene, {.iterations = 2, .substeps = 2, .tethers = true, .levels = 3}));
  expect_same_path(
      scene, "xpbd:precision=double,order=mesh,iterations=3,substeps=2,shear=1e-5",
      Relaxing(scene, {.iterations = 3, .substeps = 2, .compliance = {{Family::shear, 1e-5}}}));
}

TEST(SecondImplementation, OfTethersAndLevels) {
  for (const bool shear : {true, false}) {  // a sheet and a net, which have other shortest paths
    Scene scene = busy_sheet(shear, true);
    expect_same_path(scene, in_double("iterations=2,substeps=2,tethers=on"),
                     Relaxing(scene, {.iterations = 2, .substeps = 2, .tethers = true}));
    for (const int levels : {2, 3, 4})
      expect_same_path(scene, in_double("iterations=2,substeps=1,levels=" + std::to_string(levels)),
                       Relaxing(scene, {.iterations = 2, .levels = levels}));
    expect_same_path(
        scene, in_double("iterations=2,substeps=2,levels=3,tethers=on,omega=1.2"),
        Relaxing(scene,
                 {.iterations = 2, .substeps = 2, .tethers = true, .levels = 3, .omega = 1.2}));
  }
}

/// One collider of each kind, moving, turning and with friction, below and in front of the sheet.
std::vector<Collider> moving_colliders(double friction) {
  return {{.shape = Plane{Vec3(0.2, 1, 0.1).normalized(), -0.5},
           .motion = {.velocity = {0.3, 0.2, 0}, .spin = {0.3, 0.2, -0.5}, .pivot = {1, 0, 2}},
           .friction = friction},
          {.shape = Ball{{0.4, -0.4, 0.2}, 0.15},
           .motion = {.velocity = {0, 0, -0.5}, .spin = {1, 4, 2}, .pivot = {0.4, -0.3, 0.2}},
           .friction = 0.7 * friction},
          {.shape = Box{{0.8, -0.3, -0.25},
                        {0.2, 0.1, 0.15},
                        Eigen::Quaterniond(0.9, 0.1, 0.3, -0.2).normalized()},
           .motion = {.spin = {2, 0.5, -1},
                      .pivot = {0.8, -0.2, 0},
                      .path = {{0, {0, 0, 0}}, {0.5, {0, 0.1, 0.4}}}},
           .friction = 0.5 * friction},
          {.shape = Capsule{{0.1, -0.7, 0.15}, {0.5, -0.8, 0.2}, 0.1},
           .motion = {.velocity = {0, 0.1, -0.4}, .spin = {1, -2, 0.5}, .pivot = {0.3, -0.7, 0}},
           .friction = 0.6 * friction}};
}

TEST(SecondImplementation, OfContactWithWhatMovesTurnsAndRubs) {
  for (const int substeps : {1, 3}) {
    Scene scene = busy_sheet(true, false);
    scene.thickness = 0.02;
    for (const Collider& collider : moving_colliders(0.4)) {
      scene.colliders = {collider};
      const std::string params = "iterations=3,substeps=" + std::to_string(substeps);
      expect_same_path(scene, in_double(params + ",contact=discrete"),
                       Relaxing(scene, {.substeps = substeps}), 30);
      // no vertex passes through these; vertices enter boxes
      if (!std::holds_alternative<Box>(collider.shape))
        expect_same_path(scene, in_double(params + ",contact=continuous"),
                         Relaxing(scene, {.substeps = substeps}), 30);
      expect_same_path(scene, in_double(params + ",contact=after"),
                       Relaxing(scene, {.substeps = substeps, .contact_in_sweeps = false}), 30);
    }
    scene.colliders = moving_colliders(0.4);
    expect_same_path(
        scene, in_double("iterations=2,substeps=" + std::to_string(substeps) + ",contact=discrete"),
        Relaxing(scene, {.iterations = 2, .substeps = substeps}), 30);
  }
}

TEST(SecondImplementation, OfTheOctree) {
  Scene scene = busy_sheet(true, false);
  for (const double radius : {0.1, 0.13, 0.2}) {
    scene.self_collision = SelfCollision{.radius = radius};
    expect_same_path(scene, in_double("iterations=2,substeps=2,self=octree"),
                     Relaxing(scene, {.iterations = 2, .substeps = 2, .octree = true}));
    EXPECT_GT(largest_distance(simulate(scene, in_double("iterations=2,self=octree"), 9).x,
                               simulate(scene, in_double("iterations=2,self=off"), 9).x),
              1e-3)
        << "some of them meet";
  }
}

TEST(SecondImplementation, OfXpbd) {
  for (const int substeps : {1, 4}) {
    Scene scene = busy_sheet(true, true);
    scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2};
    scene.thickness = 0.02;
    scene.colliders = moving_colliders(0.4);
    for (const int iterations : {1, 3})  // a single iteration does not use multipliers
      expect_same_path(scene,
                       "xpbd:precision=double,order=mesh,contact=discrete,structural=0.0001,"
                       "shear=0.002,bend=0.05,substeps=" +
                           std::to_string(substeps) + ",iterations=" + std::to_string(iterations),
                       Relaxing(scene, {.iterations = iterations,
                                        .substeps = substeps,
                                        .compliance = {{Family::structural, 0.0001},
                                                       {Family::shear, 0.002},
                                                       {Family::bend, 0.05}}}),
                       30);
  }
}

// Checks springs with F = -k x - c v on every particle; the velocity after a step is (x - x')/h.
void expect_springs(const std::string& integrator, double heavier) {
  const std::map<Family, double> stiffness{{Family::structural, 20 * heavier},
                                           {Family::shear, 9 * heavier},
                                           {Family::bend, 3 * heavier}};
  Scene scene = busy_sheet(true, true, heavier);
  scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.05 * heavier};
  const int substeps = 8;
  const double h = scene.dt / substeps, drag = 0.01 * heavier, keep = std::exp(-scene.damping * h);
  const bool central = integrator.ends_with("central");
  Cloth second(scene);
  const SolverChoice choice =
      parse_solver("mass-spring:precision=double,substeps=8,drag=" + shortest(drag) +
                   ",structural=" + shortest(20 * heavier) + ",shear=" + shortest(9 * heavier) +
                   ",bend=" + shortest(3 * heavier) + ",integrator=" + integrator);
  const auto first = choice.entry->make(scene, choice.params);
  first->load(scene.start);
  State state;
  for (int n = 0; n < 30; ++n) {
    for (int s = 1; s <= substeps; ++s) {
      auto a = second.accelerations(second.v);
      for (const Link& l : scene.links) {
        const Vec3 along = second.x[to_index(l.b)] - second.x[to_index(l.a)],
                   force = stiffness.at(l.family) * (along.norm() - l.rest) * along.normalized();
        a[to_index(l.a)] += second.w[to_index(l.a)] * force;
        a[to_index(l.b)] -= second.w[to_index(l.b)] * force;
      }
      for (std::size_t i = 0; i < a.size(); ++i) {
        const double cm = second.w[i] * drag;
        Vec3 &x = second.x[i], &v = second.v[i];
        if (second.w[i] == 0) {
          v.setZero();
        } else if (integrator == "explicit-euler") {
          x += h * v;
          v = keep * v + h * (a[i] - cm * v);
        } else {
          // central: v' = keep v + h (a - c/m (keep v + v')/2)
          v = central ? Vec3((keep * v * (1 - cm * h / 2) + h * a[i]) / (1 + cm * h / 2))
                      : Vec3(keep * v + h * (a[i] - cm * v));
          x += h * v;
        }
      }
      const std::vector<Vec3> before = second.x;
      second.move_pins(n * scene.dt + s * h);
      for (const PinMotion& group : scene.pin_motions)
        for (const int pin : group.vertices)
          second.v[to_index(pin)] = (second.x[to_index(pin)] - before[to_index(pin)]) / h;
    }
    first->step(n * scene.dt, scene.dt);
    first->store(state);
    ASSERT_LT(largest_distance(state.x, second.x), 1e-10) << integrator << " step " << n;
    ASSERT_LT(largest_distance(state.v, second.v), 1e-7) << integrator << " step " << n;
  }
  EXPECT_GT(largest_distance(state.x, scene.start.x), 0.1);
}

TEST(SecondImplementation, OfSprings) {
  for (const std::string integrator :
       {"explicit-euler", "symplectic-euler", "verlet", "verlet,drag-at=central"})
    for (const double heavier : {1, 1000}) expect_springs(integrator, heavier);
}

}  // namespace
}  // namespace taut::second_implementation_test
