// Stiffness in N/m means the same for every time step and every number of sweeps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/cloths.hpp"

namespace taut {
namespace {

/// Masses of 0.1 kg on a chain of links of 1/(n-1) m, hanging from the first.
Scene chain(int n, double dt) {
  Scene scene = hanging_sheet(1, n, {true, false, false}, Lumping::equal);
  for (double& mass : scene.mesh.mass) mass = 0.1;
  scene.dt = dt;
  scene.damping = 4;
  return scene;
}

std::string soft(double stiffness, int iterations, const char* projection = "exact") {
  return listing("precision=double,structural_stiffness=") + std::to_string(stiffness) +
         ",iterations=" + std::to_string(iterations) + ",projection=" + projection;
}

TEST(Stiffness, AMassHangsByItsWeightOverStiffness) {
  for (const double dt : {1.0 / 64, 1.0 / 256})
    for (const int iterations : {1, 3, 20}) {
      const Scene scene = chain(2, dt);
      const State state = simulate(scene, soft(50, iterations), static_cast<int>(8 / dt));
      EXPECT_NEAR(-state.x[1].y() - 1, 0.1 * 9.81 / 50, 1e-9) << dt << ' ' << iterations;
    }
}

TEST(Stiffness, ASoftChainStretchesAsHookeSays) {
  const int n = 6;
  for (const double dt : {1.0 / 64, 1.0 / 128})
    for (const int iterations : {1, 4}) {
      const Scene scene = chain(n, dt);
      const State state = simulate(scene, soft(20, iterations), static_cast<int>(16 / dt));
      const int links = n - 1;
      const double stretch = 0.1 * 9.81 * links * (links + 1) / (2 * 20.0);
      EXPECT_NEAR(-state.x.back().y() - 1, stretch, 0.1 * stretch) << dt << ' ' << iterations;
    }
}

TEST(Stiffness, AStiffSpringIsAStick) {
  const Scene scene = crumpled(hanging_sheet(6, 6), 0.02);
  const State spring = simulate(scene, soft(1e15, 4), 10);
  const State stick = simulate(scene, soft(std::numeric_limits<double>::infinity(), 4), 10);
  EXPECT_LT(largest_distance(spring.x, stick.x), 1e-3);
}

}  // namespace
}  // namespace taut
