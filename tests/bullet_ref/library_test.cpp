// Requirements on each build of Bullet: this file is compiled into taut_tests (double) and into
// taut_tests_f32 (float).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "bullet_ref/read_back.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "tests/bullet_ref/differences.hpp"
#include "tests/support/cloths.hpp"

#ifndef TAUT_BULLET_PRECISION
#define TAUT_BULLET_PRECISION "double"
#endif

namespace taut::library_test {
namespace {

const std::string kPrecision = TAUT_BULLET_PRECISION;
const bool kDouble = kPrecision == "double";
constexpr const char* kSolvers[] = {"bullet", "bullet-deformable"};

std::unique_ptr<Solver> solver(const std::string& text, const Scene& scene) {
  const SolverChoice choice = parse_solver(text);
  auto made = choice.entry->make(scene, choice.params);
  made->load(scene.start);
  return made;
}

class ShippedScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(ShippedScene, BulletHoldsWhatTheFileSays) {
  for (const Scene& scene : stages(load_scene(GetParam())))
    for (const char* name : kSolvers) {
      const SolverChoice choice = parse_solver(name + (":precision=" + kPrecision));
      if (!choice.entry->unsupported(scene, choice.params).empty()) continue;
      const auto made = solver(choice.canonical(), scene);
      EXPECT_EQ(differences(scene, read_back(*made), kDouble ? 1e-13 : 1e-6),
                std::vector<std::string>{})
          << name;
    }
}

std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(TAUT_SOURCE_DIR "/experiments/scenes"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

TEST(BulletLibrary, TakesMostOfTheShippedScenes) {
  for (const char* name : kSolvers) {
    const SolverChoice choice = parse_solver(name + (":precision=" + kPrecision));
    const auto files = scene_files();
    const auto taken = std::ranges::count_if(files, [&](const auto& file) {
      return choice.entry->unsupported(load_scene(file), choice.params).empty();
    });
    EXPECT_GE(taken, 10) << name << " of " << files.size();
  }
}

INSTANTIATE_TEST_SUITE_P(Bullet, ShippedScene, testing::ValuesIn(scene_files()),
                         [](const auto& file) {
                           std::string name = file.param.stem().string();
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(BulletLibrary, OneStepOfTheHangingSheetIsOursToRounding) {
  const Scene scene =
      load_scene(TAUT_SOURCE_DIR "/experiments/scenes/hang.toml", {"cloth.grid=[20, 20]"});
  const std::string common = "precision=" + kPrecision + ",iterations=8";
  const auto ours = solver(listing("projection=sqrt-free," + common), scene);
  const auto bullet = solver("bullet:" + common, scene);
  State p, q;
  ours->step(0, scene.dt);
  bullet->step(0, scene.dt);
  ours->store(p);
  bullet->store(q);
  for (std::size_t i = 0; i < p.x.size(); ++i)
    ASSERT_LT((p.x[i] - q.x[i]).norm(), kDouble ? 1e-14 : 1e-6) << "vertex " << i;
}

TEST(BulletLibrary, TheOtherPrecisionNeedsTheOtherProgram) {
  const Scene scene = load_scene(TAUT_SOURCE_DIR "/experiments/scenes/fall.toml");
  for (const char* name : kSolvers)
    for (const char* precision : {"double", "float"}) {
      const SolverChoice choice = parse_solver(std::string(name) + ":precision=" + precision);
      const bool here = precision == kPrecision;
      EXPECT_EQ(choice.entry->program(choice.params), (here == kDouble) ? "taut" : "taut-f32");
      if (here)
        EXPECT_NO_THROW(choice.entry->make(scene, choice.params));
      else
        EXPECT_THROW(choice.entry->make(scene, choice.params), InputError);
    }
}

}  // namespace
}  // namespace taut::library_test
