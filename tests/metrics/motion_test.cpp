// Metrics of motion on states with answers in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/io/scene_io.hpp"
#include "core/reference/closed_forms.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/metrics/reference_path.hpp"
#include "tests/metrics/measured.hpp"

namespace taut::motion_test {
namespace {

using std::numbers::pi;

/// State at time t of a sheet thrown with a spin about its centre, as a rigid body in closed form.
State thrown(const Scene& scene, double t, const Vec3& gravity, double spin) {
  const Vec3 center(0.5, 0, 0.5), throws(1, 2, -0.5), axis = Vec3(0, 1, 0);
  State state = scene.start;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3 arm = Eigen::AngleAxisd(spin * t, axis) * (scene.mesh.rest[i] - center);
    state.x[i] = center + arm + throws * t + gravity * t * t / 2;
    state.v[i] = throws + gravity * t + spin * axis.cross(arm);
  }
  return state;
}

TEST(Momentum, IsKeptInFreeFlightAndLostByDrag) {
  Scene scene = sheet(5);
  scene.gravity = {1, -9, 2};
  scene.start = thrown(scene, 0, scene.gravity, 3);
  const auto with = [&](const Vec3& gravity, double spin_loss) {
    return measure(scene, [&](int step) {
      State state = thrown(scene, step * scene.dt, gravity, 3);
      const State still = thrown(scene, step * scene.dt, gravity, 0);
      for (std::size_t i = 0; i < state.v.size(); ++i)
        state.v[i] -= spin_loss * step / scene.steps * (state.v[i] - still.v[i]);
      return state;
    });
  };
  Values v = with(scene.gravity, 0);
  EXPECT_NEAR(v.at("momentum.linear"), 0, 1e-12);
  EXPECT_NEAR(v.at("momentum.angular"), 0, 1e-12);
  v = with(0.9 * scene.gravity, 0.2);
  EXPECT_NEAR(v.at("momentum.linear"), 0.1 * 3 * std::sqrt(86.0), 1e-12);
  EXPECT_NEAR(v.at("momentum.angular"), 0.2, 1e-12);
}

TEST(Momentum, NeedsFreeFlightAndASpin) {
  Scene scene = sheet(3);
  scene.start.v.assign(9, Vec3(3, 1, 2));  // thrown without a spin
  EXPECT_TRUE(std::isnan(measure_at_rest(scene, scene.start).at("momentum.angular")));
  const auto absent = [](const Scene& s) {
    return !measure_at_rest(s, s.start).contains("momentum.linear");
  };
  Scene pinned = scene, plane = scene, windy = scene, damped = scene;
  pinned.pins = {0};
  plane.colliders = {{.shape = Plane{.offset = -9}}};
  windy.wind = Wind{};
  damped.damping = 0.1;
  EXPECT_FALSE(absent(scene));
  for (const Scene& s : {pinned, plane, windy, damped}) EXPECT_TRUE(absent(s));
}

/// State of a body with swings k = 0, 1, ... of `period` steps each. In a swing the kinetic energy
/// rises from 0 to `kinetic` and falls again, and the total energy goes from -k loss to -(k + 1)
/// loss [J].
State swinging(const Scene& scene, int step, int period, double kinetic, double loss) {
  const double mass = 0.5, at = static_cast<double>(step) / period,
               moves = kinetic * std::pow(std::sin(pi * at), 2), total = -loss * at;
  State state = scene.start;
  for (Vec3& v : state.v) v = {std::sqrt(2 * moves / mass), 0, 0};
  for (Vec3& x : state.x) x.y() += (total - moves) / (mass * 9.81);
  return state;
}

TEST(EnergyLoss, IsThatBetweenTurningPoints) {
  const Scene scene = sheet(3);
  for (const double loss : {0.0, 0.1, -0.05}) {
    const Values v = measure(scene, [&](int step) { return swinging(scene, step, 40, 0.8, loss); });
    EXPECT_NEAR(v.at("energy.loss"), loss / 0.8, 1e-12);  // four whole swings and a fraction
  }
}

TEST(EnergyLoss, IgnoresRipplesAndNeedsAWholeSwing) {
  const Scene scene = sheet(3);
  const auto rippled = measure(scene, [&](int step) {
    State state = swinging(scene, step, 48, 0.8, 0.1);
    if (step % 48 == 20)  // falls to half of the maximum and rises again: not a turning point
      for (Vec3& v : state.v) v *= std::sqrt(0.5);
    return state;
  });
  EXPECT_NEAR(rippled.at("energy.loss"), 0.1 / 0.8, 1e-12);
  const auto half = measure(scene, [&](int step) { return swinging(scene, step, 400, 0.8, 0.1); });
  EXPECT_TRUE(std::isnan(half.at("energy.loss")));
  Scene damped = scene;
  damped.damping = 0.1;
  EXPECT_FALSE(measure_at_rest(damped, damped.start).contains("energy.loss"));
}

TEST(EnergyLoss, IsNotOfClothThatTremblesOrSinks) {
  const Scene scene = sheet(3);  // m g L = 6.9 J
  const auto loss = [&](double kinetic, double lost) {
    return measure(scene, [&](int step) { return swinging(scene, step, 40, kinetic, lost); })
        .at("energy.loss");
  };
  EXPECT_NEAR(loss(0.01, 0.002), 0.2, 1e-9);
  EXPECT_TRUE(std::isnan(loss(0.0005, 0.0001)));
  EXPECT_NEAR(loss(0.8, 0.72), 0.9, 1e-12);
  EXPECT_TRUE(std::isnan(loss(0.8, 0.88)));
}

// Two weights, each on a spring, released at its rest length: u'' = g - u K/m.
TEST(Energy, HoldsThatOfElasticLinks) {
  Scene scene = sheet(2);
  const auto u_of = [&](const State& s) { return Vec3(s.x[2] - s.x[0]); };
  const Vec3 down = u_of(scene.start).normalized();
  scene.gravity = 9.81 * down;
  scene.stiffness[static_cast<std::size_t>(Family::structural)] = 30;
  const double mass = scene.mesh.mass[2], omega = std::sqrt(30 / mass), sag = mass * 9.81 / 30;
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    const double phase = omega * step * scene.dt;
    for (const std::size_t i : {2U, 3U}) {
      state.x[i] += sag * (1 - std::cos(phase)) * down;
      state.v[i] = sag * omega * std::sin(phase) * down;
    }
    return state;
  });
  EXPECT_NEAR(v.at("energy.loss"), 0, 1e-12);
  EXPECT_NEAR(v.at("energy.mean"), 0, 1e-14);
  EXPECT_GT(v.at("energy.kinetic"), 1e-3);
}

TEST(Pins, CarryTheWeightAndTheCentripetalForce) {
  Scene scene = sheet(3);
  scene.pins = {4};
  EXPECT_NEAR(measure_at_rest(scene, scene.start).at("pins.force"), 1, 1e-12);
  // Lifted with an acceleration of 2 m/s^2, the free share 0.75 of the mass adds 2/9.81 of its
  // weight.
  const auto lifted = [&](int step) {
    State state = scene.start;
    for (Vec3& v : state.v) v.y() = 2 * step * scene.dt;
    return state;
  };
  EXPECT_NEAR(measure(scene, lifted).at("pins.force"), 1 + 0.75 * 2 / 9.81, 1e-12);
  // With damping, the damped velocity is what the cloth would have without pins and gravity.
  scene.damping = 2;
  scene.gravity = {0, -9.81, 0};
  const double keep = std::exp(-2 * scene.dt);
  for (Vec3& v : scene.start.v) v.x() = 1;
  const auto slows = [&](int step) {
    State state = scene.start;
    for (Vec3& v : state.v) v.x() = std::pow(keep, step);
    return state;
  };
  EXPECT_NEAR(measure(scene, slows).at("pins.force.peak"), 1, 1e-12);
  scene.colliders = {{.shape = Plane{.offset = -9}}};
  EXPECT_FALSE(measure_at_rest(scene, scene.start).contains("pins.force"));
}

TEST(Principal, OfUniformStrainsAreItsSingularValues) {
  const Scene scene = sheet(5);
  const double c = std::cos(0.4), s = std::sin(0.4);
  // deformation f within the sheet's plane, which is rotated in space
  const auto under = [&](const Eigen::Matrix2d& f) {
    State state = scene.start;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Eigen::Vector2d p = f * Eigen::Vector2d(scene.mesh.rest[i].x(), scene.mesh.rest[i].z());
      state.x[i] = Vec3(p.x(), s * p.y(), c * p.y());
    }
    return measure_at_rest(scene, state);
  };
  Values v = under(Eigen::Vector2d(1.1, 0.8).asDiagonal());
  for (const char* rank : {".p50", ".p95", ".max"}) {
    EXPECT_NEAR(v.at(std::string("principal.first") + rank), 0.1, 1e-12);
    EXPECT_NEAR(v.at(std::string("principal.second") + rank), 0.2, 1e-12);
    EXPECT_NEAR(v.at(std::string("principal.weft") + rank), 0.1, 1e-12);
    EXPECT_NEAR(v.at(std::string("principal.warp") + rank), 0.2, 1e-12);
    EXPECT_NEAR(v.at(std::string("principal.bias") + rank),
                1 - std::sqrt((1.1 * 1.1 + 0.8 * 0.8) / 2), 1e-12);
  }
  // Simple shear by k does not strain threads along u; sigma = sqrt(1 + k^2/4) +- k/2.
  const double k = 0.6;
  v = under((Eigen::Matrix2d() << 1, k, 0, 1).finished());
  EXPECT_NEAR(v.at("principal.first.max"), std::sqrt(1 + k * k / 4) + k / 2 - 1, 1e-12);
  EXPECT_NEAR(v.at("principal.second.max"), 1 - std::sqrt(1 + k * k / 4) + k / 2, 1e-12);
  EXPECT_NEAR(v.at("principal.weft.max"), 0, 1e-12);
  EXPECT_NEAR(v.at("principal.warp.max"), std::sqrt(1 + k * k) - 1, 1e-12);
  EXPECT_NEAR(v.at("principal.bias.max"), std::hypot(1 + k, 1) / std::sqrt(2.0) - 1, 1e-12);
}

TEST(Principal, PercentilesAreOverFacesAndMoments) {
  Scene scene = sheet(3);  // eight faces; one corner touches one or two of them
  const auto& faces = scene.mesh.triangles;
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x) x.x() *= 1 + 0.1 * step / scene.steps;
    return state;
  });
  EXPECT_NEAR(v.at("principal.first.p50"), 0.1 * (192 - 27) / 192, 1e-12);
  EXPECT_NEAR(v.at("principal.first.max"), 0.1, 1e-12);
  State corner = scene.start;
  corner.x[8] += Vec3(0.25, 0, 0.25);
  const auto touched =
      std::ranges::count_if(faces, [](const Triangle& t) { return std::ranges::count(t, 8) > 0; });
  EXPECT_LE(touched, 2);
  const Values one = measure_at_rest(scene, corner);
  EXPECT_NEAR(one.at("principal.first.p50"), 0, 1e-12);
  EXPECT_GT(one.at("principal.first.p95"), 0.2);
  scene.mesh.grid.reset();
  const Values mesh = measure_at_rest(scene, corner);
  EXPECT_EQ(mesh.at("principal.first.p95"), one.at("principal.first.p95"));
  EXPECT_TRUE(std::isnan(mesh.at("principal.warp.p50")));
}

TEST(SelfIntersection, HasTheLengthOfTheLinesAlongWhichFacesCross) {
  Scene scene = sheet(2);
  scene.mesh.rest = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 0.5, -1}, {1, 0.5, 1}, {1, 5, 1}};
  scene.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  scene.mesh.mass.assign(6, 1.0);
  scene.mesh.grid.reset();
  scene.links.clear();
  scene.start = {scene.mesh.rest, std::vector<Vec3>(6, Vec3::Zero())};
  scene.self_collision = SelfCollision{.radius = 0.01};
  // In the plane z = 0 the second face is the line x = 1 from y = 0.5 to 2.75. The hem of the first
  // face, x + y = 3, cuts it at y = 2.
  EXPECT_NEAR(measure_at_rest(scene, scene.start).at("self.contour"), 1.5, 1e-12);
  State apart = scene.start;
  for (const std::size_t i : {3u, 4u, 5u}) apart.x[i].z() += 1.5;
  EXPECT_EQ(measure_at_rest(scene, apart).at("self.contour"), 0);
}

/// Vertices that oscillate by unequal ways.
State swaying(const Scene& scene, double t) {
  State state = scene.start;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Vec3 way(0.1, 0.02 * static_cast<double>(i), -0.3);
    state.x[i] += (1 - std::cos(2.5 * t)) * way;
    state.v[i] = 2.5 * std::sin(2.5 * t) * way;
  }
  return state;
}

ReferencePath along(const Scene& scene, const std::function<double(double)>& time) {
  MotionReference reference{.derivation = "closed form", .horizon = 2};
  for (int k = 0; k <= 32; ++k) reference.states.push_back(swaying(scene, k / 16.0));
  ReferencePath path(scene, reference);
  for (int step = 0; step <= scene.steps; ++step) {
    const State state = swaying(scene, time(step * scene.dt));
    path.observe({step, step * scene.dt, state});
  }
  return path;
}

TEST(ReferencePath, OfTheReferenceItselfIsAllOfItsWay) {
  Scene scene = sheet(3);
  scene.pins = {4};
  const ReferencePath path = along(scene, [](double t) { return t; });
  EXPECT_NEAR(path.share(), 1, 1e-12);
  EXPECT_NEAR(path.error(), 0, 1e-12);
  EXPECT_NEAR(path.phase(), 0, 1e-12);
  EXPECT_EQ(path.horizon(), 2);
}

TEST(ReferencePath, HasThePhaseOfAMotionThatIsLateOrEarly) {
  Scene scene = sheet(3);
  scene.pins = {4};
  for (const double late : {0.1, 0.25, -0.2})
    EXPECT_NEAR(along(scene, [&](double t) { return t - late; }).phase(), late, 2e-3);
}

/// E by its definition, and a cloth that stands still or is frozen at the mean of the swing.
TEST(ReferencePath, OfASlowedAndOfAFrozenClothIsAShare) {
  Scene scene = sheet(3);
  scene.pins = {4};
  const auto slowed = [&](double speed) {
    return along(scene, [=](double t) { return speed * t; });
  };
  double apart = 0, square = 0;
  for (int k = 1; k <= 32; ++k) {
    const auto factor = [](double t) { return 1 - std::cos(2.5 * t); };
    apart += std::pow(factor(k / 32.0) - factor(k / 16.0), 2);
    square += std::pow(factor(k / 16.0), 2);
  }
  EXPECT_NEAR(slowed(0.5).error(), std::sqrt(apart / square), 1e-12);
  EXPECT_EQ(slowed(0).share(), 0);
  EXPECT_EQ(slowed(0).error(), 1);
  EXPECT_TRUE(std::isnan(slowed(0).phase()));
  scene.steps = 60;  // the run ends before the horizon
  EXPECT_EQ(slowed(1).horizon(), 0.9375);
  EXPECT_TRUE(std::isnan(slowed(1).phase()));
  scene.steps = 3;
  EXPECT_TRUE(std::isnan(slowed(1).share()));
}

/// A frozen plate that falls as the cloth does has not moved: without pins the common fall counts
/// as standing still, and moving pins carry a cloth along.
TEST(ReferencePath, LeavesOutWhatNoSolverCanMiss) {
  Scene scene = sheet(3);
  const Vec3 down(0, -1, 0);
  MotionReference reference{.derivation = "made up", .horizon = 2};
  for (int k = 0; k <= 32; ++k) {
    State state = swaying(scene, k / 16.0);
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.x[i] += 4 * (state.x[i] - scene.start.x[i]) + k / 16.0 * down;
    for (Vec3& v : state.v) v += down;
    reference.states.push_back(state);
  }
  Vec3 mean = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < scene.mesh.mass.size(); ++i) {
    mean += 5 * scene.mesh.mass[i] * Vec3(0.1, 0.02 * static_cast<double>(i), -0.3);
    mass += scene.mesh.mass[i];
  }
  mean /= mass;
  ReferencePath path(scene, reference);
  for (int step = 0; step <= scene.steps; ++step) {
    const double t = step * scene.dt;
    State plate = scene.start;
    for (Vec3& x : plate.x) x += t * down + (1 - std::cos(2.5 * t)) * mean;
    path.observe({step, t, plate});
  }
  EXPECT_NEAR(path.error(), 1, 1e-9);
  EXPECT_LT((path.still(1, reference.states[16].x)[0] - (down + (1 - std::cos(2.5)) * mean)).norm(),
            1e-12);
}

Scene shipped(const std::string& name, const SceneSettings& set) {
  return load_scene(
      std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes" / (name + ".toml"), set);
}

// A strain metric alone misses this: a cloth that hangs frozen in the air has no strain.
TEST(MotionBesideStrain, AFrozenClothIsFirstInStrainAndLastInMotion) {
  const Scene scene = shipped("swing", {"links.shear=false", "time.duration=2.5"});
  const Values frozen = measure_at_rest(scene, scene.start);
  EXPECT_NEAR(frozen.at("stretch.rms"), 0, 1e-12);
  EXPECT_EQ(frozen.at("motion.share"), 0);
  EXPECT_EQ(frozen.at("motion.error"), 1);
  for (const char* solver :
       {"jakobsen:substeps=4,order=mesh,iterations=1", "bullet:iterations=64"}) {
    const Record run = run_case(scene, parse_solver(solver)).record;
    EXPECT_GT(run.values.at("stretch.rms"), 1e-3) << solver;
    EXPECT_GT(run.values.at("motion.share"), 0.8) << solver;
    EXPECT_LT(run.values.at("motion.error"), 0.5) << solver;
  }
}

TEST(MotionBesideStrain, OfAReferenceThatStaysNearTheStartIsNotJudged) {
  Scene scene = sheet(3);
  scene.pins = {4};
  MotionReference reference{.derivation = "made up", .horizon = 2};
  for (int k = 0; k <= 32; ++k) {
    State state = swaying(scene, k / 16.0);
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.x[i] -= 0.9 * (state.x[i] - scene.start.x[i]);
    reference.states.push_back(state);
  }
  ReferencePath path(scene, reference);
  for (int step = 0; step <= scene.steps; ++step)
    path.observe({step, step * scene.dt, scene.start});
  EXPECT_TRUE(std::isnan(path.error()) && std::isnan(path.share()) && std::isnan(path.horizon()));
}

/// Values of a chain in its lowest mode with this damping ratio, in closed form.
Values in_mode(double ratio, double slower, double scale = 0.05) {
  const int n = 16;
  Scene scene = sheet(2);
  scene.mesh =
      make_sheet({.nu = 1, .nv = n + 1, .height = 1, .mass = 1, .lumping = Lumping::equal});
  scene.links = grid_links(scene.mesh, {});
  scene.pins = {0};
  scene.steps = 64 * 20;
  const std::vector<double> shape = reference::hanging_chain_mode(n, 1);
  const double w = reference::hanging_chain_frequencies(n, 1, 9.81)[0] / slower;
  const auto at = [&](double t) {
    State state{scene.mesh.rest, std::vector<Vec3>(17, Vec3::Zero())};
    for (std::size_t i = 1; i < state.x.size(); ++i)
      state.x[i].z() = scale * shape[i - 1] *
                       std::exp(-ratio * w / std::sqrt(1 - ratio * ratio) * t) * std::cos(w * t);
    return state;
  };
  scene.start = at(0);
  return measure(scene, [&](int step) { return at(step * scene.dt); });
}

TEST(Mode, OfADampedSwingHasItsDampingRatioAndPeriod) {
  for (const double ratio : {0.0, 0.003, 0.03, 0.2, -0.001})
    for (const double slower : {1.0, 1.02}) {
      const Values v = in_mode(ratio, slower);
      EXPECT_NEAR(v.at("mode.damping"), ratio, 2e-6 + 1e-3 * std::abs(ratio)) << ratio;
      EXPECT_NEAR(v.at("mode.period"), slower - 1, 1e-5) << ratio;
    }
  EXPECT_TRUE(std::isnan(in_mode(0.9, 1).at("mode.damping"))) << "no second amplitude";
  EXPECT_FALSE(in_mode(0, 1, 0.11).contains("mode.damping")) << "no small swing";
  EXPECT_FALSE(in_mode(0, 1, 0).contains("mode.damping")) << "hangs at rest";
}

TEST(Mode, SeesNothingOfHigherModes) {
  // a sheet whose rows weigh as much as the chain's vertices, in columns of other weights
  const int n = 16;
  Scene scene = sheet(2);
  scene.mesh = make_sheet({.nu = 3, .nv = n + 1, .width = 0.5, .height = 1, .mass = 1});
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 3; ++i)
      scene.mesh.mass[static_cast<std::size_t>(3 * j + i)] = 0.1 + 0.1 * i;
  scene.links = grid_links(scene.mesh, {.shear = true});
  scene.pins = {0, 1, 2};
  scene.steps = 64 * 10;
  const auto w = reference::hanging_chain_frequencies(n, 1, 9.81);
  const auto at = [&](double t) {
    State state{scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
    for (const int mode : {1, 2}) {
      const auto shape = reference::hanging_chain_mode(n, mode);
      for (std::size_t i = 3; i < state.x.size(); ++i)
        state.x[i].z() +=
            0.03 * shape[i / 3 - 1] * std::cos(w[static_cast<std::size_t>(mode - 1)] * t);
    }
    return state;
  };
  scene.start = at(0);
  const Values v = measure(scene, [&](int step) { return at(step * scene.dt); });
  EXPECT_NEAR(v.at("mode.damping"), 0, 1e-8);
  EXPECT_NEAR(v.at("mode.period"), 0, 1e-5);
}

}  // namespace
}  // namespace taut::motion_test
