// Penetration, faces, slip and tunnelling on states with answers in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "core/model/body_frames.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/metrics/measured.hpp"
#include "tests/support/bodies.hpp"

namespace taut::contact_metrics_test {
namespace {

TEST(Penetration, OfOneVertexAMillimetreInsideTheBall) {
  Scene scene = sheet();
  scene.colliders = {{.shape = Ball{.center = {0.5, -0.3, 0.5}, .radius = 0.3}}};
  State state = scene.start;
  state.x[middle(scene)].y() = -0.001;
  const Values v = measure_at_rest(scene, state);
  for (const char* name : {"penetration.max", "penetration.peak", "penetration.mean",
                           "penetration.ball.max", "penetration.ball.mean"})
    EXPECT_NEAR(v.at(name), 0.001, 1e-12) << name;
  EXPECT_NEAR(v.at("penetration.share"), 1.0 / 121, 1e-12);
  EXPECT_NEAR(v.at("penetration.gap"), -0.001, 1e-12);
  EXPECT_TRUE(std::isnan(v.at("penetration.plane.max")));
}

TEST(Penetration, OfTwoVerticesHasAMeanAShareAndAPeak) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Plane{}}};
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    const double scale = step == 20 ? 2 : step % 2 ? 1 : 0.5;
    for (Vec3& x : state.x) x.y() = 0.1;
    state.x[3].y() = -0.002 * scale;
    state.x[5].y() = -0.006 * scale;
    return state;
  });
  for (const std::string of : {"penetration.", "penetration.plane."}) {
    EXPECT_NEAR(v.at(of + "max"), 0.006, 1e-12) << of;
    EXPECT_NEAR(v.at(of + "peak"), 0.012, 1e-12) << of;
    EXPECT_NEAR(v.at(of + "mean"), 0.004 * 0.75, 1e-12) << of;
  }
  EXPECT_NEAR(v.at("penetration.share"), 2.0 / 9, 1e-12);
  EXPECT_NEAR(v.at("penetration.gap"), -0.006 * 0.75, 1e-12);
}

TEST(Penetration, IsBelowTheSurfaceAndTheGapHasTheThickness) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Plane{}}};
  scene.thickness = 0.01;
  State state = scene.start;
  for (Vec3& x : state.x) x.y() = 0.012;
  Values v = measure_at_rest(scene, state);
  EXPECT_EQ(v.at("penetration.max"), 0);
  EXPECT_NEAR(v.at("penetration.gap"), 0.002, 1e-12);
  for (Vec3& x : state.x) x.y() = 0.004;
  v = measure_at_rest(scene, state);
  EXPECT_EQ(v.at("penetration.max"), 0);
  EXPECT_NEAR(v.at("penetration.gap"), -0.006, 1e-12);
}

TEST(Penetration, FollowsTheColliderAndForgivesPins) {
  Scene scene = sheet(3);
  scene.pins = {0};
  scene.colliders = {
      {.shape = Plane{.offset = -0.5}, .motion = {.velocity = {0, 0.2, 0}}}};  // at y = 0.1 at 3 s
  State state = scene.start;
  state.x[0].y() = -7;
  EXPECT_NEAR(measure_at_rest(scene, state).at("penetration.max"), 0.1, 1e-12);
}

TEST(Faces, ThatRestOnABallSagByGeometryAlone) {
  Scene scene = sheet(21);  // l = 0.05 m
  const double radius = 0.5, l = 0.05;
  const Vec3 center(0.5, -1, 0.5);
  scene.colliders = {{.shape = Ball{.center = center, .radius = radius}}};
  // one cell touches the ball with its corners, all other cells are above it
  State state = scene.start;
  const Grid g = *scene.mesh.grid;
  for (const auto& [i, j] : {std::pair{10, 10}, {11, 10}, {10, 11}, {11, 11}}) {
    Vec3& x = state.x[static_cast<std::size_t>(g.index(i, j))];
    const double u = (i - 10.5) * l, w = (j - 10.5) * l;
    x = center + Vec3(u, std::sqrt(radius * radius - u * u - w * w), w);
  }
  const Values v = measure_at_rest(scene, state);
  EXPECT_NEAR(v.at("face.max"), 1.2516e-3, 1e-7);  // design value for l = 0.05, R = 0.5
  EXPECT_NEAR(v.at("face.geometry"), v.at("face.max"), 1e-12);
  EXPECT_NEAR(v.at("face.excess"), 0, 1e-12);
  EXPECT_NEAR(v.at("face.max"), l * l / (4 * radius), 2e-6);
  EXPECT_NEAR(v.at("penetration.max"), 0, 1e-12);
}

/// Block that slides down a slope of 30 degrees with friction mu, sampled at steps of dt.
State sliding(const Scene& scene, double mu, int step) {
  const Vec3 down = Vec3(1, -std::sqrt(1.0 / 3), 0).normalized();
  const double a = 9.81 * std::max(0.0, 0.5 - mu * std::sqrt(0.75));
  State state = scene.start;
  for (Vec3& x : state.x) x += a * scene.dt * scene.dt * step * (step + 1) / 2 * down;
  for (Vec3& v : state.v) v = a * scene.dt * step * down;
  return state;
}

TEST(Slip, IsZeroForCoulombsLaw) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Plane{.normal = {0.5, std::sqrt(0.75), 0}}, .friction = 0.3}};
  const auto at = [&](double mu) {
    return measure(scene, [&](int step) { return sliding(scene, mu, step); });
  };
  Values v = at(0.3);
  EXPECT_NEAR(v.at("slip.error.peak"), 0, 1e-9);
  EXPECT_NEAR(v.at("slip.distance"), 0, 1e-9);
  v = at(0.2);  // a solver whose friction is 0.1 too small
  const double wrong = 9.81 * 0.1 * std::sqrt(0.75);
  EXPECT_NEAR(v.at("slip.error"), wrong, 1e-9);
  EXPECT_NEAR(v.at("slip.distance"), wrong / 2 * 3 * (3 - scene.dt), 1e-9);  // from step 1 on
  // more than tan(30 degrees): the block has to stick, yet creeps
  scene.colliders[0].friction = 0.6;
  v = at(0.57);
  EXPECT_NEAR(v.at("slip.error"), 9.81 * 0.03 * std::sqrt(0.75), 1e-9);
  v = at(1);
  EXPECT_NEAR(v.at("slip.error.peak"), 0, 1e-9);
}

/// A corner that pierces a coarse face touches no vertex; going through and back counts as two
/// passages.
TEST(Faces, ThatAColliderPiercesArePassages) {
  Scene scene = sheet(2);  // 1 m wide, level
  for (Vec3& x : scene.start.x) x.y() = 0.3;
  const double half = 0.05;
  const auto passages = [&](const Shape& shape, double amplitude) {
    scene.colliders = {{.shape = shape}};
    return measure(scene,
                   [&](int step) {  // the cloth is lowered on to it and lifted again
                     State state = scene.start;
                     const double t = static_cast<double>(step) / scene.steps;
                     for (Vec3& x : state.x)
                       x.y() = 0.3 - amplitude * std::sin(std::numbers::pi * t);
                     return state;
                   })
        .at("face.passages");
  };
  const Vec3 low(0.3, 0, 0.4);
  EXPECT_EQ(passages(Box{low, {half, half, half}}, 0.2), 0);
  EXPECT_EQ(passages(Box{low, {half, half, half}}, 0.29), 8) << "four corners, there and back";
  EXPECT_EQ(passages(Ball{low, half}, 0.29), 0) << "not to its middle";
  EXPECT_EQ(passages(Ball{low, half}, 0.35), 2);
  for (const double up : {1.0, -1.0}) {  // whichever end is the first
    const Vec3 half_axis(0, 0.1 * up, 0);
    EXPECT_EQ(passages(Capsule{low - half_axis, low + half_axis, 0.01}, 0.22), 2) << up;
  }
  EXPECT_EQ(passages(Ball{{2, 0, 0.4}, half}, 0.35), 0) << "beside the cloth";
}

/// With every solver, contact carries the weight of a cloth at rest, and no force acts while it
/// falls.
TEST(ContactForce, IsTheWeightOfAClothAtRestWithEverySolver) {
  Scene scene = sheet(3);
  double weight = 0;
  for (const double mass : scene.mesh.mass) weight += 9.81 * mass;
  for (Vec3& x : scene.start.x) x.y() += 0.02;
  scene.colliders = {{.shape = Plane{}, .friction = 0.3},
                     {.shape = Box{{0.5, 0, 0.5}, {0.2, 0.005, 0.2}}, .friction = 0.3}};
  scene.damping = 3;
  scene.steps = 200;
  const auto force = [&](const char* solver, const char* value) {
    const auto values = run_case(scene, parse_solver(solver)).record.values;
    const auto at = values.find(value);
    return at == values.end() ? -1 : at->second;
  };
  for (const char* solver : {"jakobsen:precision=double", "xpbd:precision=double", "mass-spring",
                             "implicit", "pd", "admm", "vbd", "avbd"}) {
    EXPECT_NEAR(force(solver, "contact.force"), weight, 1e-3 * weight) << solver;
    EXPECT_GT(force(solver, "contact.force.peak"), 2 * weight) << solver;
  }
  scene.colliders = {{.shape = Plane{.offset = -1000}}};
  scene.damping = 0;
  EXPECT_NEAR(force("mass-spring", "contact.force.peak"), 0, 1e-6 * weight);
  scene.pins = {0};
  EXPECT_EQ(force("mass-spring", "contact.force"), -1);
}

/// In its first step a block with substeps of dt/n moves a dt^2 (1 + 1/n)/2. It obeys Coulomb's law
/// for every n.
TEST(Slip, IsZeroForAnyNumberOfSubsteps) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Plane{.normal = {0.5, std::sqrt(0.75), 0}}, .friction = 0.3}};
  const Vec3 downhill(std::sqrt(0.75), -0.5, 0);
  const double a = 9.81 * (0.5 - 0.3 * std::sqrt(0.75));
  for (const int substeps : {1, 8, 1000}) {
    const auto slides = [&](int step) {
      State state = scene.start;
      const double t = step * scene.dt;
      for (Vec3& x : state.x) x += a / 2 * t * (t + scene.dt / substeps) * downhill;
      return state;
    };
    const Values v = measure(scene, slides);
    EXPECT_NEAR(v.at("slip.error.peak"), 0, 1e-9) << substeps;
    EXPECT_NEAR(v.at("slip.distance"), 0, 1e-9) << substeps;
  }
}

TEST(Slip, SeesThePlaneMoveAndDampingAndNeedsAPlaneAlone) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Plane{}, .motion = {.velocity = {0.3, 0, 0}}, .friction = 0.5}};
  const auto carried = [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x) x.x() += 0.3 * scene.dt * step;
    return state;
  };
  for (Vec3& v : scene.start.v) v = {0.3, 0, 0};
  EXPECT_NEAR(measure(scene, carried).at("slip.error.peak"), 0, 1e-9);
  scene.colliders[0].motion = {};
  EXPECT_NEAR(measure(scene, carried).at("slip.error"), 0.5 * 9.81, 1e-9);  // nothing slows it down
  scene.colliders.clear();
  scene.damping = 2;
  scene.gravity = {0, -1e-9, 0};
  scene.colliders = {{.shape = Plane{.offset = -5}, .friction = 0.5}};
  const double keep = std::exp(-2 * scene.dt);
  const auto damped = [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x)
      x.x() += 0.3 * scene.dt * keep * (1 - std::pow(keep, step)) / (1 - keep);
    return state;
  };
  EXPECT_NEAR(measure(scene, damped).at("slip.error.peak"), 0, 1e-6);
  scene.pins = {0};
  EXPECT_FALSE(measure(scene, damped).contains("slip.error"));
}

// A cloth of unequal masses with arbitrary motion, beside a block that receives the same normal
// impulses, on a moving slope. Coulomb's law is implemented a second time, in components along the
// plane.
TEST(Slip, OfAnyMotionIsTheDifferenceFromTheBlock) {
  Draw draw(5);
  Scene scene = sheet(3);
  scene.gravity = {1, -9, 2};
  scene.damping = 0.9;
  scene.steps = 140;
  for (double& mass : scene.mesh.mass) mass *= draw.number(0.5, 2);
  for (Vec3& v : scene.start.v) v = draw.vector(1);
  const Vec3 normal = Vec3(0.3, 1, -0.2).normalized(), carried(0.3, -0.1, 0.2);
  scene.colliders = {
      {.shape = Plane{normal, -1}, .motion = {.velocity = carried}, .friction = 0.4}};
  std::vector<State> states(141, scene.start);
  for (std::size_t step = 1; step < states.size(); ++step) {
    const Vec3 shift = draw.vector(0.004);
    for (Vec3& x : states[step].x) x += shift + draw.vector(0.003);
  }
  const auto center = [&](const std::vector<Vec3>& all) {
    Vec3 sum = Vec3::Zero();
    double mass = 0;
    for (std::size_t i = 0; i < 9; ++i) {
      sum += scene.mesh.mass[i] * all[i];
      mass += scene.mesh.mass[i];
    }
    return Vec3(sum / mass);
  };
  const Vec3 u = normal.unitOrthogonal(), w = normal.cross(u);
  const auto along = [&](const Vec3& v) { return Eigen::Vector2d(u.dot(v), w.dot(v)); };
  const auto freely = [&](const Vec3& v) {
    return Vec3(std::exp(-0.9 / 64) * v + scene.gravity / 64);
  };
  const auto rubbed = [&](const Vec3& v, double press) {  // velocity along the plane after friction
    const Eigen::Vector2d slides = along(v - carried);
    const double left = std::max(0.0, slides.norm() - 0.4 * press);
    return Eigen::Vector2d(along(carried) + left * slides.normalized());
  };
  Vec3 velocity = 64 * (center(states[1].x) - center(states[0].x)), block = velocity;
  Eigen::Vector2d apart = Eigen::Vector2d::Zero();
  double mean = 0, peak = 0;
  int pressed = 0;
  for (std::size_t step = 2; step <= 140; ++step) {
    const Vec3 next = 64 * (center(states[step].x) - center(states[step - 1].x));
    const double press = std::max(0.0, normal.dot(next - freely(velocity)));
    pressed += press > 0;
    const double error = 64 * (along(next) - rubbed(freely(velocity), press)).norm();
    peak = std::max(peak, error);
    mean += step >= 77 ? error / 64 : 0;
    const Eigen::Vector2d slid = rubbed(freely(block), press);
    block = slid.x() * u + slid.y() * w;  // velocity normal to the plane does not matter
    apart += (along(next) - slid) / 64;
    velocity = next;
  }
  EXPECT_GT(pressed, 40);
  const Values v = measure(scene, [&](int step) { return states[static_cast<std::size_t>(step)]; });
  EXPECT_NEAR(v.at("slip.error"), mean, 1e-9);
  EXPECT_NEAR(v.at("slip.error.peak"), peak, 1e-9);
  EXPECT_NEAR(v.at("slip.distance"), apart.norm(), 1e-9);
}

/// contact.creep alone of the motion x(step); infinite: the scene has no such value.
template <class Motion>
double creep_of(const Scene& scene, const Motion& motion) {
  const auto metric = find_value("contact.creep").first->make(scene);
  if (!metric) return Summary::kInfinity;
  for (int step = 0; step <= scene.steps; ++step) {
    const State state = motion(step);
    metric->observe({step, step * scene.dt, state});
  }
  return metric->finish()[0];
}

/// Of a sheet of 3 x 3 whose vertices lie on the body and move along with it, beside which vertex i
/// goes by `slips(i, step)`.
template <class Slips>
double creep(const Collider& body, const std::vector<Vec3>& on_it, const Slips& slips) {
  Scene scene = sheet(3);
  scene.colliders = {body};
  scene.start.x = on_it;
  return creep_of(scene, [&](int step) {
    State state = scene.start;
    for (std::size_t i = 0; i < on_it.size(); ++i)
      state.x[i] = body.motion.moved(on_it[i] + slips(i, step), step * scene.dt);
    return state;
  });
}

std::vector<Vec3> nine(const std::function<Vec3(double, double)>& place) {
  std::vector<Vec3> all;
  for (int i = 0; i < 9; ++i) all.push_back(place(0.1 * (i % 3) - 0.1, 0.1 * (i / 3) - 0.1));
  return all;
}

TEST(ContactCreep, IsTheSpeedAlongABodyThatMovesAndTurns) {
  const Motion motion{.velocity = {0.3, 0.7, -0.2},
                      .spin = {0.4, -0.9, 0.6},
                      .pivot = {0.1, 0.2, -0.3},
                      .path = {{0, {0, 0, 0}}, {2.3, {1, 0, 0}}, {2.6, {1, -2, 0}}}};
  const std::vector<Vec3> level = nine([](double u, double w) { return Vec3(u, 0, w); });
  const std::vector<Vec3> round =
      nine([](double u, double w) { return Vec3(0.5 * Vec3(u, 1, w).normalized()); });
  const Collider box{Box{{0, -0.2, 0}, {1, 0.2, 1}}, motion, 0.3},
      ball{Ball{Vec3::Zero(), 0.5}, motion, 0.3};
  const auto holds = [](std::size_t, int) { return Vec3(0, 0, 0); };
  EXPECT_NEAR(creep(box, level, holds), 0, 1e-12);
  EXPECT_NEAR(creep(ball, round, holds), 0, 1e-12);
  const auto one_slides = [](std::size_t i, int step) {
    return i == 4 ? Vec3(-0.03 * step / 64, 0, 0.04 * step / 64) : Vec3(0.01 * step / 64, 0, 0);
  };
  EXPECT_NEAR(creep(box, level, one_slides), 0.05, 1e-12);
  EXPECT_NEAR(creep({Plane{}, {.velocity = {0, 0.2, 0.3}}, 0.3}, level, one_slides), 0.05, 1e-12);
  EXPECT_EQ(creep({Box{{0, -0.2, 0}, {1, 0.2, 1}}, motion, 0}, level, one_slides),
            Summary::kInfinity)
      << "no value without friction";
  const auto turns = [&](std::size_t i, int step) {  // about y
    return Vec3(Eigen::AngleAxisd(1e-4 * step / 64, Vec3::UnitY()) * round[i] - round[i]);
  };
  EXPECT_NEAR(creep(ball, round, turns), 1e-4 * 0.5 * std::sqrt(0.02 / 1.02), 1e-10);
}

TEST(ContactCreep, IsNoTremblingAndNeedsTouchThroughoutTheLastSecond) {
  const Collider plane{Plane{}, {}, 0.3};
  const std::vector<Vec3> level = nine([](double u, double w) { return Vec3(u, 0, w); });
  const double hover = 9.81 / 64 / 64;
  const auto trembles = [&](std::size_t, int step) {
    return step % 2 ? Vec3(0.002, 1.9 * hover, 0) : Vec3(0, -0.001, 0);
  };
  EXPECT_NEAR(creep(plane, level, trembles), 0, 1e-12);
  const auto sinks = [&](std::size_t, int step) { return Vec3(0, -0.01 * step / 64, 0); };
  EXPECT_NEAR(creep(plane, level, sinks), 0, 1e-12);
  for (const int off : {127, 128, 160, 192}) {  // step at which a vertex that slides lifts off
    const auto lifts = [&](std::size_t i, int step) {
      const double up = i == 2 && step == off ? 2.5 * hover : 0;
      return Vec3((i == 2 ? 0.4 : 0.1) * step / 64, up, 0);
    };
    EXPECT_NEAR(creep(plane, level, lifts), off == 127 ? 0.4 : 0.1, 1e-12) << off;
  }
  const auto all_lift = [&](std::size_t, int step) { return Vec3(0, step == 190 ? 0.1 : 0, 0); };
  EXPECT_TRUE(std::isnan(creep(plane, level, all_lift)));
}

TEST(ContactCreep, FollowsTheBodyThatHoldsAVertexAndSurfacesThatDeform) {
  Scene scene = sheet(3);
  scene.start.x = nine([](double u, double w) { return Vec3(u, 0, w); });
  const Collider belt{Plane{}, {.velocity = {0.5, 0, 0}}, 0.1},
      lid{Plane{.normal = {0, -1, 0}}, {}, 0.9}, ceiling{Plane{.normal = {0, -1, 0}}, {}, 0};
  const auto at = [&](std::vector<Collider> colliders, double speed) {
    scene.colliders = std::move(colliders);
    return creep_of(scene, [&](int step) {
      State state = scene.start;
      for (Vec3& x : state.x) x.x() += speed * step * scene.dt;
      return state;
    });
  };
  EXPECT_NEAR(at({belt, lid}, 0), 0, 1e-12);
  EXPECT_NEAR(at({belt, lid}, 0.5), 0, 1e-12);
  EXPECT_NEAR(at({belt, lid}, 0.4), 0.1, 1e-12);
  EXPECT_NEAR(at({belt, ceiling}, 0), 0.5, 1e-12) << "a smooth body holds nothing";
  scene.steps = 64;
  const Triangles block = box_of_triangles({1, 0.2, 1});
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 1 / scene.dt;
  for (int k = 0; k <= scene.steps; ++k) {
    frames->places.push_back(block.vertices);
    for (Vec3& x : frames->places.back()) x.x() *= 1 + 0.3 * k * scene.dt;
  }
  const Collider deforms{
      .shape = MeshBody{block.mesh(), {0, -0.2, 0}}, .friction = 0.5, .frames = std::move(frames)};
  // those at x = -0.1 and 0.1 m stay behind a top that has grown to 1.3 times its width
  EXPECT_NEAR(at({deforms}, 0), 0.1 * 0.3, 1e-12);
  scene.pins = {0, 2, 3, 5, 6, 8};
  EXPECT_NEAR(at({deforms}, 0), 0, 1e-9) << "those in the middle are on its axis";
}

TEST(Tunnelling, CountsPassagesWithinOneStepAndForgetsReturns) {
  Scene scene = sheet(3);
  scene.start.x[5].y() = -0.995;  // starts inside, at the top
  scene.colliders = {{.shape = Box{.center = {0.5, -1, 0.5}, .half_extents = {2, 0.01, 2}}}};
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    if (step >= 10) state.x[0].y() = -2;                        // passes through in one step
    if (step >= 10) state.x[1].y() = -1 + 0.001 * (15 - step);  // passes through slowly
    if (step >= 10 && step < 50) state.x[2].y() = -2;           // and returns
    if (step >= 10) state.x[3].y() = -0.995;                    // stays inside
    if (step >= 10) state.x[4] = {9, -2, 9};                    // passes beside the edge
    if (step >= 12) state.x[4] = {0.5, -2, 0.5};
    if (step >= 10) state.x[5].y() = -2;  // leaves at the bottom
    return state;
  });
  EXPECT_EQ(v.at("tunnelling.count"), 3);
  EXPECT_EQ(v.at("tunnelling.events"), 5);
  EXPECT_NEAR(v.at("tunnelling.share"), 3.0 / 9, 1e-12);
}

TEST(Tunnelling, SeesTheColliderMoveAndGrazesPardoned) {
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Ball{.center = {0.5, -1, 0.5}, .radius = 0.1},
                      .motion = {.velocity = {0, 64, 0}}}};  // moves 1 m a step, straight through
  EXPECT_EQ(measure_at_rest(scene, scene.start).at("tunnelling.count"), 1);
  // farther than R/sqrt(2) from the axis
  std::get<Ball>(scene.colliders[0].shape).center.x() += 0.08;
  EXPECT_EQ(measure_at_rest(scene, scene.start).at("tunnelling.count"), 0);
}

}  // namespace
}  // namespace taut::contact_metrics_test
