// Drape coefficient and bending length of states with known answers.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/io/scene_io.hpp"
#include "core/reference/elastica.hpp"
#include "tests/metrics/measured.hpp"
#include "tests/support/cloths.hpp"

namespace taut::drape_test {
namespace {

/// Level square of 9 x 9 vertices; the inner 5 x 5, half a side wide, are the support.
Scene table() {
  Scene s = hanging_sheet(9, 9, {true, false, false});
  for (Vec3& x : s.mesh.rest) x = Vec3(x.x(), 0, x.y());
  s.start.x = s.mesh.rest;
  s.pins.clear();
  for (int j = 2; j <= 6; ++j)
    for (int i = 2; i <= 6; ++i) s.pins.push_back(s.mesh.grid->index(i, j));
  s.steps = 4;
  return s;
}

/// Value of a metric for a cloth at rest.
double standing(const Scene& s, const std::vector<Vec3>& x, const std::string& value) {
  return measure(s,
                 [&](int) {
                   return State{x, std::vector<Vec3>(x.size(), Vec3::Zero())};
                 })
      .at(value);
}

double coefficient(const Scene& s, const std::vector<Vec3>& x) {
  return standing(s, x, "drape.coefficient");
}

TEST(Drape, IsWhatTheShadowCoversBesideTheSupport) {
  const Scene s = table();
  std::vector<Vec3> x = s.mesh.rest;
  EXPECT_NEAR(coefficient(s, x), 1, 1e-9) << "flat";
  const auto inside = [](double c, double low, double high) { return std::clamp(c, low, high); };
  for (Vec3& p : x) p = Vec3(inside(p.x(), 0.25, 0.75), p.y(), inside(p.z(), -0.75, -0.25));
  EXPECT_NEAR(coefficient(s, x), 0, 1e-9) << "straight down";
  for (const double wide : {0.9, 0.3, 1.0}) {  // with 1.0 the edges coincide
    x = s.mesh.rest;
    for (Vec3& p : x)
      // folded under, so that it is covered twice
      if (p.x() > 0.75) p.x() = 0.75 - wide * (p.x() - 0.75);
    EXPECT_NEAR(coefficient(s, x), (0.75 - 0.25) / 0.75, 1e-9) << "a flap under the support";
  }
  for (Vec3& p : x) p.y() += 3 * p.x();
  EXPECT_NEAR(coefficient(s, x), (0.75 - 0.25) / 0.75, 1e-9) << "heights cast no shadow";
  x = s.mesh.rest;
  for (Vec3& p : x) p = Vec3(p.x() - p.z(), 0, p.x() + p.z()) / std::sqrt(2.0);
  EXPECT_NEAR(coefficient(s, x), 1, 1e-5) << "turned by 45 degrees: lines cut corners";
}

// ISO 9073-9: a round cloth of 30 cm on a disc of 18 cm, which has 254.47 cm^2 for every mesh.
TEST(Drape, OfARoundClothTheSupportIsADisc) {
  for (const char* mesh : {"woven-disc.obj", "woven-disc-fine.obj"}) {
    Scene s =
        load_scene(std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/scenes/drape-disc.toml",
                   {std::string("cloth.mesh=\"") + mesh + "\""});
    s.steps = 4;
    double cloth = 0;
    for (const auto& [a, b, c] : s.mesh.triangles) {
      const auto x = [&](int v) { return s.mesh.rest[to_index(v)]; };
      cloth += (x(b) - x(a)).cross(x(c) - x(a)).norm() / 2;
    }
    const double support = std::numbers::pi * 0.09 * 0.09;
    EXPECT_NEAR(coefficient(s, s.mesh.rest), 1, 1e-4) << "flat";
    std::vector<Vec3> x = s.mesh.rest;
    for (Vec3& p : x) p *= 0.8;  // only the shadow counts, whatever holds the cloth
    EXPECT_NEAR(coefficient(s, x), (0.64 * cloth - support) / (cloth - support), 1e-4) << mesh;
  }
}

TEST(Drape, IsOfScenesWithALevelSupportAlone) {
  const auto has = [](const Scene& s) {
    return find_value("drape.coefficient").first->make(s) != nullptr;
  };
  Scene s = table();
  EXPECT_TRUE(has(s));
  s.gravity = Vec3(0, -9, 1);
  EXPECT_FALSE(has(s)) << "aslant";
  s.gravity = Vec3::Zero();
  EXPECT_FALSE(has(s));
  // corners of the first faces and of the last ones
  for (const int corner : {2 * 9 + 2, 6 * 9 + 6}) {
    s = table();
    s.mesh.rest[to_index(corner)].y() += 0.1;
    s.start.x = s.mesh.rest;
    EXPECT_FALSE(has(s)) << "one corner of the support is higher";
  }
  EXPECT_FALSE(has(hanging_sheet(5, 5))) << "no face is pinned";
}

/// Strip that extends 0.2 m from a clamp between its first two rows.
Scene strip() {
  Scene s = hanging_sheet(3, 9, {true, false, false});
  const double l = 0.2 / 7.5;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 3; ++i) s.mesh.rest[to_index(3 * j + i)] = Vec3(i * l, 0, j * l);
  s.start.x = s.mesh.rest;
  s.pins = {0, 1, 2, 3, 4, 5};
  s.steps = 4;
  return s;
}

/// Positions with the strip's last rows turned about the clamp.
std::vector<Vec3> turned(const Scene& s, double angle) {
  std::vector<Vec3> x = s.mesh.rest;
  const double l = 0.2 / 7.5;
  for (std::size_t v = 6; v < x.size(); ++v) {
    const double out = s.mesh.rest[v].z() - l / 2;
    x[v] = Vec3(x[v].x(), -out * std::sin(angle), l / 2 + out * std::cos(angle));
  }
  return x;
}

TEST(Cantilever, SeesItsEndFromBetweenTheTwoRows) {
  const Scene s = strip();
  const double angle = 0.7243;
  const std::vector<Vec3> x = turned(s, angle);
  EXPECT_NEAR(standing(s, x, "cantilever.angle"), angle, 1e-12);
  EXPECT_NEAR(standing(s, x, "cantilever.bending_length"),
              0.2 * std::cbrt(std::cos(angle / 2) / (8 * std::tan(angle))), 1e-12);
  EXPECT_NEAR(standing(s, x, "cantilever.bending_length") / 0.2, 0.50932, 1e-4) << "41.5 degrees";
}

// Deviation of Peirce's formula from the elastica, as stated in the help.
TEST(Cantilever, HasABendingLengthWherePeircesFormulaHolds) {
  const Scene s = strip();
  const auto too_long = [&](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return standing(s, turned(s, angle), "cantilever.bending_length") /
               (0.2 * reference::bending_length(angle)) -
           1;
  };
  EXPECT_NEAR(too_long(20), 0.0042, 1e-4);
  EXPECT_NEAR(too_long(41.5), 0.0188, 1e-4);
  EXPECT_NEAR(too_long(59.999), 0.0442, 1e-4);
  // no bending length above 60 degrees, level or bent upwards
  for (const double degrees : {60.001, 0.0, -0.001, -30.0})
    EXPECT_TRUE(std::isnan(too_long(degrees))) << degrees;
  EXPECT_NEAR(reference::peirce_bending_length(87 * std::numbers::pi / 180) /
                  reference::bending_length(87 * std::numbers::pi / 180),
              1.566, 1e-3);
}

TEST(Cantilever, IsOfLevelStripsHeldByTwoRowsAlone) {
  const auto has = [](const Scene& s) {
    return find_value("cantilever.angle").first->make(s) != nullptr;
  };
  Scene s = strip();
  EXPECT_TRUE(has(s));
  s.pins.pop_back();
  EXPECT_FALSE(has(s)) << "a row and a half";
  s = strip();
  s.gravity = Vec3(0, 0, -9.81);
  EXPECT_FALSE(has(s)) << "it hangs";
  s = strip();
  s.mesh.grid.reset();
  EXPECT_FALSE(has(s));
}

}  // namespace
}  // namespace taut::drape_test
