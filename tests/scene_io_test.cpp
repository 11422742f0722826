// Scene files: what is shipped loads, what is wrong is named with its place.
#include "core/model/scene_io.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace taut {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes";

Scene shipped(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return load_scene(kScenes / (name + ".toml"), overrides);
}

TEST(SceneFiles, EveryShippedSceneLoads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".toml") continue;
    const Scene scene = load_scene(entry.path());
    EXPECT_FALSE(scene.summary.empty()) << entry.path();
    EXPECT_GT(scene.steps, 0) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST(SceneFiles, TheHangingSheetIsAsDocumented) {
  const Scene hang = shipped("hang");
  EXPECT_EQ(hang.mesh.size(), 32 * 32);
  EXPECT_EQ(hang.pins, (std::vector{0, 31}));
  EXPECT_EQ(hang.links.size(), 2u * 32 * 31 + 2u * 31 * 31);
  EXPECT_EQ(hang.dt, 1.0 / 64);
  EXPECT_EQ(hang.steps, 640);
}

TEST(SceneFiles, CornerPinsFollowAnOverriddenGrid) {
  EXPECT_EQ(shipped("hang", {"cloth.grid=[33, 17]"}).pins, (std::vector{0, 32}));
}

}  // namespace
}  // namespace taut
