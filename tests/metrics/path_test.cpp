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

/// Displacement of the references at t [m]: along a line, at constant velocity.
Vec3 way(double t) { return t * Vec3(0.3, -0.9, 0.4); }

ReferencePath followed(double dt, const std::function<Vec3(double)>& way_at) {
  Scene scene = sheet(3);
  scene.dt = dt;
  scene.steps = static_cast<int>(std::ceil(2.6 / dt));
  const auto moved = [&](const Vec3& by) {
    std::vector<Vec3> x = scene.start.x;
    for (Vec3& one : x) one += by;
    return x;
  };
  std::vector<Reference> moments;
  for (const double t : {0.5, 1.0, 1.5, 2.0})
    moments.push_back({"made up", "", "motion", t, "", 0, moved(way(t))});
  ReferencePath path(scene, std::move(moments));
  for (int step = 0; step <= scene.steps; ++step)
    path.observe({step, step * dt, State{moved(way_at(step * dt)), scene.start.v}});
  return path;
}

// References are at moments that few time steps coincide with; on a straight line the time step
// makes no difference.
TEST(Path, ALineIsJudgedAtTheReferencesTimes) {
  for (const double dt : {1.0 / 64, 0.03, 0.07, 0.19, 0.3}) {
    for (const double faster : {0.5, 1.0, 1.5}) {
      const ReferencePath path = followed(dt, [&](double t) { return Vec3(faster * way(t)); });
      EXPECT_NEAR(path.share(), faster, 1e-12) << dt;
      EXPECT_NEAR(path.error(), std::abs(faster - 1), 1e-12) << dt;
      EXPECT_EQ(path.horizon(), 2) << dt;
    }
    const double late = 0.1;
    const ReferencePath path = followed(dt, [&](double t) { return way(t - late); });
    EXPECT_NEAR(path.phase(), late, 1e-7) << dt;
    EXPECT_NEAR(path.error(), 2 * late / std::sqrt(0.36 + 1.21 + 2.56 + 4.41), 1e-12) << dt;
  }
}

}  // namespace
}  // namespace taut::path_test
