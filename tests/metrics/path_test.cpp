// What a metric sees of the path between two step boundaries.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/io/scene_io.hpp"
#include "experiments/case/run_case.hpp"

namespace taut::path_test {
namespace {

/// A ball or a box that runs at 32 m/s into the hanging sheet of moving-ball.
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
  EXPECT_EQ(record.status.kind, Status::Kind::ok);
  return {record.digest, record.values.at("tunnelling.count"),
          record.values.at("tunnelling.events")};
}

// Judged by the step's ends alone, vertices that a ball pushed aside within a step went through it:
// 32 of them with four substeps at 1/64 s, none with one at 1/256 s.
TEST(Path, TheSameMotionTunnelsAsOftenHoweverItIsCutIntoSteps) {
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

// The other way round: what does pass through within a step is still seen.
TEST(Path, APlateThinnerThanASubstepsTravelIsPassed) {
  const Scene scene =
      load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/tunnel.toml", {});
  EXPECT_EQ(outcome(scene, "jakobsen:contact=discrete,substeps=4").tunnelled, 289);
}

}  // namespace
}  // namespace taut::path_test
