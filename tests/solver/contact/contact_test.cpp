// Contact in closed form: particles on planes, and each of Vasilovici's responses. Most scenes have
// no links, so that each vertex is a point mass.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/model/solver.hpp"
#include "core/model/triangle.hpp"
#include "core/solver/contact/projector.hpp"
#include "tests/support/cloths.hpp"

namespace taut::contact_contact_test {
namespace {

constexpr double kDt = 1.0 / 64;
constexpr double kG = 9.81;

/// Grid of n x n vertices without links, 1 m x 1 m, level, centred at `middle`.
Scene points(const Vec3& middle, int n = 4) {
  Scene scene;
  scene.mesh = make_sheet({.nu = n,
                           .nv = n,
                           .width = 1,
                           .height = 1,
                           .origin = middle - Vec3(0.5, 0, 0.5),
                           .v = Vec3::UnitZ(),
                           .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.dt = kDt;
  scene.steps = 128;
  return scene;
}

class Runner {
 public:
  Runner(const Scene& scene, const std::string& params)
      : scene_(scene),
        choice_(parse_solver(listing("precision=double" + params))),
        solver_(choice_.entry->make(scene, choice_.params)) {
    solver_->load(scene.start);
  }
  const State& step(int count = 1) {
    for (; count > 0; --count, ++n_) solver_->step(n_ * scene_.dt, scene_.dt);
    solver_->store(state_);
    return state_;
  }

 private:
  Scene scene_;
  SolverChoice choice_;
  std::unique_ptr<Solver> solver_;
  int n_ = 0;
  State state_;
};

double depth(const Collider& collider, const State& state, double t) {
  double depth = -1e9;
  for (const Vec3& x : state.x)
    depth = std::max(depth, -surface(shape_at(collider, t), x).distance);
  return depth;
}

TEST(Contact, OnAPlaneRestComesWithinTwoStepsOfTheImpact) {
  Scene scene = points({0, 0.01, 0});
  scene.colliders = {{.shape = Plane{}}};
  for (const char* response : {",contact=continuous", ",contact=discrete", ",contact=after"}) {
    Runner run(scene, response);
    run.step(3);  // falls by 6 g dt^2 = 14 mm and so has reached the plane
    const State& state = run.step(2);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      EXPECT_EQ(state.x[i].y(), 0) << response;
      EXPECT_EQ(state.v[i].y(), 0) << response;
    }
  }
}

TEST(Contact, AtRestAStepSinksByGDt2BeforeTheProjection) {
  Scene scene = points({0, 0, 0});
  scene.colliders = {{.shape = Plane{}}};
  Runner held(scene, ",contact=after,iterations=0");
  EXPECT_EQ(held.step(20).x[0].y(), 0);
  scene.colliders.clear();
  EXPECT_NEAR(Runner(scene, "").step().x[0].y(), -kG * kDt * kDt, 1e-15);
}

TEST(Contact, ThicknessIsKept) {
  Scene scene = points({0, 0.2, 0}, 9);
  scene.thickness = 0.01;
  for (const Shape& shape :
       {Shape(Plane{}), Shape(Ball{{0, -0.2, 0}, 0.3}), Shape(Box{{0, -0.2, 0}, {0.3, 0.3, 0.3}}),
        Shape(Capsule{{-0.2, -0.2, 0.1}, {0.3, -0.1, 0}, 0.25})}) {
    scene.colliders = {{.shape = shape}};
    Runner run(scene, "");
    double least = 0;
    for (int n = 0; n < 40; ++n)
      least = std::min(least, -depth(scene.colliders[0], run.step(), 0) - 0.01);
    EXPECT_NEAR(least, 0, 1e-12) << type_name(shape);
  }
}

/// Slope on which a particle slides down (or up); mu >= 0.
struct Incline {
  double slope = std::numbers::pi / 6, friction = 0;
  Vec3 down{std::cos(slope), -std::sin(slope), 0}, normal{std::sin(slope), std::cos(slope), 0};
  Scene scene() const {
    Scene s = points({0, 0, 0});
    s.colliders = {{.shape = Plane{normal, 0}, .friction = friction}};
    for (Vec3& x : s.start.x) x -= normal.dot(x) * normal;
    return s;
  }
};

TEST(Contact, OnAnInclineItSlidesAsCoulombSays) {
  for (const double mu : {0.0, 0.2, 0.5}) {
    Incline incline{.friction = mu};
    const Scene scene = incline.scene();
    for (const char* response : {",contact=continuous", ",contact=discrete", ",contact=after"}) {
      const int n = 100;
      const State state = Runner(scene, response).step(n);
      const double accelerates = kG * (std::sin(incline.slope) - mu * std::cos(incline.slope));
      const double expected = accelerates * kDt * kDt * n * (n + 1) / 2;
      for (std::size_t i = 0; i < state.x.size(); ++i)
        EXPECT_NEAR((state.x[i] - scene.start.x[i] - expected * incline.down).norm(), 0, 1e-10)
            << response << mu;
    }
  }
}

TEST(Contact, OnAnInclineItSticksIffMuIsAtLeastTheTangent) {
  const double critical = std::tan(Incline().slope);
  const Incline held{.friction = critical * 1.0001}, slips{.friction = critical * 0.999};
  EXPECT_NEAR((Runner(held.scene(), "").step(100).x[0] - held.scene().start.x[0]).norm(), 0, 1e-12);
  EXPECT_GT((Runner(slips.scene(), "").step(100).x[0] - slips.scene().start.x[0]).norm(), 1e-3);
}

TEST(Contact, AThrownPointStopsAfterV2Over2MuG) {
  Scene scene = points({0, 0, 0});
  const double mu = 0.4, v = 2;
  scene.colliders = {{.shape = Plane{}, .friction = mu}};
  for (Vec3& u : scene.start.v) u.x() = v;
  const double slid = Runner(scene, "").step(128).x[0].x() - scene.start.x[0].x();
  EXPECT_NEAR(slid, v * v / (2 * mu * kG), v * kDt);  // error of first order in dt: v dt/2
  scene.dt = kDt / 64;
  const double finer = Runner(scene, "").step(128 * 64).x[0].x() - scene.start.x[0].x();
  EXPECT_NEAR(finer, v * v / (2 * mu * kG), v * kDt / 64);
}

TEST(Contact, FrictionSeesTheMotionOfTheCollider) {
  Scene scene = points({0, 0, 0});
  scene.colliders = {{.shape = Plane{}, .motion = {.velocity = {0.3, 0, 0}}, .friction = 1}};
  const State carried = Runner(scene, "").step(128);
  for (const Vec3& v : carried.v) EXPECT_NEAR((v - Vec3(0.3, 0, 0)).norm(), 0, 1e-12);
  scene.colliders[0].motion = {.spin = {0, 0.5, 0}};  // a turntable
  const State turned = Runner(scene, "").step(128);
  const Eigen::Quaterniond turn = scene.colliders[0].motion.rotation(128 * kDt);
  for (std::size_t i = 0; i < turned.x.size(); ++i)
    EXPECT_NEAR((turned.x[i] - turn * scene.start.x[i]).norm(), 0, 0.01);
}

TEST(Contact, ARisingPlaneLiftsWithoutPenetration) {
  Scene scene = points({0, 0, 0});
  scene.colliders = {{.shape = Plane{}, .motion = {.velocity = {0, 0.5, 0}}}};
  Runner run(scene, "");
  for (int n = 1; n <= 64; ++n)
    EXPECT_NEAR(depth(scene.colliders[0], run.step(), n * kDt), 0, 1e-12);
}

/// Share of points that pass a plate of thickness D. They are thrown down at 20 m/s from heights
/// spread uniformly over the distance of one step.
double missed_fraction(const char* response, double plate) {
  Scene scene = points({0, 0, 0}, 20);
  const double way = 20 * kDt;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    scene.start.x[i].y() = 1 + way * static_cast<double>(i) / 400;
  for (Vec3& v : scene.start.v) v.y() = -20;
  scene.gravity.setZero();
  scene.colliders = {{.shape = Box{{0, 0, 0}, {2, plate / 2, 2}}}};
  const State state = Runner(scene, response).step(12);
  int below = 0;
  for (const Vec3& x : state.x) below += x.y() < -plate / 2 - 1e-9;
  return below / 400.0;
}

TEST(Contact, APlateIsMissedByAKnownShareUnlessSwept) {
  const double way = 20 * kDt;
  for (const double share : {0.25, 0.5, 0.75}) {
    EXPECT_NEAR(missed_fraction(",contact=freeze", share * way), 1 - share, 0.005);
    // A caught point keeps part of its speed, passes the middle of the plate in the next step and
    // is pushed out below: the published cloth that simply passes through the box.
    EXPECT_EQ(missed_fraction(",contact=discrete", share * way), 1);
    EXPECT_EQ(missed_fraction(",contact=continuous", share * way), 0);
  }
  EXPECT_EQ(missed_fraction(",contact=continuous", 0.001 * way), 0);
}

TEST(Contact, ABallThatPassesWithinAStepIsCaughtWhenSwept) {
  Scene scene = points({0, 0, 0});
  scene.gravity.setZero();
  scene.colliders = {{.shape = Ball{{scene.start.x[5].x(), -1, scene.start.x[5].z()}, 0.1},
                      .motion = {.velocity = {0, 40, 0}}}};
  EXPECT_EQ(Runner(scene, ",contact=discrete").step(8).x[5].y(), 0);
  // the ball carries the point along
  EXPECT_GT(Runner(scene, ",contact=continuous").step(8).x[5].y(), 4);
}

TEST(Contact, FreezeHoldsForEverWhatShouldSlide) {
  Incline incline;
  Scene scene = incline.scene();
  for (Vec3& x : scene.start.x) x += 0.01 * incline.normal;
  Runner run(scene, ",contact=freeze");
  const Vec3 stuck = run.step(10).x[0];
  EXPECT_EQ((run.step(50).x[0] - stuck).norm(), 0);
  EXPECT_NEAR(stuck.dot(incline.normal), 0, 1e-12);
}

TEST(Contact, HaltSlowsWhatShouldSlide) {
  const Incline incline;
  const Scene scene = incline.scene();
  const auto slid = [&](const char* response) {
    return (Runner(scene, response).step(100).x[0] - scene.start.x[0]).dot(incline.down);
  };
  // Every other step is skipped: time runs at half speed, and a quarter of the distance is covered.
  EXPECT_NEAR(slid(",contact=halt") / slid(",contact=discrete"), 0.25, 0.005);
}

TEST(Contact, RestartForgetsWhatWasFrozen) {
  Scene scene = points({0, 0.05, 0});
  scene.colliders = {{.shape = Plane{}}};
  for (const char* response : {"freeze", "halt"}) {
    const SolverChoice choice = parse_solver(listing(std::string("contact=") + response));
    const auto solver = choice.entry->make(scene, choice.params);
    State first, second;
    for (State* state : {&first, &second}) {
      solver->load(scene.start);
      for (int n = 0; n < 30; ++n) solver->step(n * kDt, kDt);
      solver->store(*state);
    }
    EXPECT_EQ(first.x, second.x) << response;
  }
}

TEST(Contact, APinInsideAColliderStays) {
  Scene scene = points({0, 0, 0});
  scene.pins = {5};
  scene.colliders = {{.shape = Ball{scene.start.x[5] + Vec3(0, 0.01, 0), 0.1}}};
  for (const char* response : {"continuous", "discrete", "before", "after", "freeze", "halt"})
    EXPECT_EQ(Runner(scene, std::string(",contact=") + response).step(3).x[5], scene.start.x[5])
        << response;
}

/// One free level triangle about the origin with sides of 1 m and corner masses of 1, 2 and 3 kg.
Scene one_face(const Collider& collider) {
  Scene scene;
  scene.mesh.rest = {{0.5, 0, -0.3}, {-0.5, 0, -0.3}, {0, 0, 0.6}};
  scene.mesh.triangles = {{0, 1, 2}};
  scene.mesh.mass = {1, 2, 3};
  scene.start = {scene.mesh.rest, std::vector<Vec3>(3, Vec3::Zero())};
  scene.gravity.setZero();
  scene.dt = kDt;
  scene.steps = 1;
  scene.colliders = {collider};
  return scene;
}

TEST(FaceContact, LiftsTheFaceToTheBallAndNoFurther) {
  const Ball ball{{0.05, -0.19, 0.02}, 0.2};
  Scene scene = one_face({.shape = ball});
  EXPECT_EQ(Runner(scene, "").step().x[0].y(), 0);  // no vertex is inside
  scene.thickness = 0.005;
  const State state = Runner(scene, ",faces=on,iterations=1").step();
  const Corners t{state.x[0], state.x[1], state.x[2]};
  EXPECT_NEAR(deepest_in(ball, t).depth, -0.005, 1e-4);  // the face has turned a little
  Vec3 momentum = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) momentum += scene.mesh.mass[i] * state.v[i];
  EXPECT_GT(momentum.y(), 0);
  EXPECT_NEAR(std::hypot(momentum.x(), momentum.z()), 0, 1e-12);
  const State settled = Runner(scene, ",faces=on,iterations=10").step();
  EXPECT_NEAR(deepest_in(ball, {settled.x[0], settled.x[1], settled.x[2]}).depth, -0.005, 1e-9);
}

TEST(FaceContact, LiftsTheFaceOffACapsule) {
  // one face lies flat, the other stands
  for (const Vec3& tip : {Vec3(0.3, -0.2, -0.1), Vec3(0.05, -0.7, 0.02)}) {
    const Capsule capsule{{0.05, -0.19, 0.02}, tip, 0.2};
    Scene scene = one_face({.shape = capsule});
    EXPECT_EQ(Runner(scene, "").step().x[0].y(), 0);  // no vertex is inside
    scene.thickness = 0.005;
    const State settled = Runner(scene, ",faces=on,iterations=40").step();
    EXPECT_NEAR(deepest_in(capsule, {settled.x[0], settled.x[1], settled.x[2]}).depth, -0.005,
                1e-6);
  }
}

// On the axis of a capsule no direction out is the nearest; the vertex leaves across the axis.
TEST(Contact, AVertexOnTheAxisOfACapsuleLeavesItSideways) {
  for (const Vec3& axis : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)}) {
    Scene scene = points(Vec3::Zero(), 3);  // the middle vertex lies in the middle
    scene.gravity = Vec3::Zero();
    scene.colliders = {{.shape = Capsule{-2 * axis, 2 * axis, 0.1}}};
    Runner runner(scene, ",contact=discrete");
    const Vec3 x = runner.step().x[4];
    EXPECT_NEAR(x.norm(), 0.1, 1e-12);
    EXPECT_NEAR(x.dot(axis), 0, 1e-12);
  }
}

TEST(Contact, ACapsuleOfNoLengthIsABall) {
  Scene scene = points({0, 0.3, 0}, 9);
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.thickness = 0.01;
  const Vec3 center(0.1, -0.1, 0.05);
  const Motion motion{.velocity = {0.3, 0.5, 0}, .spin = {1, 0, 2}, .pivot = {0.2, 0, 0}};
  for (const char* how :
       {"continuous", "continuous,faces=on", "discrete", "before", "after", "freeze", "halt"}) {
    const auto run = [&](const Shape& shape) {
      scene.colliders = {{.shape = shape, .motion = motion, .friction = 0.4}};
      return Runner(scene, ",substeps=1,iterations=6,contact=" + std::string(how)).step(20);
    };
    const State ball = run(Ball{center, 0.3}), capsule = run(Capsule{center, center, 0.3});
    for (std::size_t i = 0; i < ball.x.size(); ++i)
      ASSERT_LT((ball.x[i] - capsule.x[i]).norm(), 1e-12) << how << " vertex " << i;
  }
}

TEST(FaceContact, ABoxCornerLeavesTheFaceOverTheCorner) {
  // stands on one corner, the opposite one 0.02 m above y = 0
  Box box{{0, -0.5, 0}, {0.3, 0.3, 0.3}};
  box.rotation.setFromTwoVectors(Vec3(1, 1, 1), Vec3::UnitY());
  box.center.y() = 0.02 - 0.3 * std::sqrt(3.0);
  const Scene scene = one_face({.shape = box});
  const State state = Runner(scene, ",faces=on,iterations=1").step();
  EXPECT_LE(deepest_in(box, {state.x[0], state.x[1], state.x[2]}).depth, 1e-12);
  for (const Vec3& x : state.x) EXPECT_LT(x.y(), 0.06);
  EXPECT_GT(deepest_in(box, {scene.start.x[0], scene.start.x[1], scene.start.x[2]}).depth, 0.01);
}

// The long edge of a face crosses an edge of a box. It is 10 mm inside of two sides of the box and
// 15 mm inside of a third, leaves over the two, and must not be pushed over the third.
TEST(FaceContact, LeavesABoxOverItsNearestSidesAlone) {
  Scene scene =
      one_face({.shape = Box{.center = {-0.5, -0.5, 0}, .half_extents = {0.5, 0.5, 0.1}}});
  scene.mesh.rest = scene.start.x = {{-1.01, 0.99, 0.085}, {0.99, -1.01, 0.085}, {1, 1, 0.085}};
  const State state = Runner(scene, ",faces=on,iterations=1").step();
  Vec3 momentum = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    momentum += scene.mesh.mass[i] * (state.x[i] - scene.start.x[i]);
  EXPECT_GT(momentum.x(), 0.01);
  EXPECT_NEAR(momentum.y(), momentum.x(), 1e-9);
  EXPECT_EQ(momentum.z(), 0);
}

// Quick rejection of faces must keep a face that touches the farthest point of a solid.
TEST(FaceContact, SeesASmallFaceAtTheFarthestPointOfALargeSolid) {
  const Vec3 half(4, 4, 4), end(6, 0, 0);
  const auto expect = [](const auto& shape, const Vec3& farthest) {
    const Vec3 out = farthest.normalized(), u = out.unitOrthogonal(), v = out.cross(u);
    Scene scene = one_face({.shape = shape});
    Corners t;
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = 2.1 * static_cast<double>(i);
      t[i] = farthest - 0.002 * out + 0.2 * (std::cos(angle) * u + std::sin(angle) * v);
    }
    scene.mesh.rest = scene.start.x = {t[0], t[1], t[2]};
    const double before = deepest_in(shape, t).depth;
    ASSERT_GT(before, 5e-4);
    const State state = Runner(scene, ",faces=on,iterations=8").step();
    EXPECT_LT(deepest_in(shape, {state.x[0], state.x[1], state.x[2]}).depth, before / 4);
  };
  expect(Ball{Vec3::Zero(), 5}, {0, 5, 0});
  expect(Box{.center = Vec3::Zero(), .half_extents = half}, half);
  expect(Box{.center = Vec3::Zero(), .half_extents = half}, {-4, 4, -4});
  expect(Capsule{-end, end, 1}, {7, 0, 0});
}

TEST(FaceContact, LeavesPinsAlone) {
  Scene scene = one_face({.shape = Ball{{0, -0.19, 0}, 0.2}});
  scene.pins = {0, 1, 2};
  EXPECT_EQ(Runner(scene, ",faces=on").step().x, scene.start.x);
}

/// Expects that the solver's closed forms find the nearest point of the model's surface().
template <template <class> class SurfaceOf, class Shape_>
void expect_model_surface(const Shape_& shape) {
  const SurfaceOf<double> fast = surface_of(shape);
  std::mt19937 random(3);
  std::uniform_real_distribution<> number(-1, 1);
  int cleared = 0, compared = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x(number(random), number(random), number(random));
    const Surface exact = surface(shape, x);
    const Vec3T<double> here = vec3t<double>(x);
    const Tangent<double> tangent = fast.nearest(here);
    EXPECT_NEAR(dot(tangent.normal, here) - tangent.offset, exact.distance, 1e-12);
    EXPECT_NEAR((point(tangent.normal) - exact.normal).norm(), 0, 1e-7);
    for (const double t : {0.0, 0.05}) {
      EXPECT_FALSE(fast.clear(here, t) && exact.distance < t - 1e-12);
      cleared += fast.clear(here, t);
    }
    const double e = 1e-6;  // the gradient by central differences
    Vec3 gradient;
    for (Eigen::Index a = 0; a < 3; ++a)
      gradient[a] = (surface(shape, x + e * Vec3::Unit(a)).distance -
                     surface(shape, x - e * Vec3::Unit(a)).distance) /
                    (2 * e);
    const bool smooth = std::abs(gradient.norm() - 1) < 1e-4;  // skips points near the medial axis
    EXPECT_TRUE(!smooth || (gradient - exact.normal).norm() < 1e-3);
    compared += smooth;
  }
  EXPECT_GT(cleared, 500);
  EXPECT_GT(compared, 1800);
}

/// Expects that entry() agrees with marching along the path.
template <template <class> class SurfaceOf, class Shape_>
void expect_first_hit(const Shape_& shape) {
  const SurfaceOf<double> fast = surface_of(shape);
  std::mt19937 random(4);
  std::uniform_real_distribution<> number(-1, 1);
  int hits = 0, misses = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 a(number(random), number(random), number(random)),
        b(number(random), number(random), number(random));
    if (surface(shape, a).distance <= 0) continue;
    constexpr int kCuts = 4000;
    int first = 0;
    while (first <= kCuts && surface(shape, a + (b - a) * first / kCuts).distance > 0) ++first;
    const Vec3T<double> from = vec3t<double>(a), to = vec3t<double>(b);
    const Entry<double> entry = fast.entry(from, to);
    EXPECT_FALSE(fast.misses(from, to) && entry.hits);
    misses += fast.misses(from, to);
    if (first > kCuts) continue;  // the path may still graze the surface between two samples
    ASSERT_TRUE(entry.hits);
    ++hits;
    const Vec3 hit = a + (b - a) * first / kCuts;
    const Vec3 normal = point(entry.tangent.normal);
    EXPECT_NEAR(normal.dot(hit), entry.tangent.offset, 2 * (b - a).norm() / kCuts);
    EXPECT_LT(normal.dot(b - a), 0);
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(misses, 100);
}

/// Expects that the quick test beyond() claims only points whose whole path stays outside of the
/// surface, and that it finds at least 70 % of them.
template <template <class> class SurfaceOf>
void expect_beyond_is_outside(const auto& shape) {
  const SurfaceOf<double> fast = surface_of(shape);
  std::mt19937 random(5);
  std::uniform_real_distribution<> number(-1, 1);
  int beyond = 0, outside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 x(number(random), number(random), number(random));
    const double way = std::abs(0.3 * number(random)), thickness = 0.01 * (k % 3);
    const bool out = surface(shape, x).distance >= thickness + way;
    const bool said = fast.beyond(vec3t<double>(x), way * way, thickness);
    EXPECT_TRUE(out || !said);
    beyond += said;
    outside += out;
  }
  EXPECT_GT(beyond, outside * 7 / 10);
}

TEST(Contact, ClosedFormsAgreeWithTheModelAndWithMarching) {
  const Ball ball{{0.1, -0.2, 0.05}, 0.4};
  Box box{{0.1, 0.1, -0.1}, {0.3, 0.2, 0.5}};
  box.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized());
  expect_model_surface<PlaneSurface>(Plane{Vec3(1, 2, 2) / 3, 0.2});
  expect_model_surface<BallSurface>(ball);
  expect_model_surface<BoxSurface>(box);
  const Capsule capsule{{0.3, -0.2, 0.05}, {-0.4, 0.1, 0.2}, 0.3},
      upright{{0.1, -0.3, 0}, {0.1, 0.5, 0}, 0.2}, point{ball.center, ball.center, ball.radius};
  for (const Capsule& one : {capsule, upright, point}) {
    expect_model_surface<CapsuleSurface>(one);
    expect_beyond_is_outside<CapsuleSurface>(one);
    expect_first_hit<CapsuleSurface>(one);
  }
  expect_beyond_is_outside<BallSurface>(ball);
  expect_beyond_is_outside<BoxSurface>(box);
  expect_first_hit<BallSurface>(ball);
  expect_first_hit<BoxSurface>(box);
}

/// Expects the same numbers from a surface specialised to the world's axes and from the general
/// one.
template <bool continuous, template <class> class SurfaceOf, template <class> class AlignedOf>
void expect_same_numbers(const auto& shape, const Motion& motion, float friction) {
  const SurfaceOf<float> surface = rounded<float>(surface_of(shape));
  ASSERT_TRUE(surface.is_aligned());
  const RigidMotion<float> moves = rounded<float>(rigid_motion(motion, 0, 0.02));
  const Contact<float, SurfaceOf> any{surface, moves, 0.01F, friction};
  const Contact<float, AlignedOf> aligned{surface.aligned(), moves, 0.01F, friction};
  std::mt19937 random(6);
  std::uniform_real_distribution<float> number(-1, 1);
  int touched = 0, slid = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vec3T<float> before{number(random), number(random), number(random)};
    const float way = continuous ? 1 : 0.05F;
    const Vec3T<float> x =
        before + way * Vec3T<float>{number(random), number(random), number(random)};
    const bool near = any.template near<continuous>(x, before);
    EXPECT_EQ(near, aligned.template near<continuous>(x, before));
    Vec3T<float> a = x, b = x;
    if constexpr (continuous)
      EXPECT_EQ(any.project_continuous(a, before, near),
                aligned.project_continuous(b, before, near));
    else
      EXPECT_EQ(any.project(a, before, near), aligned.project(b, before, near));
    EXPECT_EQ(point(a), point(b));
    touched += point(a) != point(x);
    slid += (point(a) - point(before)).norm() > 0.02F;
  }
  EXPECT_GT(touched, 100);
  EXPECT_GT(slid, 100);
}

TEST(Contact, SurfacesAlongTheAxesGiveTheSameNumbers) {
  const Motion still, moves{.velocity = Vec3(0.3, -0.2, 0.1)};
  for (const Motion& motion : {still, moves})
    for (const float friction : {0.0F, 0.4F}) {
      const Box box{{0.1, 0.1, -0.1}, {0.3, 0.2, 0.5}};
      expect_same_numbers<false, PlaneSurface, LevelPlaneSurface>(Plane{Vec3::UnitY(), 0.2}, motion,
                                                                  friction);
      expect_same_numbers<false, BoxSurface, AlignedBoxSurface>(box, motion, friction);
      expect_same_numbers<true, BoxSurface, AlignedBoxSurface>(box, motion, friction);
    }
  Box turned{{0, 0, 0}, {1, 1, 1}};
  turned.rotation = Eigen::AngleAxisd(1e-3, Vec3::UnitX());
  EXPECT_FALSE(surface_of(turned).is_aligned());
  EXPECT_FALSE(surface_of(Plane{-Vec3::UnitY(), 0}).is_aligned());
  EXPECT_FALSE(surface_of(Plane{Vec3(1e-3, 1, 0).normalized(), 0}).is_aligned());
}

// The deepest point b of a level face moves by c = s n less the friction, at most mu s against its
// slip d. Its corners move by w_i b_i c / sum of w_j b_j^2.
TEST(FaceContact, RubsAgainstTheSlipOfItsDeepestPoint) {
  const Vec3 d(0.01, 0, 0.005);  // m, the face's displacement in a step
  struct Case {
    double friction;
    Vec3 velocity, rubbed;  ///< velocity of the ball [m/s], and of its deepest point [m]
  };
  const double depth = 0.01;
  for (const auto& [friction, velocity, rubbed] :
       {Case{0, Vec3::Zero(), Vec3::Zero()}, Case{0.3, Vec3::Zero(), 0.3 * depth * d.normalized()},
        Case{2, Vec3::Zero(), d}, Case{2, Vec3(0.01, 0, 0) / kDt, Vec3(0, 0, 0.005)},
        Case{0.3, Vec3(0.01, 0, 0) / kDt, Vec3(0, 0, 0.3 * depth)}}) {
    const Vec3 end(0.05, -0.19, 0.02);
    Scene scene = one_face({.shape = Ball{end - kDt * velocity, 0.2},
                            .motion = {.velocity = velocity},
                            .friction = friction});
    for (Vec3& v : scene.start.v) v = d / kDt;
    Corners moved;
    for (std::size_t i = 0; i < 3; ++i) moved[i] = scene.start.x[i] + d;
    const Vec3 b = closest_point(moved, end).weights;
    const Vec3 correction = Vec3(0, depth, 0) - rubbed;
    double sum = 0;
    for (Eigen::Index i = 0; i < 3; ++i) sum += b[i] * b[i] / (1.0 + static_cast<double>(i));
    const State state = Runner(scene, ",faces=on,iterations=1").step();
    for (std::size_t i = 0; i < 3; ++i) {
      const double share = b[static_cast<Eigen::Index>(i)] / (1 + static_cast<double>(i)) / sum;
      EXPECT_LT((state.x[i] - moved[i] - share * correction).norm(), 1e-12)
          << friction << " corner " << i;
    }
  }
}

}  // namespace
}  // namespace taut::contact_contact_test
