// Judgement of a cloth whose pins are released.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/io/scene_io.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/case/divergence.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::release_case_test {
namespace {

Scene dropped() {
  Scene scene = hanging_sheet(6, 6, {true, true, false});
  scene.steps = 640;
  scene.releases = {{64, {0, 5}}};
  return scene;
}

/// Judged by the pins' reach this cloth would count as exploded: it falls 400 m in 9 s.
TEST(ReleasedCloth, FallsWithoutExploding) {
  for (const char* solver : {"jakobsen", "bullet", "avbd", "pd"}) {
    const Record record = run_case(dropped(), parse_solver(solver)).record;
    EXPECT_EQ(record.status.kind, Status::Kind::ok)
        << solver << ": " << record.status.reason.text();
    EXPECT_LT(record.values.at("stretch.rms"), 0.05) << solver;
    EXPECT_FALSE(record.values.contains("pins.force")) << solver;
  }
}

TEST(ReleasedCloth, HasNoSettlingTimeAndNoReference) {
  const Scene scene = dropped();
  Scene held = scene;
  held.releases.clear();
  const std::vector<PassCost> cost{
      {.pass = "links", .items = 1, .repeats = 4, .projections = true}};
  EXPECT_TRUE(settling_time(held, cost, 1).has_value());
  EXPECT_FALSE(settling_time(scene, cost, 1).has_value());
  EXPECT_EQ(reference::static_equilibrium(scene).reason, "its pins let go");
  const auto moving = reference::refuse_dynamic(scene);
  EXPECT_EQ(std::ranges::count(moving, "its pins let go"), 1);
}

/// Each step is compared with the exact step for the pins that still hold; none is far from it.
TEST(ReleasedCloth, StepsAreJudgedByThePinsThatHold) {
  Scene scene = dropped();
  scene.steps = 160;
  const Record record = run_case(scene, parse_solver("implicit:substeps=1")).record;
  EXPECT_LT(record.values.at("step.error.peak"), 1e-5);
}

/// An open seam is measured as a length, not as a strain.
TEST(SewnCloth, IsMeasuredInMetres) {
  Scene scene = hanging_sheet(8, 8, {true, true, false});
  scene.steps = 320;
  scene.pins = {3, 4};
  scene.damping = 1;
  // a tube that lacks its last link
  const double radius = 1 / (14 * std::sin(std::numbers::pi / 8));
  for (std::size_t i = 0; i < 64; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i % 8) / 8;
    scene.start.x[i].x() = radius * std::cos(angle);
    scene.start.x[i].z() = radius * std::sin(angle);
  }
  for (int j = 0; j < 8; ++j) scene.links.push_back({8 * j, 8 * j + 7, kSeamRest});
  for (const char* solver : {"jakobsen", "jakobsen:order=mesh,projection=sqrt-free", "xpbd",
                             "bullet", "avbd:iterations=20", "admm"}) {
    const Record record = run_case(scene, parse_solver(solver)).record;
    EXPECT_NE(record.status.kind, Status::Kind::exploded)
        << solver << ' ' << record.status.reason.text();
    EXPECT_LT(record.values.at("seam.gap"), 0.02) << solver;
    EXPECT_LT(record.values.at("stretch.max"), 0.5) << solver;
  }
}

/// Two pieces of one OBJ file without a common vertex; the first hangs by two corners.
Scene two_pieces() {
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream obj(folder / "pieces.obj");
  for (const int piece : {0, 1}) {
    obj << "o piece" << piece << "\n";
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) obj << "v " << 2 * piece + 0.2 * i << ' ' << -0.2 * j << " 0\n";
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int a = 16 * piece + 4 * j + i + 1;
        obj << "f " << a << ' ' << a + 4 << ' ' << a + 5 << ' ' << a + 1 << "\n";
      }
  }
  obj.close();
  std::ofstream(folder / "pieces.toml")
      << "[cloth]\nmesh = \"pieces.obj\"\nmass = 0.4\npins = [0, 3]\n[time]\nduration = 8\n";
  return load_scene(folder / "pieces.toml");
}

TEST(TwoPieces, OneHangsAsIfItWereAloneAndOneFalls) {
  const Scene scene = two_pieces();
  double first = 0;
  for (std::size_t i = 0; i < 16; ++i) first += scene.mesh.mass[i];
  EXPECT_NEAR(first, 0.2, 1e-12);
  EXPECT_EQ(reference::static_equilibrium(scene).reason, "a piece without a pin falls for ever");
  for (const std::string solver :
       {"jakobsen:precision=double", "bullet", "xpbd:precision=double", "pd", "implicit"}) {
    const Record record = run_case(scene, parse_solver(solver)).record;
    EXPECT_EQ(record.status.kind, Status::Kind::ok)
        << solver << ": " << record.status.reason.text();
    Scene alone = scene;  // its second piece stays in place
    for (int i = 16; i < 32; ++i) alone.pins.push_back(i);
    const State whole = simulate(scene, solver, 64), held = simulate(alone, solver, 64);
    double apart = 0;
    for (std::size_t i = 0; i < 16; ++i) apart = std::max(apart, (whole.x[i] - held.x[i]).norm());
    EXPECT_LT(apart, 1e-9) << solver;
    const double fallen = 9.81 / 2;  // fallen in 1 s; substeps of h add g h/2
    for (std::size_t i = 16; i < 32; ++i)
      EXPECT_NEAR(whole.x[i].y(), scene.start.x[i].y() - fallen, 9.81 / 64 / 2 + 1e-9) << solver;
  }
}

}  // namespace
}  // namespace taut::release_case_test
