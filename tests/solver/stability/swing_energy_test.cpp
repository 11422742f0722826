// Guards against solvers that score well at rest and are wrong in motion: the energy of a swinging
// sheet is compared with SHAKE, which conserves it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "tests/support/cloths.hpp"

namespace taut::swing_energy_test {
namespace {

/// Sheet that hangs from two corners 0.8 m apart, turned by 45 degrees about them and released.
Scene swing() {
  Scene scene = hanging_sheet(8, 8, {.structural = true});
  scene.start.x[7].x() = 0.8;
  const auto rest = reference::static_equilibrium(scene);
  const Eigen::AngleAxisd turn(std::numbers::pi / 4, Vec3::UnitX());
  for (std::size_t i = 0; i < rest.x.size(); ++i) scene.start.x[i] = turn * rest.x[i];
  return scene;
}

/// Kinetic and potential energy [J].
double energy(const Scene& scene, const State& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i)
    sum += scene.mesh.mass[i] * (state.v[i].squaredNorm() / 2 - scene.gravity.dot(state.x[i]));
  return sum;
}

TEST(SwingEnergy, IsKeptByTheReferenceAndNotBySweeps) {
  const Scene scene = swing();
  const double start = energy(scene, scene.start), unit = 0.2 * 9.81;
  reference::Shake shake(scene, 1.0 / 512);
  for (int n = 0; n < 512; ++n) ASSERT_TRUE(shake.step());
  EXPECT_NEAR(energy(scene, shake.state()), start, 0.002 * unit);
  const auto lost = [&](const char* setting) {
    const State state = simulate(scene, listing(std::string("precision=double,") + setting), 64);
    return (start - energy(scene, state)) / unit;
  };
  const double sweeps = lost("iterations=16"), substeps = lost("iterations=1,substeps=16"),
               coloured = lost("iterations=1,substeps=16,order=coloured");
  EXPECT_GT(sweeps, 0.03);
  EXPECT_GT(sweeps, 3 * std::abs(substeps));
  EXPECT_GT(sweeps, 3 * std::abs(coloured));
}

}  // namespace
}  // namespace taut::swing_energy_test
