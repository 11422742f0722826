// How metrics judge the path between two step boundaries.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/io/scene_io.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/metrics/reference_path.hpp"
#include "tests/metrics/measured.hpp"

namespace taut::path_test {
namespace {

/// Moving-ball with a ball or a box that runs at 32 m/s into the hanging sheet.
Scene fast(const std::string& collider, const std::string& dt) {
  return load_scene(
      std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/moving-ball.toml",
      {"collider=[{" + collider +
           ", center = [0, 0, -1.6], friction = 0.3, path = [{ t = 0, displacement = [0, 0, 0] }, "
           "{ t = 0.0625, displacement = [0, 0, 2] }] }]",
       "time.dt=\"" + dt + "\"", "time.duration=0.5"});
}

struct Outcome {
  std::string digest;
  double tunnelled, passages;
};

Outcome outcome(const Scene& scene, const std::string& solver) {
  const Record record = run_case(scene, parse_solver(solver)).record;
  EXPECT_TRUE(record.status.is_result() && record.status.kind != Status::Kind::exploded);
  return {record.digest, record.values.at("tunnelling.count"),
          record.values.at("tunnelling.events")};
}

// Judged by the ends of steps alone, vertices that a ball pushed aside within a step would have
// passed through it: 32 of them with four substeps at 1/64 s, none with one at 1/256 s.
TEST(Path, TheSameMotionTunnelsAsOftenInAnySteps) {
  for (const char* collider :
       {"type = \"ball\", radius = 0.15", "type = \"box\", half_extents = [0.15, 0.15, 0.15]"})
    for (const std::string solver :
         {"jakobsen:precision=double,order=mesh,iterations=3", "bullet:iterations=3"}) {
      const Outcome coarse = outcome(fast(collider, "1/64"), solver + ",substeps=4"),
                    fine = outcome(fast(collider, "1/256"), solver + ",substeps=1");
      ASSERT_EQ(coarse.digest, fine.digest) << "one motion, bit for bit: " << collider << solver;
      EXPECT_EQ(coarse.tunnelled, fine.tunnelled) << collider << solver;
      EXPECT_EQ(coarse.passages, fine.passages) << collider << solver;
    }
}

// Conversely, a vertex that does pass through within a step is still detected.
TEST(Path, APlateThinnerThanASubstepsTravelIsPassed) {
  const Scene scene =
      load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/tunnel.toml", {});
  EXPECT_EQ(outcome(scene, "jakobsen:contact=discrete,substeps=4").tunnelled, 289);
}

/// Displacement of the reference at t [m]: a polynomial of degree three, which Hermite's cubic is.
Vec3 way(double t) { return t * Vec3(0.3, -0.9, 0.4) + t * t * (t - 3) * Vec3(0.1, 0.2, 0); }
Vec3 speed(double t) { return Vec3(0.3, -0.9, 0.4) + (3 * t * t - 6 * t) * Vec3(0.1, 0.2, 0); }

ReferencePath followed(Scene& scene, double dt, const std::function<Vec3(double)>& way_at) {
  scene.dt = dt;
  scene.steps = static_cast<int>(std::ceil(2.6 / dt));
  scene.pins = {0};
  const auto moved = [&](const Vec3& by, const Vec3& v) {
    State state{scene.start.x, std::vector<Vec3>(scene.start.x.size(), v)};
    for (Vec3& one : state.x) one += by;
    return state;
  };
  MotionReference reference{.derivation = "made up", .horizon = 2};
  for (int k = 0; k <= 32; ++k) reference.states.push_back(moved(way(k / 16.0), speed(k / 16.0)));
  ReferencePath path(scene, std::move(reference));
  for (int step = 0; step <= scene.steps; ++step) {
    const State state = moved(way_at(step * dt), Vec3::Zero());
    path.observe({step, step * dt, state});
  }
  return path;
}

// The run is compared at the ends of its own steps, few of which are moments of the reference.
TEST(Path, AReferenceHasNoErrorBesideItselfInAnySteps) {
  for (const double dt : {1.0 / 64, 0.03, 0.07, 0.19, 0.3}) {
    for (const double faster : {0.5, 1.0, 1.5}) {
      Scene scene = sheet(3);
      const ReferencePath path =
          followed(scene, dt, [&](double t) { return Vec3(faster * way(t)); });
      EXPECT_NEAR(path.share(), faster, 1e-12) << dt;
      EXPECT_NEAR(path.error(), std::abs(faster - 1), 1e-12) << dt;
      EXPECT_NEAR(path.horizon(), 2, dt) << dt;
      EXPECT_LE(path.horizon(), 2 + 1e-12) << dt;
    }
    Scene scene = sheet(3);
    EXPECT_NEAR(followed(scene, dt, [&](double t) { return way(t - 0.1); }).phase(), 0.1, 2e-3)
        << dt;
  }
}

}  // namespace
}  // namespace taut::path_test
