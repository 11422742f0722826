// Releases of pins in scene files; seams and welds.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/io/mesh_io.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"

namespace taut::release_io_test {
namespace {

const std::string kSheet =
    "[cloth]\ngrid = [3, 3]\nsize = [1, 1]\npins = [\"top\"]\n[time]\nduration = 2\n";

std::string problems(const std::string& text) {
  try {
    parse_scene("x.toml", text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string with(const std::string& cloth, const std::string& more = "") {
  std::string text = kSheet;
  text.insert(text.find("[time]"), cloth + "\n");
  return text + more;
}

TEST(ReleaseOfPins, FallsOnTheFirstStepBoundaryAtOrAfterItsTime) {
  for (const auto& [said, step] :
       {std::pair("1.0", 64), {"\"1/64\"", 1}, {"0.001", 1}, {"1.001", 65}}) {
    const Scene scene = parse_scene("x.toml", with("release = " + std::string(said)));
    ASSERT_EQ(scene.releases.size(), 1u) << said;
    EXPECT_EQ(scene.releases[0].step, step) << said;
    EXPECT_EQ(scene.releases[0].vertices, (std::vector{0, 1, 2})) << said;
  }
}

TEST(ReleaseOfPins, APinMotionHasATimeOfItsOwn) {
  const Scene scene =
      parse_scene("x.toml", with("release = 1", "[[pin_motion]]\nvertices = [1]\nrelease = 0.5\n"));
  ASSERT_EQ(scene.releases.size(), 2u);
  EXPECT_EQ(scene.releases[0].step, 32);
  EXPECT_EQ(scene.releases[0].vertices, std::vector{1});
  EXPECT_EQ(scene.releases[1].vertices, (std::vector{0, 2}));
  EXPECT_TRUE(scene.pin_motions.empty());
}

TEST(ReleaseOfPins, AtTheEndNothingLetsGoAndARemarkSaysSo) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "late.toml";
  std::ofstream(file) << with("release = 2");
  std::vector<std::string> remarks;
  const Scene scene = load_scene(file, {}, &remarks);
  EXPECT_TRUE(scene.releases.empty());
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_EQ(remarks[0], "no pin lets go at 2 s: the run ends at 2 s");
  EXPECT_EQ(content(scene), content(parse_scene("x.toml", kSheet)));
}

TEST(ReleaseOfPins, WhatIsNoTimeIsRefused) {
  EXPECT_NE(problems(with("release = 0")).find("x.toml:5:"), std::string::npos);
  EXPECT_NE(problems(with("release = -1")).find("greater than 0"), std::string::npos);
  EXPECT_NE(problems(with("release = nan")), "none");
  EXPECT_NE(problems(with("release = inf")), "none");
  EXPECT_NE(problems(with("", "[[pin_motion]]\nvertices = [1]\nrelease = 0\n")), "none");
  EXPECT_NE(
      problems("[cloth]\ngrid = [3, 3]\nsize = [1, 1]\nrelease = 1\n").find("this cloth has none"),
      std::string::npos);
}

/// Two squares whose common side appears twice in the file.
const std::string kSplit =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 1.00001 0 0\nv 2 0 0\nv 1 1.00001 0\nv 2 1 0\n"
    "f 1 2 4 3\nf 5 6 8 7\n";

TEST(Weld, JoinsWhatIsWithinItAndKeepsTheFilesNumbers) {
  const Polygons apart = parse_obj("x.obj", kSplit), whole = parse_obj("x.obj", kSplit, 1e-4);
  EXPECT_EQ(apart.vertices.size(), 8u);
  EXPECT_TRUE(apart.welded.empty());
  EXPECT_EQ(whole.vertices.size(), 6u);
  EXPECT_EQ(whole.welded, (std::vector{0, 1, 2, 3, 1, 4, 3, 5}));
  EXPECT_EQ(whole.faces[1], (std::vector{1, 4, 5, 3}));
  EXPECT_EQ(parse_obj("x.obj", kSplit, 1e-6).vertices.size(), 8u);
}

TEST(Weld, AFaceThatCollapsesIsRefusedByItsLine) {
  try {
    parse_obj("x.obj", kSplit, 1.2);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("x.obj:9:1: `weld` in [cloth] joins vertices 1 and 2"),
              std::string::npos)
        << error.what();
  }
}

TEST(Weld, PinsOfASceneMeanTheFilesVertices) {
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "split.obj") << kSplit;
  std::ofstream(folder / "split.toml")
      << "[cloth]\nmesh = \"split.obj\"\nweld = 1e-4\npins = [4, 7]\n";
  const Scene scene = load_scene(folder / "split.toml");
  EXPECT_EQ(scene.mesh.size(), 6);
  EXPECT_EQ(scene.pins, (std::vector{1, 5}));
  std::ofstream(folder / "split.toml")
      << "[cloth]\nmesh = \"split.obj\"\nweld = 1e-4\npins = [8]\n";
  EXPECT_THROW(load_scene(folder / "split.toml"), InputError);
}

TEST(Seam, IsALinkWithoutLengthBehindTheStructuralOnes) {
  const Scene scene =
      parse_scene("x.toml", with("", "[[seam]]\na = [\"left\"]\nb = [\"right\"]\n"));
  const Scene bare = parse_scene("x.toml", kSheet);
  ASSERT_EQ(scene.links.size(), bare.links.size() + 3);
  for (int j = 0; j < 3; ++j) {
    const Link& seam = scene.links[12 + static_cast<std::size_t>(j)];
    EXPECT_TRUE(is_seam(seam) && seam.family == Family::structural);
    EXPECT_EQ(seam.a, 3 * j);
    EXPECT_EQ(seam.b, 3 * j + 2);
  }
  EXPECT_EQ(scene.links[15].family, bare.links[12].family);
}

TEST(Seam, WhatCannotBeSewnIsRefused) {
  const auto told = [&](const std::string& a, const std::string& b) {
    return problems(with("", "[[seam]]\na = " + a + "\nb = " + b + "\n"));
  };
  EXPECT_NE(told("[0, 1]", "[8]").find("a seam is of pairs"), std::string::npos);
  EXPECT_NE(told("[0]", "[0]").find("sews vertex 0 to itself"), std::string::npos);
  EXPECT_NE(told("[0]", "[4]").find("which one face, link or seam has already"), std::string::npos);
  EXPECT_NE(told("[1]", "[3]").find("which one face, link or seam has already"), std::string::npos);
  EXPECT_NE(told("[0]", "[9]").find("names vertex 9"), std::string::npos);
  EXPECT_NE(told("[0, 0]", "[8, 8]").find("has already"), std::string::npos);
  EXPECT_EQ(told("[0]", "[8]"), "none");
}

}  // namespace
}  // namespace taut::release_io_test
