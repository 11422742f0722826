// Every solver at the limits of its parameters and of the scene's numbers. Each scene has to move
// correctly, or the solver refuses it, or the run fails with a status. A scene that moves wrongly
// and looks plausible is the only outcome that is not allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "tests/support/cloths.hpp"

namespace taut::ends_of_ranges_test {
namespace {

/// The solver's text, in double precision where it offers one. By default vertex solvers start
/// inertially here: their adaptive start suits cloths that something holds, since few sweeps
/// restore little of what it removes (results/benchmarks/methods.md).
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

/// Whether this program has the solver and the solver accepts the scene.
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
  for (std::size_t i = 0; i < of.size(); ++i) {
    sum += scene.mesh.mass[i] * of[i];
    mass += scene.mesh.mass[i];
  }
  return sum / mass;
}

Scene free_sheet() {
  Scene scene = hanging_sheet(6, 5);
  scene.pins.clear();
  return scene;
}

/// Expects that the velocity of the centre of mass follows v' = exp(-damping h) v + h g.
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

/// Leaves out Bullet's deformable: sheets of 1e-9 kg on springs of 1e12 N/m fall wrongly in it.
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

/// Sheet of linked particles on a slope of 30 degrees: stiff along the slope, soft across it.
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

/// Tests our solvers only; Bullet has a friction model of its own (truth incline-friction).
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
        // tolerance, as a share of the distance without friction
        const double share = sweeps == 10 ? 0.1 : 1e-3;
        EXPECT_NEAR(way, way_at(mu), share * way_at(0)) << solver << ", mu = " << mu;
      }
  }
}

/// A sheet of springs between rigid diagonals hangs like one whose diagonals are very stiff.
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
  EXPECT_GE(right, 2);  // xpbd and admm at least
  const SolverChoice pd = parse_solver("pd");
  EXPECT_EQ(pd.entry->unsupported(rigid, pd.params).front(),
            "shear links are rigid: springs need their stiffness in [links] stiffness");
  const SolverChoice own = parse_solver("pd:material=own");
  EXPECT_TRUE(own.entry->unsupported(rigid, own.params).empty());
}

/// A free sheet at twice its rest size contracts, or the step fails with a status. Where m/h^2 is
/// below the rounding error of the stiffness, the matrix may have no factor.
TEST(EndsOfRanges, AFactorThatBreaksDownIsNoStepWithoutLinks) {
  int failed = 0;
  for (const std::string solver : {"pd", "admm:links=elastic", "implicit"})
    for (const double mass : {1e-12, 1e-9, 1e-6, 1e-3, 1.0}) {  // kg
      Scene scene = free_sheet();
      scene.gravity.setZero();
      for (double& m : scene.mesh.mass) m *= mass / 0.2;
      for (Vec3& x : scene.start.x) x *= 2;
      scene.stiffness = {1e12, 1e12, 1e12};
      const State state = simulate(scene, solver, 1);
      if (!is_finite(state)) {
        ++failed;
        continue;
      }
      const Link& first = scene.links.front();
      EXPECT_LT((state.x[to_index(first.b)] - state.x[to_index(first.a)]).norm(), 1.5 * first.rest)
          << solver << " at " << mass << " kg";
    }
  EXPECT_GT(failed, 0);
}

/// Scene with as many features at once as the solver accepts: a crumpled sheet in the wind that
/// sinks into a spinning ball with friction, one pin at rest and one that moves, damping, bending
/// and self-collision.
std::optional<Scene> with_everything(const std::string& solver, bool elastic) {
  Scene scene = crumpled(hanging_sheet(9, 9), 0.05);
  scene.name = "everything";
  scene.damping = 0.5;
  scene.thickness = 0.01;
  scene.wind = Wind{.velocity = {1, 0.5, 4}, .strength = 0.5};
  scene.pin_motions = {{{0}, {.velocity = {0, 0.1, 0.3}}}};
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : scene.mesh.rest) middle += x / static_cast<double>(scene.mesh.size());
  scene.colliders = {{Ball{middle + Vec3(0.05, 0.02, 0.1), 0.2},
                      {.velocity = {0.1, 0, -0.2}, .spin = {0, 3, 0}, .pivot = middle},
                      0.3}};
  const std::size_t thrown = 40;  // passes through a small ball within a step
  scene.start.v[thrown].z() = 3;
  scene.colliders.push_back({Ball{scene.start.x[thrown] + Vec3(0.004, 0.003, 0.025), 0.01}});
  const auto& [a, b, c] =
      scene.mesh.triangles[14];  // near a pin; its corners are outside of this triangle
  const Vec3 on_face =
      (scene.start.x[to_index(a)] + scene.start.x[to_index(b)] + scene.start.x[to_index(c)]) / 3;
  scene.colliders.push_back({Ball{on_face - Vec3(0, 0, 0.015), 0.02}});
  scene.start.x[60] = scene.start.x[20] + Vec3(0.01, 0.02, 0.03);  // no link joins them
  if (elastic) scene.stiffness = {400, 200, 20};
  scene.bending = Bending{.warp = 1e-4, .weft = 2e-4, .direction = Vec3::UnitX()};
  scene.self_collision = SelfCollision{.radius = 0.05};
  if (takes(solver, scene)) return scene;
  scene.bending.reset();
  scene.self_collision.reset();  // Bullet refuses it
  if (takes(solver, scene)) return scene;
  return {};
}

/// Value other than the default for a parameter, and the settings with which it has an effect.
struct Other {
  std::string value, with;
};
std::vector<Other> others(const SolverEntry& entry, const ParamSpec& param) {
  const std::string key = std::string(entry.name) + "." + std::string(param.name);
  if (param.name == "simd" || param.name == "threads" || key == "bullet.faces" ||
      key == "bullet.reorder")
    return {};  // the same bits
  // the same while the energy falls; see implicit_test
  if (key == "implicit.line-search") return {};
  if (param.name == "seed") return {{"2", "order=random"}};
  if (key == "avbd.k-max") return {{"2", ""}};
  if (key == "xpbd.multipliers") return {{"reset", "iterations=3,structural=1e-3"}};
  if (key == "mass-spring.drag-at") return {{"central", "drag=0.01"}};
  // the third integrator is Verlet
  if (key == "mass-spring.integrator") return {{"explicit-euler", ""}};
  if (key == "implicit.linear") return {{"cg", ""}};
  if (key == "pd.history") return {{"1", "method=lbfgs"}};
  if (key == "pd.preconditioner") return {{"factor", "method=ncg"}};
  if (param.name == "layout") return {{"batches", ""}};
  if (key == "implicit.self") return {{"octree", ""}};  // the grid finds no particles to separate
  if (param.kind == ParamSpec::Kind::choice) {
    std::vector<Other> all;
    for (const std::string& value : parts_of(param.choices))
      if (value != param.default_value)
        all.push_back({value, param.name == "contact" ? "substeps=1" : ""});
    return all;
  }
  const double number = whole<double>(param.default_value).value_or(0);
  const bool elastic = param.name == "penalty-ratio" || param.unit == "N/m";
  const std::string more =
      entry.name == "admm" && elastic && param.name != "penalty" ? "links=elastic" : "";
  if (param.kind == ParamSpec::Kind::integer) return {{number == 1 ? "2" : "1", more}};
  return {{shortest(number == 0 ? 0.01 : number / 2), more}};
}

/// Every value of a parameter changes the result, so none is ignored. With every setting, a solver
/// that is loaded again forgets its former run and returns the same bits.
TEST(EveryParameter, CountsAndNoneIsRememberedFromAnotherRun) {
  int seen = 0;
  const auto run = [](Solver& solver, const Scene& scene) -> State {
    solver.load(scene.start);
    State state;
    try {
      for (int n = 0; n < 12; ++n) solver.step(n * scene.dt, scene.dt);
      solver.store(state);
    } catch (const SolverFailure&) {  // "exploded"
    }
    return state;
  };
  for (const SolverEntry* entry : solvers())
    for (const ParamSpec& param : entry->params)
      for (const Other& other : others(*entry, param)) {
        const std::string text = with(std::string(entry->name), other.with),
                          changed = with(text, std::string(param.name) + "=" + other.value);
        const auto scene = with_everything(changed, param.name == "material");
        if (!scene || !takes(text, *scene)) continue;
        const SolverChoice choice = parse_solver(changed);
        const auto solver = choice.entry->make(*scene, choice.params);
        const State first = run(*solver, *scene);
        if (first.x.empty() || !is_finite(first)) continue;
        const SolverChoice without = parse_solver(text);
        EXPECT_NE(first.x, run(*without.entry->make(*scene, without.params), *scene).x)
            << changed << " is as without it";
        const State again = run(*solver, *scene);
        EXPECT_EQ(again.x, first.x) << changed;
        EXPECT_EQ(again.v, first.v) << changed;
        ++seen;
      }
  EXPECT_GT(seen, 80);
}

}  // namespace
}  // namespace taut::ends_of_ranges_test
