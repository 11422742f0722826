// Scenes by a seed: the same text everywhere, readable, and of every kind.
#include "core/io/drawn_scene.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>

#include "core/io/scene_io.hpp"

namespace taut::drawn_scene_test {
namespace {

/// Reads a scene; its mesh is written to the folder of temporary files.
Scene read(const DrawnScene& drawn, const std::string& name) {
  const std::filesystem::path folder = testing::TempDir();
  if (!drawn.obj.empty()) std::ofstream(folder / (name + ".obj")) << drawn.obj;
  return parse_scene(folder / (name + ".toml"), drawn.toml);
}

TEST(DrawnScene, IsTheSameTextOnEveryMachine) {
  std::uint64_t fnv = 0xcbf29ce484222325;  // Fowler, Noll and Vo's hash 1a
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const bool contact : {false, true}) {
      const DrawnScene drawn = drawn_scene("drawn", seed, contact);
      for (const char c : drawn.toml + drawn.obj)
        fnv = (fnv ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    }
  EXPECT_EQ(fnv, 0x440c111d4f001eacu) << std::hex << fnv;
}

TEST(DrawnScene, IsReadAndRestsBelowItsPins) {
  std::set<std::size_t> pins;
  std::set<bool> grids, bends;
  for (std::uint64_t seed = 100; seed < 160; ++seed) {
    const Scene scene = read(drawn_scene("drawn", seed), "drawn");
    EXPECT_TRUE(scene.colliders.empty());
    EXPECT_FALSE(scene.pins.empty());
    EXPECT_EQ(scene.damping, 2);
    pins.insert(scene.pins.size());
    grids.insert(scene.mesh.grid.has_value());
    bends.insert(
        std::ranges::any_of(scene.links, [](const Link& l) { return l.family == Family::bend; }));
    for (const Vec3& x : scene.start.x) EXPECT_LE(x.y(), 1e-12) << seed;
  }
  EXPECT_GT(pins.size(), 5u);
  EXPECT_EQ(grids.size(), 2u);
  EXPECT_EQ(bends.size(), 2u);
}

TEST(DrawnScene, ContactKeepsTheClothAndPutsABodyBelowIt) {
  std::set<std::size_t> shapes;
  std::set<bool> held;
  for (std::uint64_t seed = 100; seed < 160; ++seed) {
    const Scene alone = read(drawn_scene("drawn", seed), "drawn"),
                scene = read(drawn_scene("drawn", seed, true), "drawn");
    EXPECT_EQ(scene.mesh.mass, alone.mesh.mass) << seed;
    EXPECT_EQ(scene.links.size(), alone.links.size());
    EXPECT_EQ(scene.dt, alone.dt);
    held.insert(!scene.pins.empty());
    ASSERT_EQ(scene.colliders.size(), scene.pins.empty() ? 2u : 1u) << "with a floor";
    shapes.insert(scene.colliders[0].shape.index());
  }
  EXPECT_EQ(shapes.size(), 3u);
  EXPECT_EQ(held.size(), 2u);
}

}  // namespace
}  // namespace taut::drawn_scene_test
