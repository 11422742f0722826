// Motion without constraints: the discrete closed forms of Verlet integration.
#include <gtest/gtest.h>

#include "core/model/solver.hpp"
#include "tests/support/cloths.hpp"

namespace taut::motion_test {
namespace {

Scene falling_sheet() {
  Scene scene;
  scene.name = "fall";
  scene.mesh = make_sheet({.nu = 3, .nv = 3, .width = 1, .height = 1, .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(9, Vec3::Zero())};
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

TEST(Motion, FreeFallMatchesTheDiscreteParabola) {
  const Scene scene = falling_sheet();
  const SolverChoice choice = parse_solver(listing("precision=double"));
  const auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  for (int n = 0; n < scene.steps; ++n) solver->step(n * scene.dt, scene.dt);
  State state;
  solver->store(state);
  // x_n = x0 + g t^2/2 + g t dt/2 for a start with x_-1 = x0
  const double t = scene.duration();
  const Vec3 fall = scene.gravity * (t * t / 2 + t * scene.dt / 2);
  for (std::size_t i = 0; i < state.x.size(); ++i)
    EXPECT_LT((state.x[i] - scene.start.x[i] - fall).norm(), 1e-12);
}

}  // namespace
}  // namespace taut::motion_test
