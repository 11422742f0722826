// Settings that Bullet's two cloths report about a scene, line by line; their refusals; the largest
// allowed distance of a vertex; and the width of a plane.
#include "tests/support/settings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "tests/support/cloths.hpp"

namespace taut::bullet_ref_settings_test {
namespace {

Lines operator+(Lines a, const Lines& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string six_digits(double value) { return general(value, 6); }

Scene with_everything() {
  Scene scene = hanging_sheet(3, 3);
  scene.damping = 0.5;
  scene.thickness = 0.01;
  scene.wind = Wind{};
  scene.colliders = {{.shape = Plane{Vec3::UnitY(), -9}}, {.shape = Ball{{9, 9, 9}, 1}}};
  return scene;
}

TEST(BulletSettings, OfTheSoftBodyAreTheseLines) {
  const Lines plain{{"library", "Bullet 3.24, double"},
                    {"time step", "0.015625 s x 1, as binary32"},
                    {"precision", "double"},
                    {"integration", "symplectic Euler; the same positions as Verlet"},
                    {"projection", "sqrt-free, weighted by inverse mass, kLST 1"},
                    {"link order", "the scene's"},
                    {"gravity", "the scene's (soft bodies' own default: -10 m/s^2 in y)"},
                    {"damping", "kDP 0 per substep"},
                    {"normals", "off"}};
  EXPECT_EQ(settings(hanging_sheet(3, 3), "bullet:faces=off"), plain);
  const Lines contact{
      {"wind", "our face law through addForce; Bullet's own medium is empty"},
      {"order of passes", "contacts, then links (Bullet's own)"},
      {"contacts", "vertices only, found once per substep at the predicted place"},
      {"margin", "0.03 m (default 0.25)"},
      {"distance field", "trilinear, voxel 0.5 m (default 0.25)"},
      {"contact hardness", "kKHR 0.3"},
      {"friction",
       "holds if the predicted way along the surface in a substep is less than mu times the way "
       "into it; else each contact pass takes the share mu of it, whatever the load"},
      {"plane", "the top of a box of at least 100 m x 10 m x 100 m"}};
  Lines all = plain;
  all[1].second = "0.0078125 s x 2, as binary32";
  all[4].second = "sqrt-free, weighted by inverse mass, kLST 1.5";
  all[7].second = "kDP " + six_digits(1 - std::exp(-0.5 / 128)) + " per substep";
  all[8].second = "computed every substep";
  const std::string solver = "bullet:substeps=2,stiffness=1.5,margin=0.02,voxel=0.5,hardness=0.3,";
  EXPECT_EQ(settings(with_everything(), solver + "order=contacts-first"), all + contact);
  Scene calm = with_everything();
  calm.wind.reset();
  calm.colliders.erase(calm.colliders.begin());
  Lines other = contact;
  other.erase(other.begin());
  other.pop_back();
  other[0].second = "links, then contacts";
  other[5].second = "none";
  EXPECT_EQ(settings(calm, solver + "order=links-first,friction=refuse"), all + other);
}

TEST(BulletSettings, OfTheDeformableBodyAreTheseLines) {
  const Lines start{{"library", "Bullet 3.24, double"},
                    {"time step", "0.00390625 s x 4, as binary32"},
                    {"precision", "double"}},
      middle{{"links", "springs of 250 N/m, all families; the scene's are rigid"},
             {"spring damping", "0.125 N s/m (default 0.05)"},
             {"gravity", "the scene's, by btDeformableGravityForce (default: none)"},
             {"damping", "velocities x exp(-damping h) before each substep"},
             {"NaN", "Bullet turns velocity changes that are not numbers into zero"}},
      implicit{{"integration", "backward Euler, 3 Newton step(s), conjugate gradients"}},
      springs{{"integration", "symplectic Euler, explicit springs"}},
      limit{{"speed limit", "the cloth's bounding box per substep"}},
      wind{{"wind", "our face law, as an impulse before each substep"}},
      contact{{"contacts", "vertices only, found once per substep"},
              {"margin", "0.01 m (default 0.25)"},
              {"distance field", "trilinear, voxel 0.05 m (default 0.005)"},
              {"friction", "Coulomb, kDF 1"}},
      stability{{"stability",
                 "backward Euler may explode on contact; implicit=false,substeps=70 does not on "
                 "the shipped scenes"}},
      prediction{{"contact prediction",
                  "Bullet assigns forces past a pin to the wrong vertex when it predicts contact "
                  "velocities"}};
  const std::string solver =
      "bullet-deformable:substeps=4,stiffness=250,newton=3,spring-damping=0.125";
  Scene scene = with_everything();
  EXPECT_EQ(settings(scene, solver),
            start + implicit + middle + wind + contact + stability + prediction);
  EXPECT_EQ(settings(scene, solver + ",implicit=false"),
            start + springs + middle + limit + wind + contact);
  scene.pins.clear();
  EXPECT_EQ(settings(scene, solver), start + implicit + middle + wind + contact + stability);
  scene.wind.reset();
  scene.colliders.clear();
  EXPECT_EQ(settings(scene, solver), start + implicit + middle);
}

TEST(BulletRefusals, AreTheseSentences) {
  Scene scene = with_everything();
  scene.self_collision = SelfCollision{0.01};
  EXPECT_EQ(refused(scene, "bullet"),
            std::vector<std::string>{
                "self-collision: btSoftBody leaves itself out of its vertex-face test (VF_SS)"});
  EXPECT_EQ(
      refused(scene, "bullet-deformable"),
      std::vector<std::string>{
          "self-collision: Bullet shuffles its contacts by a generator that the whole process "
          "shares, so that a case could not be repeated"});
  scene.self_collision.reset();
  scene.colliders[0].friction = 1;
  EXPECT_TRUE(refused(scene, "bullet").empty());
  EXPECT_EQ(refused(scene, "bullet:friction=refuse"),
            std::vector<std::string>{
                "friction: btSoftBody's does not depend on the load (friction=own accepts that)"});
  scene.colliders[0].friction = 1.001;
  EXPECT_EQ(
      refused(scene, "bullet"),
      std::vector<std::string>{"friction above 1 turns btSoftBody's tangential motion around"});
  EXPECT_EQ(refused(scene, "bullet:iterations=0,friction=refuse").size(), 2u);
  EXPECT_TRUE(refused(scene, "bullet-deformable").empty());
  scene.colliders.clear();
  EXPECT_EQ(refused(scene, "bullet:iterations=0"),
            std::vector<std::string>{"damping: without iterations btSoftBody skips it"});
  scene.damping = 0;
  EXPECT_TRUE(refused(scene, "bullet:iterations=0").empty());
}

/// Whether a step ends because vertex 8 of a sheet, with this place and velocity, is too far out.
bool too_far(const std::string& solver, const Vec3& at, const Vec3& velocity = Vec3::Zero(),
             bool collider = true) {
  Scene scene = hanging_sheet(3, 3);
  if (collider) scene.colliders = {{.shape = Ball{{9, 9, 9}, 1}}};
  scene.start.x[8] = at;
  scene.start.v[8] = velocity;
  scene.gravity.setZero();
  const SolverChoice choice = parse_solver(solver);
  const auto made = choice.entry->make(scene, choice.params);
  made->load(scene.start);
  try {
    made->step(0, scene.dt);
  } catch (const SolverFailure& failure) {
    EXPECT_EQ(failure.status, Status::Kind::exploded);
    EXPECT_EQ(failure.reason, Reason::box);
    EXPECT_STREQ(failure.what(), "box");
    return true;
  }
  return false;
}

TEST(BulletWorld, EndsAMillionMetresOutAlongEveryAxis) {
  for (const char* solver : {"bullet", "bullet-deformable"})
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const Vec3 out = side * Vec3::Unit(axis);
        EXPECT_TRUE(too_far(solver, 1.001e6 * out)) << solver << axis;
        EXPECT_FALSE(too_far(solver, 0.999e6 * out)) << solver << axis;
      }
  const Vec3 way = 64 * 2e4 * Vec3::UnitZ();  // m/s; 20 km in a step
  EXPECT_TRUE(too_far("bullet", Vec3(0, 0, 0.99e6), way)) << "where it goes";
  EXPECT_TRUE(too_far("bullet", Vec3(0, 0, 1.01e6), -way)) << "and whence it comes";
  EXPECT_FALSE(too_far("bullet", Vec3(0, 0, 0.97e6), way));
  EXPECT_FALSE(too_far("bullet", Vec3(0, 0, 1e9), Vec3::Zero(), false)) << "nothing to touch";
}

// Single vertices without links: the slab is twice as wide as any cloth.
TEST(BulletWorld, APlaneReachesFartherThanTheCloth) {
  Scene scene = hanging_sheet(3, 3);
  scene.links.clear();
  scene.pins.clear();
  scene.colliders = {{.shape = Plane{Vec3::UnitY(), -0.03}}};
  scene.thickness = 0.02;
  for (const double far : {49.5, 300.0}) {
    const Vec3 middle(7, 0, -3);
    for (std::size_t i = 0; i < 9; ++i) scene.start.x[i] = middle + Vec3(double(i), 0, 0);
    scene.start.x[0] = middle + Vec3(far, 0, 0);
    scene.start.x[1] = middle - Vec3(far, 0, 0);
    scene.start.x[2] = middle + Vec3(0, 0, far);
    scene.start.x[3] = middle - Vec3(0, 0, far);
    const State state = simulate(scene, "bullet:faces=off", 64);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(state.x[i].y(), -0.01, 0.005) << i;
  }
}

// The cloth moves 160 m along a frictionless belt and along a floor; it also falls on to a floor
// from 120 m in long steps.
TEST(BulletWorld, APlaneFollowsTheCloth) {
  Scene scene = hanging_sheet(4, 4);
  scene.pins.clear();
  for (Vec3& x : scene.start.x) x = {x.x(), 0.005, x.y()};
  scene.thickness = 0.005;
  const auto lowest = [&](int steps) {
    double y = 1e9;
    for (const Vec3& x : simulate(scene, "bullet", steps).x) y = std::min(y, x.y());
    return y;
  };
  scene.colliders = {{.shape = Plane{}, .motion = {.velocity = {20, 0, 0}}, .friction = 0}};
  EXPECT_GT(lowest(8 * 64), 0) << "a belt";
  scene.colliders = {{.shape = Plane{}, .motion = {}, .friction = 0}};
  for (Vec3& v : scene.start.v) v = {20, 0, 0};
  EXPECT_GT(lowest(8 * 64), 0) << "a floor";
  for (Vec3& v : scene.start.v) v.setZero();
  for (Vec3& x : scene.start.x) x.y() += 120;
  scene.dt = 0.25;
  scene.steps = 40;
  EXPECT_GT(lowest(40), 0) << "a fall";
}

}  // namespace
}  // namespace taut::bullet_ref_settings_test
