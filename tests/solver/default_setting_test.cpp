// The setting that a user gets without naming one. The table behind it is in
// results/benchmarks/default-setting.md.
#include <gtest/gtest.h>

#include "core/io/scene_io.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::default_setting_test {
namespace {

Record run(const std::string& scene, const std::string& solver, const SceneSettings& changes) {
  return run_case(load_scene(TAUT_SOURCE_DIR "/experiments/scenes/" + scene + ".toml", changes),
                  parse_solver(solver))
      .record;
}

TEST(DefaultSetting, HoldsALargeFlagWhereNeighboursExplode) {
  const SceneSettings hard{"cloth.grid=[64, 64]", "time.dt=\"1/5\"", "time.duration=3"};
  EXPECT_EQ(run("flag", "jakobsen", hard).status.kind, Status::Kind::ok);
  for (const char* neighbour : {"jakobsen:order=mesh", "jakobsen:order=reversed",
                                "jakobsen:projection=exact", "jakobsen:iterations=15,substeps=1"})
    EXPECT_EQ(run("flag", neighbour, hard).status.kind, Status::Kind::exploded) << neighbour;
}

TEST(DefaultSetting, StretchesLessThanTheSameWorkWithoutSubsteps) {
  for (const char* scene : {"hang", "drape", "swing", "ball"}) {
    const auto stretch = [&](const std::string& solver) {
      return run(scene, solver, {"cloth.grid=[20, 20]", "time.duration=1"})
          .values.at("stretch.rms");
    };
    const double ours = stretch("jakobsen");
    EXPECT_LT(ours, 0.6 * stretch("jakobsen:iterations=15,substeps=1")) << scene;
    EXPECT_LT(ours, 0.2 * stretch(listing())) << scene;
  }
}

}  // namespace
}  // namespace taut::default_setting_test
