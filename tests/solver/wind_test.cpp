// Wind in jakobsen against core/model/wind.hpp, face by face, in every layout.
#include "core/model/wind.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "core/model/index.hpp"
#include "tests/support/cloths.hpp"

namespace taut::wind_test {
namespace {

Scene windy(Scene scene, Wind::Law law) {
  scene.wind = Wind{.velocity = {3, -1, 2}, .strength = 0.2, .law = law};
  for (std::size_t i = 0; i < scene.start.v.size(); ++i)
    scene.start.v[i] = Vec3(std::sin(0.3 * double(i)), std::cos(0.7 * double(i)), 0.5);
  return scene;
}

/// Velocities after a step under wind and gravity alone.
std::vector<Vec3> expected(const Scene& s) {
  const std::vector<double> w = inverse_masses(s);
  std::vector<Vec3> v = s.start.v;
  for (std::size_t i = 0; i < v.size(); ++i) w[i] == 0 ? v[i].setZero() : v[i] += s.dt * s.gravity;
  for (const Triangle& face : s.mesh.triangles) {
    const auto [a, b, c] = face;
    const auto& from = s.start;
    const Vec3 mean = (from.v[to_index(a)] + from.v[to_index(b)] + from.v[to_index(c)]) / 3;
    const Vec3 force = wind_on_corner(*s.wind, from.x[to_index(a)], from.x[to_index(b)],
                                      from.x[to_index(c)], mean);
    for (const int corner : face) v[to_index(corner)] += s.dt * w[to_index(corner)] * force;
  }
  return v;
}

TEST(Wind, IsTheLawOnEveryFaceInEveryLayout) {
  for (const auto law : {Wind::Law::relative, Wind::Law::literal})
    for (const auto& [nu, nv] : {std::pair{2, 2}, {5, 9}, {17, 12}, {24, 9}, {33, 20}, {65, 7}})
      for (const char* layout : {"auto", "batches"})
        for (const auto& [precision, tolerance] : {std::pair{"double", 1e-9}, {"float", 2e-3}}) {
          const Scene scene = windy(crumpled(hanging_sheet(nu, nv), 0.3 / nu), law);
          const State state = simulate(scene,
                                       std::string("jakobsen:substeps=1,iterations=0,layout=") +
                                           layout + ",precision=" + precision,
                                       1);
          EXPECT_LT(largest_distance(state.v, expected(scene)), tolerance)
              << nu << " x " << nv << ' ' << layout << ' ' << precision;
          EXPECT_GT(largest_distance(state.v, scene.start.v), 0.2);
        }
}

TEST(Wind, FacesOtherThanAGridsOwnAreBlownOnAsTheyAre) {
  Scene scene = windy(crumpled(hanging_sheet(20, 9), 0.01), Wind::Law::relative);
  scene.mesh.triangles.erase(scene.mesh.triangles.begin() + 7);
  std::swap(scene.mesh.triangles[3][0], scene.mesh.triangles[3][2]);
  const State state = simulate(scene, "jakobsen:substeps=1,iterations=0,precision=double", 1);
  EXPECT_LT(largest_distance(state.v, expected(scene)), 1e-9);
}

TEST(Wind, AFaceWithoutAreaFeelsNothing) {
  for (const auto& [nu, nv] : {std::pair{3, 3}, {20, 5}}) {
    Scene scene = windy(hanging_sheet(nu, nv), Wind::Law::relative);
    for (Vec3& x : scene.start.x) x = scene.start.x[0];
    const State state = simulate(scene, "jakobsen:substeps=1,iterations=0", 1);
    for (const Vec3& v : state.v) EXPECT_TRUE(v.allFinite());
    EXPECT_LT(largest_distance(state.v, expected(scene)), 2e-3);
  }
}

}  // namespace
}  // namespace taut::wind_test
