// Every solver where its parameters and the scene's numbers end: what moves, moves right, or the
// solver says that it cannot, or it fails so that a status says so. A scene that moves wrongly
// and looks well is the one thing that is not allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "tests/support/cloths.hpp"

namespace taut::ends_of_ranges_test {
namespace {

/// In double where there is a choice. The adaptive start of vertex solvers is for cloths that
/// something holds: of what it takes away few sweeps bring back little (core/README.md).
std::string exact(const SolverEntry& entry, bool inertia = true) {
  std::string text(entry.name);
  for (const ParamSpec& param : entry.params) {
    if (param.name == "precision") text = with(text, "precision=double");
    if (param.name == "start" && inertia) text = with(text, "start=inertia");
  }
  return text;
}

bool has(const SolverEntry& entry, std::string_view name) {
  return std::ranges::find(entry.params, name, &ParamSpec::name) != entry.params.end();
}

/// Whether this program has the solver, and it takes the scene.
bool takes(const std::string& solver, const Scene& scene) {
  const SolverChoice choice = parse_solver(solver);
  if (choice.entry->program && choice.entry->program(choice.params) == "taut-f32") return false;
  return !choice.entry->unsupported || choice.entry->unsupported(scene, choice.params).empty();
}

bool is_finite(const State& state) {
  return std::ranges::all_of(state.x, [](const Vec3& x) { return x.allFinite(); }) &&
         std::ranges::all_of(state.v, [](const Vec3& v) { return v.allFinite(); });
}

Vec3 mean(const Scene& scene, const std::vector<Vec3>& of) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < of.size(); ++i)
    sum += scene.mesh.mass[i] * of[i], mass += scene.mesh.mass[i];
  return sum / mass;
}

Scene free_sheet() {
  Scene scene = hanging_sheet(6, 5);
  scene.pins.clear();
  return scene;
}

/// The velocity of the centre of mass follows v' = exp(-damping h) v + h g.
void falls_freely(const std::string& solver, const Scene& scene) {
  if (!takes(solver, scene)) return;
  constexpr int kSteps = 32;
  const int substeps = parse_solver(solver).substeps();
  const double h = scene.dt / substeps;
  Vec3 expected = Vec3::Zero();
  for (int n = 0; n < kSteps * substeps; ++n)
    expected = std::exp(-scene.damping * h) * expected + h * scene.gravity;
  const State state = simulate(scene, solver, kSteps);
  if (!is_finite(state)) return;  // "exploded"
  EXPECT_LT((mean(scene, state.v) - expected).norm(), 1e-6 * expected.norm())
      << solver << " at " << scene.mesh.mass[0] << " kg a corner, damping " << scene.damping;
}

TEST(EndsOfRanges, FreeFallIsFreeFallAtEveryStiffness) {
  for (const SolverEntry* entry : solvers()) {
    const std::string base = exact(*entry);
    std::vector<std::string> all(2, base);
    for (const ParamSpec& param : entry->params) {
      if (param.kind != ParamSpec::Kind::real || (param.unit != "N/m" && param.unit != "m/N"))
        continue;
      for (std::size_t end = 0; end < 2; ++end) {
        const std::string value =
            std::string(param.name) + "=" + shortest(end == 0 ? param.min : param.max);
        falls_freely(with(base, value), free_sheet());
        all[end] = with(all[end], value);
      }
    }
    for (const std::string& every : all) falls_freely(every, free_sheet());
    Scene elastic = free_sheet();
    for (const double k : {1e-9, 1.0, 1e12}) {
      elastic.stiffness = {k, k, k};
      falls_freely(base, elastic);
    }
  }
}

/// Bullet's deformable is left out: of sheets of 1e-9 kg on springs of 1e12 N/m it falls wrongly.
TEST(EndsOfRanges, FreeFallIsFreeFallOfEveryMass) {
  for (const SolverEntry* entry : solvers())
    for (const double mass : {1e-12, 1e-9, 1e9}) {  // kg
      Scene scene = free_sheet();
      for (double& m : scene.mesh.mass) m *= mass / 0.2;
      falls_freely(exact(*entry), scene);
      if (entry->name == "bullet-deformable") continue;
      scene.stiffness = {1e12, 1e12, 1e12};
      falls_freely(exact(*entry), scene);
    }
}

TEST(EndsOfRanges, FreeFallIsFreeFallUnderEveryDamping) {
  for (const SolverEntry* entry : solvers())
    for (const double damping : {0.0, 1.0, 1e5, 1e9}) {  // 1/s
      Scene scene = free_sheet();
      scene.damping = damping;
      falls_freely(exact(*entry, false), scene);
    }
}

/// A sheet on a slope of 30 degrees, linked, not one particle: stiff along, soft across.
Scene on_a_slope(double friction) {
  Scene scene = hanging_sheet(9, 9);
  scene.pins.clear();
  const Vec3 down(std::cos(std::numbers::pi / 6), -0.5, 0), across = Vec3::UnitZ();
  for (Vec3& x : scene.mesh.rest) x = x.x() * down + x.y() * across;
  scene.start.x = scene.mesh.rest;
  scene.colliders.push_back(
      {Plane{down.cross(across).y() > 0 ? down.cross(across) : across.cross(down), 0},
       {},
       friction});
  return scene;
}

/// Of our solvers; Bullet's friction is one of its own (truth incline-friction).
TEST(EndsOfRanges, FrictionIsCoulombsAtEveryNumberOfSweeps) {
  for (const SolverEntry* entry : solvers()) {
    if (entry->name.starts_with("bullet")) continue;
    for (const int sweeps : {10, 100})
      for (const double mu : {0.02, 0.1, 0.3}) {
        std::string solver = exact(*entry);
        if (has(*entry, "iterations"))
          solver = with(solver, "iterations=" + std::to_string(sweeps));
        const Scene scene = on_a_slope(mu);
        if (!takes(solver, scene)) continue;
        const double h = scene.dt / parse_solver(solver).substeps(), n = std::round(1 / h);
        const auto way_at = [&](double friction) {
          return 9.81 * (0.5 - friction * std::cos(std::numbers::pi / 6)) * h * h * n * (n + 1) / 2;
        };
        const State state = simulate(scene, solver, 64);
        const double way = (mean(scene, state.x) - mean(scene, scene.start.x)).norm();
        // what friction takes of the way
        const double share = sweeps == 10 ? 0.1 : 1e-3;
        EXPECT_NEAR(way, way_at(mu), share * way_at(0)) << solver << ", mu = " << mu;
      }
  }
}

/// A sheet of springs between rigid diagonals hangs as it does between very stiff ones.
TEST(EndsOfRanges, APartlyRigidSceneIsRightOrRefused) {
  Scene scene = hanging_sheet(6, 5);
  scene.damping = 4;
  const auto with_stiffness = [&](double others) {
    scene.stiffness = {500, others, others};
    return scene;
  };
  const Scene stiff = with_stiffness(1e6);
  const State exact_state = simulate(stiff, "implicit", 192);
  const Scene rigid = with_stiffness(std::numeric_limits<double>::infinity());
  int right = 0;
  for (const SolverEntry* entry : solvers()) {
    std::string solver = exact(*entry);
    if (has(*entry, "iterations")) solver = with(solver, "iterations=100");
    if (!takes(solver, rigid)) continue;
    ++right;
    EXPECT_LT(largest_distance(simulate(rigid, solver, 192).x, exact_state.x), 2e-3) << solver;
  }
  EXPECT_GE(right, 2);  // xpbd and admm
  const SolverChoice pd = parse_solver("pd");
  EXPECT_EQ(pd.entry->unsupported(rigid, pd.params).front(),
            "shear links are rigid: springs need their stiffness in [links] stiffness");
  const SolverChoice own = parse_solver("pd:material=own");
  EXPECT_TRUE(own.entry->unsupported(rigid, own.params).empty());
}

}  // namespace
}  // namespace taut::ends_of_ranges_test
