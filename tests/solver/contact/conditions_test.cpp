// One step in contact against the conditions of Signorini and Coulomb, evaluated from the positions
// alone. The residual force of links and inertia at a vertex is the force with which the collider
// has to push.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/model/angle.hpp"
#include "core/model/triangle.hpp"
#include "core/reference/contact_residual.hpp"
#include "core/reference/implicit_step.hpp"
#include "core/solver/contact/contacts.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"
#include "tests/support/draw.hpp"

namespace taut::contact_conditions_test {
namespace {

constexpr double kStiffness = 100;  // N/m; stiffer springs would take pd 20 times as long
const std::string kSprings = "structural=100,shear=100,bend=0";
const std::string kGlobal = "xpbd:method=global,primal=on,substeps=1,precision=double";
/// The solver's text with these springs; xpbd takes them as compliances.
std::string sprung(const std::string& solver) {
  return with(solver, solver.starts_with("xpbd") ? "structural=0.01,shear=0.01" : kSprings);
}

/// A sheet of 9 x 9 vertices, half a metre wide, that has fallen on to the collider; without
/// friction it soon slides off.
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
    const double slope = 20 * kDegree;  // friction of 0.3 does not hold on this slope
    all.push_back(lying_on(Plane{{std::sin(slope), std::cos(slope), 0}, 0}, 0.12, friction));
  }
  return all;
}

const char* name_of(const Scene& scene) { return type_name(scene.colliders[0].shape).data(); }

/// Violation of the contact conditions by x [m].
double violation(const Scene& scene, const std::vector<Vec3>& x) {
  const auto residual =
      reference::contact_residual(scene, scene.start, 0, {kStiffness, kStiffness, 0}, x);
  EXPECT_GE(residual.touching, 8) << name_of(scene) << ": or nothing was asked";
  return residual.most;
}

struct Converged {
  std::string solver;
  int few, many;  ///< iterations
};

/// The same scene with its start perturbed by about a rounding error.
Scene a_rounding_error_apart(Scene scene, int n) {
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.x[i].y() += 1e-13 * std::sin(static_cast<double>(i) * n);
  return scene;
}

/// Newton-like solvers run from eight perturbed starts: each has to converge, whatever rounding
/// decides.
TEST(ContactConditions, HoldForEverySolverOnceItHasConverged) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "half a million iterations; sanitizers see the same code in other tests";
#endif
  const std::vector<Converged> solvers{{"implicit", 1, 100},
                                       {kGlobal, 1, 100},
                                       {"pd", 10, 20000},
                                       {"vbd", 10, 20000},
                                       {"admm:links=elastic", 10, 20000}};
  for (const Scene& scene : scenes())
    for (const Converged& one : solvers) {
      const auto after = [&](int iterations, int start = 0) {
        const std::string text =
            with(sprung(one.solver), "iterations=" + std::to_string(iterations));
        const Scene from = a_rounding_error_apart(scene, start);
        return violation(from, after_one_step(from, text).x);
      };
      const std::string where = one.solver + " on a " + name_of(scene) + ", friction " +
                                std::to_string(scene.colliders[0].friction);
      const int starts = one.solver == "implicit" || one.solver == kGlobal ? 8 : 1;
      for (int n = 0; n < starts; ++n)
        EXPECT_LT(after(one.many, n), 1e-8) << where << ", start " << n;
      // on a plane few iterations suffice
      if (!std::holds_alternative<Plane>(scene.colliders[0].shape)) {
        EXPECT_GT(after(one.few), 1e-6) << where;
      }
    }
}

/// A sheet that fell on a rough slope lies there, compressed by its own weight, and must stay at
/// rest.
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
    for (const std::string& solver :
         {std::string("implicit"), std::string("pd"), std::string("admm"), std::string("vbd"),
          kGlobal + ",iterations=30"}) {
      double fastest = 0;
      for (const Vec3& v : simulate(scene, solver, 60).v) fastest = std::max(fastest, v.norm());
      EXPECT_LT(fastest, 1e-9) << solver << ", " << n << " x " << n;
    }
  }
}

/// A sheet of 5 x 5, held along its sides, with a sheet of 3 x 3 lying on it. Each vertex of the
/// upper sheet is a ball that rests on a vertex of the lower one.
Scene sheet_on_sheet() {
  Scene scene;
  scene.name = "sheet on sheet";
  const auto add_sheet = [&](int n, const Vec3& origin, double mass) {
    const int first = scene.mesh.size();
    const auto link = [&](int i, int j, int k, int l) {
      if (k < 0 || k >= n || l >= n) return;
      const int a = first + j * n + i, b = first + l * n + k;
      const double length = 0.1 * std::hypot(k - i, l - j);
      scene.links.push_back({a, b, length, i == k || j == l ? Family::structural : Family::shear});
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        scene.mesh.rest.push_back(origin + Vec3(0.1 * i, 0, 0.1 * j));
        scene.mesh.mass.push_back(mass);
      }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        link(i, j, i + 1, j);
        link(i, j, i, j + 1);
        link(i, j, i + 1, j + 1);
        link(i, j, i - 1, j + 1);
      }
  };
  add_sheet(5, Vec3::Zero(), 0.002);
  add_sheet(3, {0.1001, 0.01001, 0.10005}, 0.001);
  for (int i = 0; i < 25; ++i)
    if (i % 5 == 0 || i % 5 == 4 || i < 5 || i >= 20) scene.pins.push_back(i);
  scene.start = {scene.mesh.rest, std::vector<Vec3>(34, Vec3::Zero())};
  scene.dt = 1.0 / 64;
  scene.self_collision = {.radius = 0.005};
  scene.damping = 2;
  scene.start = simulate(scene, "implicit:" + kSprings, 4);
  scene.damping = 0;
  return scene;
}

/// Violation of the frictionless contact conditions between vertices, as the distance that a vertex
/// would travel by its own inertia [m]. Each vertex touches one other at most.
struct Violation {
  double most = 0;
  std::ptrdiff_t touching = 0;
};
Violation violation_of_pairs(const Scene& scene, const std::vector<Vec3>& x) {
  const ElasticStep step(scene, {kStiffness, kStiffness, 0});
  const Eigen::VectorXd left = step.gradient(x);
  const std::vector<double> w = inverse_masses(scene);
  const auto force_at = [&](std::size_t i) -> Vec3 {
    return left.segment<3>(3 * static_cast<Eigen::Index>(i));
  };
  const double diameter = 2 * scene.self_collision->radius;
  double worst = 0;
  std::vector<bool> touched(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const double gap = (x[j] - x[i]).norm() - diameter;
      worst = std::max(worst, -gap);
      if (gap > 1e-7) continue;
      EXPECT_FALSE(touched[i] || touched[j]);
      touched[i] = touched[j] = true;
      const Vec3 normal = (x[j] - x[i]).normalized();
      const double push = normal.dot(force_at(j));
      const double per_force = scene.dt * scene.dt * std::max(w[i], w[j]);
      worst = std::max(worst, -per_force * push);
      worst = std::max(worst, per_force * (force_at(j) - push * normal).norm());
      if (w[i] > 0) worst = std::max(worst, per_force * (force_at(i) + push * normal).norm());
    }
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!touched[i] && w[i] > 0)
      worst = std::max(worst, scene.dt * scene.dt * w[i] * force_at(i).norm());
  return {worst, std::ranges::count(touched, true)};
}

TEST(ContactConditions, HoldBetweenSheets) {
  const Scene scene = sheet_on_sheet();
  const std::vector<Converged> solvers{{"implicit", 2, 400},
                                       {kGlobal, 2, 1000},
                                       {"pd", 10, 20000},
                                       {"vbd", 10, 20000},
                                       {"admm:links=elastic", 10, 20000}};
  for (const Converged& one : solvers) {
    const auto after = [&](int iterations) {
      const std::string text = with(sprung(one.solver), "iterations=" + std::to_string(iterations));
      return violation_of_pairs(scene, after_one_step(scene, text).x);
    };
    EXPECT_LT(after(one.many).most, 1e-8) << one.solver;
    EXPECT_GE(after(one.many).touching, 8) << one.solver;
    EXPECT_GT(after(one.few).most, 1e-6) << one.solver;
  }
}

/// A ball lies on the middle of a string between two pins: the string carries both weights.
TEST(ContactConditions, AStringFeelsTheBallThatLiesOnIt) {
  constexpr double kHalf = 0.1, kMass = 0.003;
  Scene scene;
  scene.name = "ball on a string";
  scene.mesh.rest = {{-kHalf, 0, 0}, {0, 0, 0}, {kHalf, 0, 0}, {0, 0.02, 0}};
  scene.mesh.mass.assign(4, kMass);
  scene.links = {{0, 1, kHalf, Family::structural}, {1, 2, kHalf, Family::structural}};
  scene.pins = {0, 2};
  scene.start = {scene.mesh.rest, std::vector<Vec3>(4, Vec3::Zero())};
  scene.dt = 1.0 / 64;
  scene.damping = 5;
  scene.stiffness = {kStiffness, kStiffness, kStiffness};
  scene.self_collision = {.radius = 0.01};
  // the sag s at equilibrium: 2 K (l - r) s/l = 2 m g
  double low = 0, high = 0.05;
  for (int n = 0; n < 200; ++n) {
    const double s = (low + high) / 2, length = std::hypot(kHalf, s);
    (kStiffness * (length - kHalf) * s / length < kMass * scene.gravity.norm() ? low : high) = s;
  }
  for (const std::string solver :
       {"implicit:iterations=3", "pd:iterations=200", "admm:links=elastic,iterations=200",
        "vbd:iterations=20", "mass-spring:substeps=50,precision=double"}) {
    const State rest = simulate(scene, solver, 1000);
    EXPECT_NEAR(rest.x[1].y(), -high, 1e-9) << solver;
    EXPECT_NEAR(rest.x[3].y() - rest.x[1].y(), 0.02, 1e-9) << solver;
  }
}

/// A face in a frame of three springs that lies on a ball, which touches it beside its centre.
Scene face_on_ball(double friction) {
  Scene scene;
  scene.name = "face on a ball";
  const Vec3 corners[] = {{-0.1, 0, -0.06}, {0.1, 0, -0.06}, {0, 0, 0.12}};
  const auto link = [&](int a, int b) {
    const Vec3 way = scene.mesh.rest[to_index(b)] - scene.mesh.rest[to_index(a)];
    scene.links.push_back({a, b, way.norm(), Family::structural});
  };
  for (const double scale : {1.0, 2.0})
    for (const Vec3& corner : corners) scene.mesh.rest.push_back(scale * corner);
  scene.mesh.mass = {0.004, 0.003, 0.005, 0.001, 0.001, 0.001};
  scene.mesh.triangles = {{0, 2, 1}};
  scene.pins = {3, 4, 5};
  for (int corner = 0; corner < 3; ++corner) {
    link(corner, (corner + 1) % 3);
    link(corner, corner + 3);
  }
  scene.start = {scene.mesh.rest, std::vector<Vec3>(6, Vec3::Zero())};
  scene.dt = 1.0 / 64;
  scene.colliders = {{.shape = Ball{{0.01, -0.045, -0.02}, 0.04}, .friction = friction}};
  scene.start = simulate(scene, "implicit:faces=on," + kSprings, 8);
  return scene;
}

/// Violation of the contact conditions at the deepest point of the face, measured as in
/// violation().
double violation_of_face(const Scene& scene, const std::vector<Vec3>& x) {
  const ElasticStep step(scene, {kStiffness, kStiffness, 0});
  const Eigen::VectorXd left = step.gradient(x);
  const std::vector<double> w = inverse_masses(scene);
  const Ball& ball = std::get<Ball>(scene.colliders[0].shape);
  const Deepest deepest = deepest_in(ball, {x[0], x[2], x[1]});
  EXPECT_NEAR(deepest.depth, 0, 1e-4) << "or nothing was asked";
  const double weights[] = {deepest.at.weights[0], deepest.at.weights[2], deepest.at.weights[1]};
  const Vec3 normal = (deepest.at.position - ball.center).normalized();
  Vec3 force = Vec3::Zero(), slip = Vec3::Zero();
  for (std::size_t c = 0; c < 3; ++c) {
    force += left.segment<3>(3 * static_cast<Eigen::Index>(c));
    slip += weights[c] * (x[c] - scene.start.x[c]);
  }
  slip -= normal.dot(slip) * normal;
  const double per_force = w[1] * scene.dt * scene.dt;
  double worst = std::abs(deepest.depth);
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3 own = left.segment<3>(3 * static_cast<Eigen::Index>(c));
    worst = std::max(worst, per_force * (own - weights[c] * force).norm());
  }
  const double push = normal.dot(force), most = scene.colliders[0].friction * push;
  EXPECT_GT(push, 0.01);
  const Vec3 rub = force - push * normal;
  const double wrong =
      slip.norm() > 1e-7 ? (rub + most * slip.normalized()).norm() : rub.norm() - most;
  return std::max(worst, per_force * wrong);
}

TEST(ContactConditions, HoldForAFace) {
  for (const double friction : {0.0, 0.1, 0.6}) {
    const Scene scene = face_on_ball(friction);
    const std::vector<Converged> solvers{
        {"implicit", 3, 200}, {"pd", 5, 5000}, {"admm:links=elastic", 5, 5000}};
    for (const Converged& one : solvers) {
      const auto after = [&](int iterations) {
        const std::string text =
            with(sprung(one.solver), "faces=on,iterations=" + std::to_string(iterations));
        return violation_of_face(scene, after_one_step(scene, text).x);
      };
      EXPECT_LT(after(one.many), 1e-8) << one.solver << ", friction " << friction;
      EXPECT_GT(after(one.few), 1e-6) << one.solver << ", friction " << friction;
    }
  }
}

// One vertex with any Hessian. Where it slips, push and friction depend on each other.
TEST(ContactConditions, HoldForASettledVertex) {
  Draw draw(5);
  int sliding = 0, sticking = 0;
  for (int n = 0; n < 4000; ++n) {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Identity();
    for (int link = 0; link < 4; ++link) {
      const Vec3 along = draw.vector(1);
      hessian += std::pow(10, draw.number(0, 4)) * along * along.transpose();
    }
    const MatrixCompliance compliance{hessian.inverse(), hessian};
    TouchingVertex at;
    at.normal = draw.vector(1).normalized();
    at.offset = draw.number(-1, 1);
    at.from = draw.vector(1);
    at.friction = draw.number(0.01, 1.5);
    ContactForce force{draw.number(0, 5), at.across(draw.vector(1))};
    const Vec3 before = at.total(force), start = draw.vector(1);
    Vec3 x = start;
    const Vec3 change = settle(at, compliance, force, x);
    EXPECT_LT((x - start - compliance * change).norm(), 1e-12);
    EXPECT_LT((at.total(force) - before - change).norm(), 1e-9);
    if (!force.holds()) {
      EXPECT_GE(at.gap(x), 0);
      continue;
    }
    const double most = at.friction * force.push;
    const Vec3 slip = at.slip(x);
    EXPECT_LT(std::abs(at.gap(x)), 1e-11);
    EXPECT_LE(force.rub.norm(), most * (1 + 1e-12));
    if (slip.norm() < 1e-10) {
      ++sticking;
      continue;
    }
    ++sliding;
    EXPECT_LT((force.rub + most * slip.normalized()).norm(), 1e-9 * most) << "draw " << n;
  }
  EXPECT_GT(sliding, 800);
  EXPECT_GT(sticking, 300);
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
