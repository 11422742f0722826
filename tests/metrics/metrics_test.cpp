// Metrics on states with answers in closed form, and the symmetries that all metrics obey.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference.hpp"
#include "tests/metrics/measured.hpp"

namespace taut::metrics_test {
namespace {

TEST(Metrics, HaveUniqueNamesAndUnits) {
  std::map<std::string_view, int> seen;
  Scene scene = sheet(3);
  scene.colliders = {{.shape = Ball{.center = {0.5, -9, 0.5}, .radius = 0.1}}};
  scene.self_collision = SelfCollision{.radius = 0.01};
  for (const MetricEntry* entry : metrics()) {
    const auto metric = entry->make(scene);
    if (!metric) continue;
    metric->observe({0, 0, scene.start});
    EXPECT_EQ(metric->now({0, 0, scene.start}).size(), entry->values.size()) << entry->name;
    for (const ValueSpec& value : entry->values) {
      EXPECT_EQ(++seen[value.name], 1) << value.name;
      EXPECT_FALSE(value.unit.si.empty() || value.help.empty()) << value.name;
      EXPECT_TRUE(value.role != Role::error || value.negligible > 0) << "no mean of logarithms";
      EXPECT_TRUE(!value.shown_over_time || value.in_series) << value.name;
      EXPECT_TRUE(value.floor.value.empty() || value.floor.value == kStrainFloor ||
                  find_value(value.floor.value).second)
          << value.name;
    }
  }
}

TEST(Metrics, HaveUnitsOfTheKindThatTheyMeasure) {
  using Kind = Unit::Kind;
  for (const MetricEntry* entry : metrics())
    for (const ValueSpec& value : entry->values) {
      const Unit& unit = value.unit;
      EXPECT_EQ(unit.kind == Kind::length, unit.si == "m") << value.name;
      EXPECT_EQ(unit.kind == Kind::time, unit.si == "s") << value.name;
      EXPECT_EQ(unit.kind == Kind::share, unit.shown == "%") << value.name;
      if (unit.kind == Kind::count) {
        EXPECT_TRUE(unit.si == "1" && unit.shown.empty() && unit.scale == 1) << value.name;
      }
      if (value.role == Role::passages) {
        EXPECT_EQ(unit.kind, Kind::count) << value.name;
      }
    }
}

TEST(Metrics, AreAbsentWhereTheSceneLacksWhatTheyMeasure) {
  Scene scene = sheet(3);
  const Values plain = measure_at_rest(scene, scene.start);
  for (const char* name : {"penetration.max", "face.max", "tunnelling.count", "self.crossings"})
    EXPECT_FALSE(plain.contains(name)) << name;
  scene.colliders = {{.shape = Plane{.offset = -1}}};
  const Values plane = measure_at_rest(scene, scene.start);
  EXPECT_TRUE(plane.contains("penetration.max"));
  EXPECT_TRUE(std::isnan(plane.at("penetration.ball.max")));
  EXPECT_FALSE(plane.contains("face.max"));
  scene.gravity = Vec3::Zero();
  EXPECT_FALSE(measure_at_rest(scene, scene.start).contains("energy.mean"));
}

TEST(Metrics, OfARunThatDiesEarlySayNothingAboutItsEnd) {
  const Scene scene = sheet(3);
  const auto stretch = std::ranges::find(metrics(), "stretch", &MetricEntry::name);
  ASSERT_NE(stretch, metrics().end());
  const auto metric = (*stretch)->make(scene);
  metric->observe({0, 0, scene.start});
  metric->observe({1, scene.dt, scene.start});
  const auto values = metric->finish();
  EXPECT_TRUE(std::isnan(values[0]));  // stretch.rms
  EXPECT_NEAR(values[3], 0, 1e-12);    // stretch.peak
}

TEST(Stretch, OfAUniformStretchIsOnePercentByEveryMeasure) {
  const Scene scene = sheet();
  State state = scene.start;
  for (Vec3& x : state.x) x *= 1.01;
  const Values v = measure_at_rest(scene, state);
  for (const char* group : {"stretch", "structural", "shear", "bend"})
    for (const char* what : {".rms", ".max", ".p95"})
      EXPECT_NEAR(v.at(std::string(group) + what), 0.01, 1e-12) << group << what;
  EXPECT_NEAR(v.at("compression.max"), 0, 1e-12);
  EXPECT_NEAR(v.at("area.rms"), 1.01 * 1.01 - 1, 1e-12);
  EXPECT_NEAR(v.at("area.total"), 1.01 * 1.01 - 1, 1e-12);
}

// The n links are strained by 1, 2, ..., n per mille in irregular order, every other one shortened.
// All strains grow from zero to these values at the end.
TEST(Stretch, ThePercentileIsWhat95PercentDoNotExceed) {
  for (const int n : {1, 7, 19, 20, 21, 39, 40, 60}) {
    Scene scene = sheet(2);
    scene.mesh = make_sheet({.nu = 1, .nv = n + 1, .height = 1.0 * n, .mass = 1});
    scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
    scene.links = grid_links(scene.mesh, {});
    const auto v = measure(scene, [&](int step) {
      State state = scene.start;
      for (int k = 0; k < n; ++k) {
        const int rank = k * 11 % n + 1;  // 11 is coprime with every n
        const double strain = (rank % 2 ? 1e-3 : -1e-3) * rank * step / scene.steps;
        const auto i = static_cast<std::size_t>(k);
        state.x[i + 1] = state.x[i] + (1 + strain) * (scene.start.x[i + 1] - scene.start.x[i]);
      }
      return state;
    });
    int rank = 1;
    while (100 * rank < 95 * n) ++rank;
    // ten moments, six steps apart up to the last step: 27 steps before the end on average
    EXPECT_NEAR(v.at("stretch.p95"), 1e-3 * rank * (192 - 27) / 192, 1e-12) << n;
    EXPECT_NEAR(v.at("structural.p95"), v.at("stretch.p95"), 1e-15) << n;
    EXPECT_TRUE(std::isnan(v.at("shear.p95")));
    EXPECT_NEAR(v.at("stretch.max"), 1e-3 * (n - (n % 2 == 0)), 1e-12) << n;
    EXPECT_NEAR(v.at("compression.max"), 1e-3 * (n - n % 2), 1e-12) << n;
  }
}

TEST(Stretch, KeepsFamiliesAndSignsApart) {
  const Scene scene = sheet(3);  // 12 structural, 8 shear and 6 bend links
  State state = scene.start;
  for (Vec3& x : state.x) {
    x.z() *= 1.5;
    x.x() *= 0.5;
  }
  const Values v = measure_at_rest(scene, state);
  EXPECT_NEAR(v.at("structural.max"), 0.5, 1e-12);
  EXPECT_NEAR(v.at("structural.compression"), 0.5, 1e-12);
  EXPECT_NEAR(v.at("structural.rms"), 0.5, 1e-12);
  const double shear = std::sqrt((0.25 + 2.25) / 2) - 1;
  EXPECT_NEAR(v.at("shear.rms"), shear, 1e-12);
  EXPECT_NEAR(v.at("stretch.rms"), std::sqrt((12 * 0.25 + 8 * shear * shear) / 20), 1e-12);
  EXPECT_NEAR(v.at("area.total"), 0.75 - 1, 1e-12);
}

TEST(Stretch, ShearCollapseLosesAreaWithoutStrain) {
  const Scene scene = sheet();
  const double angle = std::numbers::pi / 6;  // between the sides; 90 degrees at rest
  State state = scene.start;
  for (Vec3& x : state.x) x = {x.x() + x.z() * std::cos(angle), 0, x.z() * std::sin(angle)};
  const Values v = measure_at_rest(scene, state);
  EXPECT_NEAR(v.at("structural.rms"), 0, 1e-12);
  EXPECT_NEAR(v.at("area.loss"), 0.5, 1e-12);
}

TEST(Stretch, MeansAreOverTheLastSecondAndPeaksOverTheRun) {
  const Scene scene = sheet(3);
  const auto v = measure(scene, [&](int step) {  // 20 % at 1 s, then alternately 1 % and 3 %
    State state = scene.start;
    for (Vec3& x : state.x) x *= step == 64 ? 1.2 : step % 2 ? 1.01 : 1.03;
    return state;
  });
  EXPECT_NEAR(v.at("stretch.peak"), 0.2, 1e-12);
  EXPECT_NEAR(v.at("stretch.rms.peak"), 0.2, 1e-12);
  EXPECT_NEAR(v.at("stretch.max"), 0.03, 1e-12);
  EXPECT_NEAR(v.at("stretch.rms"), std::sqrt((0.0001 + 0.0009) / 2), 1e-12);
}

TEST(Energy, OfAFallingBodyIsConserved) {
  const Scene scene = sheet(3);
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    const double t = step * scene.dt;
    for (Vec3& x : state.x) x += scene.gravity * t * t / 2;
    for (Vec3& u : state.v) u = scene.gravity * t;
    return state;
  });
  EXPECT_NEAR(v.at("energy.mean"), 0, 1e-12);
  EXPECT_NEAR(v.at("energy.peak"), 0, 1e-12);
  double kinetic = 0;  // g t^2/(2 L), averaged over the last second
  for (int step = 129; step <= 192; ++step)
    kinetic += 9.81 * std::pow(step * scene.dt, 2) / (2 * std::sqrt(2.0)) / 64;
  EXPECT_NEAR(v.at("energy.kinetic"), kinetic, 1e-9);
  EXPECT_NEAR(v.at("popping.peak"), 0, 1e-9);
  EXPECT_NEAR(v.at("drift.max"), 9.81 * 9 / 2, 1e-9);
}

TEST(Energy, IsAveragedOverTheLastSecondAndPeaksOverTheRun) {
  const Scene scene = sheet(3);
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x) x.y() += step == 10 ? 0.9 : step % 2 ? 0.3 : 0.1;
    return state;
  });
  EXPECT_NEAR(v.at("energy.mean"), 0.2 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(v.at("energy.peak"), 0.9 / std::sqrt(2), 1e-12);
  EXPECT_EQ(v.at("energy.kinetic"), 0);
}

TEST(Drift, IsThatOfTheCentreOfMass) {
  const Scene scene = sheet(3);
  const double share = scene.mesh.mass[4] / 0.5;
  EXPECT_NEAR(share, 0.25, 1e-12);
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    state.x[4] += step == 30 ? Vec3(0, 0.5, 0) : Vec3(0.03, 0, step % 2 ? 0.04 : -0.04);
    return state;
  });
  EXPECT_NEAR(v.at("drift.max"), share * 0.5, 1e-12);
  EXPECT_NEAR(v.at("drift.mean"), share * 0.05, 1e-12);
}

TEST(Energy, OfALiftedBodyIsItsHeight) {
  const Scene scene = sheet(3);
  State state = scene.start;
  for (Vec3& x : state.x) x.y() += 0.3;
  EXPECT_NEAR(measure_at_rest(scene, state).at("energy.mean"), 0.3 / std::sqrt(2), 1e-12);
}

TEST(Jitter, IsTheSpeedOfFreeVerticesAndSettlingItsEnd) {
  Scene scene = sheet(3);
  scene.pins = {0};
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    for (Vec3& u : state.v) u.x() = step <= 96 ? 0.006 : 0.004;
    state.v[0].x() = 1000;  // motion of a pin, as a solver might report it, is not jitter
    return state;
  });
  EXPECT_NEAR(v.at("jitter.rms"), 0.004, 1e-12);
  EXPECT_NEAR(v.at("jitter.max"), 0.004, 1e-12);
  EXPECT_DOUBLE_EQ(v.at("settle.time"), 1.5);
}

TEST(Settle, IsWhenTheLastRestBeginsOfEveryVertex) {
  Scene scene = sheet(3);
  scene.pins = {0};
  // displacements of one vertex at steps 40 and 70
  const auto when = [&](double first, double second) {
    return measure(scene,
                   [&](int step) {
                     State state = scene.start;
                     state.x[5].z() += (step >= 40 ? first : 0) + (step >= 70 ? second : 0);
                     state.x[0].z() += step;  // a pin
                     return state;
                   })
        .at("settle.time");
  };
  EXPECT_DOUBLE_EQ(when(0.4e-3, 0), 0);
  EXPECT_DOUBLE_EQ(when(0.6e-3, 0.4e-3), 40 * scene.dt);
  EXPECT_DOUBLE_EQ(when(0.6e-3, 0.6e-3), 70 * scene.dt);
  EXPECT_DOUBLE_EQ(when(0.3e-3, 0.3e-3), 70 * scene.dt);
}

TEST(Jitter, IsTheRmsOverVerticesAndTimeAndTheFastest) {
  Scene scene = sheet(3);
  scene.pins = {0};
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    for (std::size_t i = 0; i < 9; ++i)  // a hundred times as fast before the last second
      state.v[i].z() = 1e-3 * static_cast<double>(i) * (step <= 128 ? 100 : step % 2 ? 1 : 3);
    return state;
  });
  const double over_vertices = 204.0 / 8;  // mean of i^2, i = 1 .. 8
  EXPECT_NEAR(v.at("jitter.rms"), 1e-3 * std::sqrt(over_vertices * (1 + 9) / 2), 1e-12);
  EXPECT_NEAR(v.at("jitter.max"), 24e-3, 1e-12);
}

TEST(Popping, IsTheJumpOfOneVertex) {
  const Scene scene = sheet(3);
  const auto v = measure(scene, [&](int step) {
    State state = scene.start;
    if (step >= 20) state.x[4].y() += 0.03;
    if (step >= 180) state.x[5].z() += 0.01;
    return state;
  });
  EXPECT_NEAR(v.at("popping.max"), 0.01 * 64 * 64 - 9.81, 1e-9);
  EXPECT_NEAR(v.at("popping.peak"), 0.03 * 64 * 64 - 9.81, 1e-9);
}

TEST(SelfIntersection, OfAFlapThatFoldsThroughTheSheet) {
  Scene scene = sheet(5);
  scene.self_collision = SelfCollision{.radius = 0.05};
  Values v = measure_at_rest(scene, scene.start);
  EXPECT_EQ(v.at("self.crossings"), 0);
  EXPECT_EQ(v.at("self.gap"), 0);
  State state = scene.start;  // the last row is folded back below the first
  for (int i = 0; i < 5; ++i) {
    state.x[static_cast<std::size_t>(15 + i)] += Vec3(0.01, 0.2, -0.3);
    state.x[static_cast<std::size_t>(20 + i)] += Vec3(0.01, -0.2, -0.9);
  }
  v = measure_at_rest(scene, state);
  EXPECT_GT(v.at("self.crossings"), 0);
  EXPECT_EQ(v.at("self.crossings"), v.at("self.crossings.peak"));
  state = scene.start;
  state.x[0] = state.x[24] + Vec3(0, 0.03, 0);
  EXPECT_NEAR(measure_at_rest(scene, state).at("self.gap"), 0.03 - 0.1, 1e-12);
}

// Balls that overlap at rest are not self-penetration in themselves; only a distance below that at
// rest counts.
TEST(SelfIntersection, BallsThatOverlapAtRestAreNearerThanAtRest) {
  Scene scene = sheet(5);
  scene.self_collision = SelfCollision{.radius = 0.2};  // particles are 0.25 m apart
  EXPECT_EQ(measure_at_rest(scene, scene.start).at("self.gap"), 0);
  State state = scene.start;
  state.x[12] += 0.1 * (state.x[13] - state.x[12]);
  EXPECT_NEAR(measure_at_rest(scene, state).at("self.gap"), -0.025, 1e-12);
}

// Of 192 steps every 9th is examined; of the last second (64 steps) every 6th, counted back from
// the end.
TEST(SelfIntersection, IsLookedForAtTwentyMomentsOfTheRun) {
  Scene scene = sheet(5);
  scene.self_collision = SelfCollision{.radius = 0.05};
  State folded = scene.start;
  for (std::size_t i = 15; i < 25; ++i)
    folded.x[i] += Vec3(0.01, i < 20 ? 0.2 : -0.2, i < 20 ? -0.3 : -0.9);
  const auto folded_at = [&](int when) {
    return measure(scene, [&](int step) { return step == when ? folded : scene.start; });
  };
  const double crossed = measure_at_rest(scene, folded).at("self.crossings");
  ASSERT_GT(crossed, 0);
  const std::pair<int, const char*> seen[] = {{192, "self.crossings"},
                                              {192 - 6, "self.crossings.max"},
                                              {192 - 54, "self.crossings.max"},
                                              {27, "self.crossings.peak"},
                                              {9, "self.crossings.peak"}};
  for (const auto& [when, name] : seen) {
    const Values v = folded_at(when);
    EXPECT_EQ(v.at(name), crossed) << when;
    EXPECT_EQ(v.at("self.crossings.peak"), crossed) << when;
    EXPECT_EQ(v.at("self.crossings"), when == 192 ? crossed : 0) << when;
    EXPECT_EQ(v.at("self.crossings.max"), when > 128 ? crossed : 0) << when;
    EXPECT_EQ(v.at("self.contour") > 0, when == 192) << when;
  }
  EXPECT_EQ(folded_at(28).at("self.crossings.peak"), 0) << "between two of those moments";
}

// Coplanar layers do not intersect: without this check a fold at rest without self-collision would
// look like a cloth that never passed through itself.
TEST(SelfIntersection, CountsLayersThatCoincide) {
  Scene scene = sheet(5);
  scene.self_collision = SelfCollision{.radius = 0.05};
  State folded = scene.start;  // the last two rows lie on the first two, shifted by half a cell
  for (std::size_t i = 15; i < 25; ++i) {
    folded.x[i].x() += 0.11;
    folded.x[i].z() = 1 - folded.x[i].z();
  }
  const auto lifted = [&](double height) {
    State state = folded;
    for (std::size_t i = 15; i < 25; ++i) state.x[i].y() += height;
    return measure_at_rest(scene, state);
  };
  const double flat = lifted(0).at("self.crossings");
  EXPECT_GT(flat, 8);
  EXPECT_EQ(lifted(0).at("self.crossings.max"), flat);
  EXPECT_EQ(lifted(0.4e-3).at("self.crossings"), flat) << "within 1 % of the radius";
  EXPECT_LT(lifted(0.6e-3).at("self.crossings"), flat);
  EXPECT_EQ(lifted(0.1).at("self.crossings"), 0);
}

/// The scene after a rigid motion of the whole world.
struct Rigid {
  Eigen::Quaterniond turn{Eigen::AngleAxisd(0.8, Vec3(1, 2, -0.5).normalized())};
  Vec3 shift{0.3, -0.7, 1.1};
  Vec3 point(const Vec3& p) const { return turn * p + shift; }
  State operator()(State s) const {
    for (Vec3& x : s.x) x = point(x);
    for (Vec3& v : s.v) v = turn * v;
    return s;
  }
  Scene operator()(Scene s) const {
    s.start = (*this)(s.start);
    s.gravity = turn * s.gravity;
    for (Collider& c : s.colliders) {
      c.motion.velocity = turn * c.motion.velocity;
      if (auto* plane = std::get_if<Plane>(&c.shape)) {
        const Vec3 on = point(plane->offset * plane->normal);
        plane->normal = turn * plane->normal;
        plane->offset = plane->normal.dot(on);
      }
      if (auto* ball = std::get_if<Ball>(&c.shape)) ball->center = point(ball->center);
      if (auto* box = std::get_if<Box>(&c.shape)) {
        box->center = point(box->center);
        box->rotation = turn * box->rotation;
      }
      if (auto* capsule = std::get_if<Capsule>(&c.shape)) {
        capsule->from = point(capsule->from);
        capsule->to = point(capsule->to);
      }
    }
    return s;
  }
};

/// Scene with every feature, whose states violate every constraint. Rigid leaves the rest shape
/// alone: metrics use its distances, and its bounding box as a unit. Nothing is symmetric, so that
/// no vertex is equally near to two sides.
Scene busy_scene() {
  Scene scene = sheet(6);
  scene.pins = {0, 5};
  scene.colliders = {
      {.shape = Plane{.normal = Vec3(0.1, 1, 0).normalized(), .offset = 0.02}},
      {.shape = Ball{.center = {0.52, -0.1, 0.47}, .radius = 0.2},
       .motion = {.velocity = {0, 1, 0}}},
      {.shape = Box{.center = {0.22, 0.013, 0.77}, .half_extents = {0.1, 0.2, 0.3}}},
      {.shape = Capsule{.from = {0.7, 0.02, 0.1}, .to = {0.9, -0.1, 0.3}, .radius = 0.12}}};
  scene.self_collision = SelfCollision{.radius = 0.05};
  scene.thickness = 0.003;
  scene.steps = 12;
  return scene;
}

std::vector<State> noisy_states(const Scene& scene) {
  std::mt19937 random(7);
  std::normal_distribution<> noise(0, 0.08);
  const auto draw = [&] {  // braces evaluate from left to right with every compiler
    return Vec3{std::array{noise(random), noise(random), noise(random)}.data()};
  };
  std::vector<State> states;
  for (int step = 0; step <= scene.steps; ++step) {
    states.push_back(scene.start);
    for (Vec3& x : states.back().x) x += draw();
    for (Vec3& v : states.back().v) v = draw();
  }
  return states;
}

void expect_same(const Values& a, const Values& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, value] : a)
    if (std::isnan(value))
      EXPECT_TRUE(std::isnan(b.at(name))) << name;
    else
      EXPECT_NEAR(value, b.at(name), 1e-9 * std::max(1.0, std::abs(value))) << name;
}

TEST(ReferenceDistance, IsThatFromTheCommittedState) {
  Scene scene =
      load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/drape.toml");
  const References known = known_references(scene);
  ASSERT_TRUE(known.rest);
  scene.dt = 0.25;  // differs from the reference's, which does not matter
  scene.steps = 4;
  const auto pins = [&](std::size_t i) {
    return std::ranges::count(scene.pins, static_cast<int>(i));
  };
  const auto motion = [&](int) {
    State state{known.rest->x, scene.start.v};
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      if (pins(i)) state.x[i] += Vec3(0, 0, 5);  // pins are moved by the scene, not by the solver
      state.x[i] += Vec3(0, 0.03, -0.04);
    }
    return state;
  };
  const Values end = measure(scene, motion);
  EXPECT_EQ(end.at("reference.floor"), known.rest->floor);
  EXPECT_NEAR(end.at("reference.rms"), 0.05, 1e-15);
  EXPECT_NEAR(end.at("reference.max"), 0.05, 1e-15);
  scene.mesh.mass[3] *= 2;  // another cloth, which has no reference
  EXPECT_FALSE(measure(scene, motion).contains("reference.rms"));
}

/// Elastic cloth has references of its own: springs that another program integrates explicitly
/// reproduce them, and springs that are 2 % softer do not.
TEST(ReferenceMotion, OfElasticClothIsThatOfItsStiffness) {
  const auto error = [](const std::string& solver) {
    const Scene scene =
        load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/swing.toml",
                   {"cloth.grid=[12, 12]", "links.stiffness={ structural = 300, shear = 300 }",
                    "time.duration=2"});
    EXPECT_TRUE(known_references(scene).motion);
    const SolverChoice choice = parse_solver(solver + ",precision=double,substeps=512");
    const auto instance = choice.entry->make(scene, choice.params);
    instance->load(scene.start);
    std::vector<State> states{scene.start};
    for (int n = 0; n < scene.steps; ++n) {
      instance->step(n * scene.dt, scene.dt);
      instance->store(states.emplace_back());
    }
    return measure(scene, [&](int step) { return states[static_cast<std::size_t>(step)]; })
        .at("motion.error");
  };
  const double right = error("mass-spring:material=scene");
  EXPECT_LT(right, 1e-3);
  EXPECT_GT(error("mass-spring:material=own,structural=294,shear=294"), 5 * right);
}

TEST(Metrics, DoNotCareWhereTheWorldIs) {
  const Scene scene = busy_scene();
  const auto states = noisy_states(scene);
  const Rigid move;
  const auto at = [&](int step) { return states[static_cast<std::size_t>(step)]; };
  const Values before = measure(scene, at);
  EXPECT_GT(before.at("self.crossings"), 0);
  EXPECT_GT(before.at("face.box"), before.at("penetration.box.max"));
  expect_same(before, measure(move(scene), [&](int step) { return move(at(step)); }));
}

TEST(Metrics, DoNotCareHowVerticesAreNumbered) {
  Scene scene = busy_scene();
  scene.mesh.grid.reset();  // the grid numbers the vertices
  const auto states = noisy_states(scene);
  const int n = scene.mesh.size();
  const auto to = [n](int i) { return (i * 7 + 3) % n; };  // 7 and 36 are coprime
  const auto permuted = [&](const auto& values) {
    auto result = values;
    for (int i = 0; i < n; ++i)
      result[static_cast<std::size_t>(to(i))] = values[static_cast<std::size_t>(i)];
    return result;
  };
  const auto permuted_state = [&](const State& s) { return State{permuted(s.x), permuted(s.v)}; };
  Scene other = scene;
  other.mesh.rest = permuted(scene.mesh.rest);
  other.mesh.mass = permuted(scene.mesh.mass);
  other.start = permuted_state(scene.start);
  for (Triangle& t : other.mesh.triangles) t = {to(t[1]), to(t[2]), to(t[0])};
  for (Link& l : other.links) l = {to(l.b), to(l.a), l.rest, l.family};
  for (int& pin : other.pins) pin = to(pin);
  std::sort(other.pins.begin(), other.pins.end());
  const auto at = [&](int step) { return states[static_cast<std::size_t>(step)]; };
  expect_same(measure(scene, at),
              measure(other, [&](int step) { return permuted_state(at(step)); }));
}

}  // namespace
}  // namespace taut::metrics_test
