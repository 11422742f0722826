// btSoftBody's Positions solver is Jakobsen's algorithm. Without contact, with the square-root-free
// projection and the same order of links, two independent programs take the same path. This is the
// strongest evidence that both simulate the same scene.
#include <gtest/gtest.h>

#include <string>

#include "core/model/solver.hpp"
#include "tests/support/cloths.hpp"

namespace taut::twin_test {
namespace {

struct Cloth {
  int nu, nv;
  bool unequal;  ///< some masses are 5 times, some 0.2 times their share
};

std::string name_of(const testing::TestParamInfo<Cloth>& info) {
  return std::to_string(info.param.nu) + "x" + std::to_string(info.param.nv) +
         (info.param.unequal ? "UnequalMasses" : "");
}

/// Sheet of one metre by one on two corners. It starts flat and hangs straight along v.
Scene hang(const Cloth& cloth, const Vec3& v) {
  Scene scene;
  scene.name = "hang";
  scene.mesh =
      make_sheet({.nu = cloth.nu, .nv = cloth.nv, .width = 1, .height = 1, .v = v, .mass = 0.2});
  if (cloth.unequal)
    for (std::size_t i = 0; i < scene.mesh.mass.size(); ++i)
      scene.mesh.mass[i] *= i % 7 == 0 ? 5 : i % 3 == 0 ? 0.2 : 1;
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.pins = {0, cloth.nu - 1};
  scene.dt = 1.0 / 64;
  scene.steps = 600;
  return scene;
}

std::unique_ptr<Solver> solver(const std::string& text, const Scene& scene) {
  const SolverChoice choice = parse_solver(text);
  EXPECT_TRUE(choice.entry->unsupported(scene, choice.params).empty());
  auto made = choice.entry->make(scene, choice.params);
  made->load(scene.start);
  return made;
}

double distance(const Solver& a, const Solver& b) {
  State p, q;
  a.store(p);
  b.store(q);
  double largest = 0;
  for (std::size_t i = 0; i < p.x.size(); ++i)
    largest = std::max(largest, (p.x[i] - q.x[i]).norm());
  return largest;
}

/// Largest distance [m] between both solvers after each of the steps 1, 2, ..., last.
std::vector<double> distances(const Scene& scene, int last, const std::string& more = "") {
  const std::string common = "precision=double,iterations=8" + more;
  const auto ours = solver(listing("projection=sqrt-free," + common), scene);
  const auto bullet = solver("bullet:" + common, scene);
  std::vector<double> all;
  for (int n = 0; n < last; ++n) {
    ours->step(n * scene.dt, scene.dt);
    bullet->step(n * scene.dt, scene.dt);
    all.push_back(distance(*ours, *bullet));
  }
  return all;
}

class Twin : public testing::TestWithParam<Cloth> {};

TEST_P(Twin, HangingBulletAndJakobsenTakeTheSamePath) {
  const auto apart = distances(hang(GetParam(), -Vec3::UnitY()), 600);
  EXPECT_LE(apart.front(), 1e-14) << "m after one step";
  EXPECT_LE(apart.back(), 1e-8) << "m after 600 steps";
}

// Released from level, the cloth swings through and crumples. Rounding errors grow a hundredfold
// per second, so that this bound applies after one second.
TEST_P(Twin, FallingFromLevelTheyDoSoUntilChaosSetsIn) {
  const auto apart = distances(hang(GetParam(), Vec3::UnitZ()), 64);
  EXPECT_LE(apart.front(), 1e-14) << "m after one step";
  EXPECT_LE(apart.back(), 1e-8) << "m after 64 steps";
}

// Everything that a scene can request except contact maps to the same physics.
TEST_P(Twin, WindDampingMovingPinsAndSubstepsAreTheSame) {
  Scene scene = hang(GetParam(), -Vec3::UnitY());
  for (const Wind::Law law : {Wind::Law::relative, Wind::Law::literal}) {
    scene.wind = Wind{.velocity = {1, 0.3, 2}, .strength = 0.1, .law = law};
    scene.damping = 0.5;
    scene.gravity = {0.1, -3.7, 0.2};
    scene.start.v.assign(scene.start.v.size(), Vec3(0.1, 0.2, 0.3));
    scene.pin_motions = {{.vertices = {0}, .motion = {.velocity = {0.1, 0, 0.2}}}};
    const auto apart = distances(scene, 64, ",substeps=2");
    EXPECT_LE(apart.front(), 1e-14) << "m after one step";
    EXPECT_LE(apart.back(), 1e-10) << "m after 64 steps";
  }
}

// ReoptimizeLinkOrder moves links only past links without a common vertex, so that every sum keeps
// its order. The path follows our mesh order and equals, bit for bit, that of Bullet's own order.
TEST_P(Twin, ReorderedLinksTakeTheSamePathBitForBit) {
  const Scene scene = hang(GetParam(), Vec3::UnitZ());
  const auto plain = solver("bullet:iterations=8", scene),
             best = solver("bullet:iterations=8,reorder=on,faces=off", scene);
  for (int n = 0; n < 200; ++n) {
    plain->step(n * scene.dt, scene.dt);
    best->step(n * scene.dt, scene.dt);
  }
  EXPECT_EQ(distance(*plain, *best), 0);
}

INSTANTIATE_TEST_SUITE_P(Hang, Twin,
                         testing::Values(Cloth{5, 5, false}, Cloth{20, 20, false},
                                         Cloth{33, 17, false}, Cloth{5, 5, true},
                                         Cloth{20, 20, true}, Cloth{33, 17, true}),
                         name_of);

}  // namespace
}  // namespace taut::twin_test
