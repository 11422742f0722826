// Geometry of the surfaces that are drawn, their light, and the places of camera and ground.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/render/image/colour.hpp"
#include "experiments/render/picture/scene_renderer.hpp"
#include "tests/render/render_scenes.hpp"

namespace taut::surfaces_test {
namespace {

/// Volume enclosed by the faces around the origin, from which all of them are visible [m^3].
double volume(const RenderMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += static_cast<double>(
        std::abs(mesh.position[a].cross(mesh.position[b]).dot(mesh.position[c])));
  return six / 6;
}

double area(const RenderMesh& mesh) {
  double two = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    two += static_cast<double>(
        (mesh.position[b] - mesh.position[a]).cross(mesh.position[c] - mesh.position[a]).norm());
  return two / 2;
}

TEST(DrawnSheet, PassesThroughItsParticles) {
  const Scene scene = test::level_sheet(5);
  const ClothMesher mesher(scene, 16);  // 4 pieces per quad
  std::vector<Vec3> x = scene.start.x;
  std::vector<double> values, depths;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i].y() = x[i].x() * x[i].x();
    values.push_back(2 * x[i].x() + 3 * x[i].z());
    depths.push_back(x[i].z());
  }
  const RenderMesh mesh = mesher.mesh(x, values, depths);
  ASSERT_EQ(mesh.position.size(), 17u * 17u);
  EXPECT_EQ(mesh.triangles.size(), 2u * 16u * 16u);
  EXPECT_EQ(mesher.grid_spacing(), 1);
  EXPECT_EQ(ClothMesher(test::level_sheet(25), 16).grid_spacing(), 2);
  for (std::size_t j = 0; j < 17; ++j)
    for (std::size_t i = 0; i < 17; ++i) {
      const std::size_t k = j * 17 + i;
      const Vec3f& p = mesh.position[k];
      if (i % 4 == 0 && j % 4 == 0) {
        EXPECT_LT((p - x[j / 4 * 5 + i / 4].cast<float>()).norm(), 1e-6);
      }
      EXPECT_NEAR(mesh.value[k], 2 * p.x() + 3 * p.z(), 1e-5);
      EXPECT_NEAR(mesh.hidden[k], p.z(), 1e-5);
      EXPECT_NEAR(mesh.uv[k].x(), static_cast<float>(i) / 4, 1e-6);
      EXPECT_NEAR(mesh.uv[k].y(), static_cast<float>(j) / 4, 1e-6);
      // A parabola of rows is reproduced exactly between the outermost quads.
      if (i >= 4 && i <= 12) {
        EXPECT_NEAR(p.y(), p.x() * p.x(), 1e-6);
      }
      EXPECT_NEAR(mesh.normal[k].norm(), 1, 1e-5);
    }
  EXPECT_NEAR(
      mesher.mean_rest_length(),
      [&] {
        double sum = 0;
        for (const Link& link : scene.links) sum += link.rest;
        return sum / static_cast<double>(scene.links.size());
      }(),
      1e-12);
}

TEST(DrawnSheet, IsCoveredOnceByFacesThatAllTurnAlike) {
  Scene scene = test::level_sheet(4);
  scene.mesh = make_sheet({.nu = 4, .nv = 3, .width = 1.5, .height = 1, .mass = 1});
  const std::vector<double> none(12, 0);
  for (const int finest : {3, 12}) {
    const RenderMesh mesh = ClothMesher(scene, finest).mesh(scene.mesh.rest, none, none);
    EXPECT_EQ(mesh.position.size(), finest == 3 ? 12u : 13u * 9u);
    EXPECT_NEAR(area(mesh), 1.5, 1e-5);
    Vec3f sum = Vec3f::Zero();
    for (const auto& [a, b, c] : mesh.triangles)
      sum += (mesh.position[b] - mesh.position[a]).cross(mesh.position[c] - mesh.position[a]) / 2;
    EXPECT_NEAR(sum.norm(), 1.5, 1e-5);
    for (const Vec3f& n : mesh.normal) EXPECT_NEAR(n.dot(sum) / sum.norm(), 1, 1e-5);
  }
}

TEST(DrawnCloth, WithoutAGridIsItsFacesElseATube) {
  Scene scene = test::level_sheet(3);
  scene.mesh = make_sheet({.nu = 3, .nv = 3, .width = 2, .height = 1, .mass = 1});
  scene.mesh.grid.reset();
  std::vector<double> values, none(9, 0);
  for (int i = 0; i < 9; ++i) values.push_back(0.5 * i);
  const RenderMesh faces = ClothMesher(scene, 64).mesh(scene.mesh.rest, values, none);
  ASSERT_EQ(faces.position.size(), 9u);
  ASSERT_EQ(faces.triangles.size(), scene.mesh.triangles.size());
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_LT((faces.position[i].cast<double>() - scene.mesh.rest[i]).norm(), 1e-7);
    EXPECT_EQ(faces.value[i], static_cast<float>(values[i]));
    EXPECT_NEAR(faces.normal[i].norm(), 1, 1e-6);
  }
  for (std::size_t k = 0; k < faces.triangles.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(static_cast<int>(faces.triangles[k][c]), scene.mesh.triangles[k][c]);
  EXPECT_NEAR(area(faces), 2, 1e-6);
  EXPECT_EQ(ClothMesher(scene, 64).grid_spacing(), 0);

  scene.mesh.triangles.clear();
  scene.links = {{0, 2, 1, Family::structural}, {4, 4, 1, Family::bend}};
  const RenderMesh tube = ClothMesher(scene, 64).mesh(scene.mesh.rest, values, none);
  const float radius = 0.006f * static_cast<float>(extent(scene));
  const Vec3f from = scene.mesh.rest[0].cast<float>(), to = scene.mesh.rest[2].cast<float>(),
              axis = (to - from).normalized();
  const std::size_t bead = 8 * 15;
  ASSERT_EQ(tube.position.size(), 24 + 9 * bead) << "12 sides, and a bead at each vertex";
  Vec3f middle = Vec3f::Zero();
  for (std::size_t i = 0; i < 24; ++i) {
    const Vec3f p = tube.position[i] - from;
    EXPECT_NEAR((p - p.dot(axis) * axis).norm(), radius, 1e-5);
    const bool end = p.dot(axis) > 1;
    EXPECT_NEAR(p.dot(axis), end ? (to - from).norm() : 0, 1e-5);
    EXPECT_EQ(tube.value[i], end ? 1.0f : 0.0f) << "of its vertex";
    EXPECT_NEAR(tube.normal[i].dot(p - p.dot(axis) * axis), radius, 1e-5);
    middle += tube.position[i] / 24;
  }
  EXPECT_LT((middle - (from + to) / 2).norm(), 1e-5) << "all around";
  for (std::size_t i = 24; i < tube.position.size(); ++i) {
    const std::size_t vertex = (i - 24) / bead;
    EXPECT_NEAR((tube.position[i] - scene.mesh.rest[vertex].cast<float>()).norm(), 2 * radius,
                1e-5);
    EXPECT_EQ(tube.value[i], static_cast<float>(values[vertex]));
  }
  RenderMesh ball;
  append_ball(ball, Vec3f::Zero(), 0.5f, 48, 7);
  EXPECT_NEAR(volume(ball), 4 * std::numbers::pi / 3 * 0.125, 0.005);
  EXPECT_NEAR(area(ball), std::numbers::pi, 0.015);
  EXPECT_EQ(ball.value.front(), 7);
}

TEST(DrawnColliders, HaveTheirSizesLessTheInset) {
  const double pi = std::numbers::pi;
  const RenderMesh ball = collider_mesh({Ball{Vec3(1, 2, 3), 0.5}, {}, 0}, 0, {.inset = 0.1});
  for (const Vec3f& p : ball.position) EXPECT_NEAR((p - Vec3f(1, 2, 3)).norm(), 0.4, 1e-5);
  EXPECT_NEAR(area(ball), 4 * pi * 0.16, 0.01);
  const RenderMesh kept = collider_mesh({Ball{Vec3::Zero(), 0.5}, {}, 0}, 0, {.inset = 0.4});
  EXPECT_NEAR(kept.position.front().norm(), 0.25, 1e-6) << "half of it at least";
  const RenderMesh capsule =
      collider_mesh({Capsule{Vec3(1, 2, 3), Vec3(1, 4, 3), 0.5}, {}, 0}, 0, {.inset = 0.1});
  for (std::size_t i = 0; i < capsule.position.size(); ++i) {
    const Vec3f& p = capsule.position[i];
    const Vec3f out = p - Vec3f(1, std::clamp(p.y(), 2.0F, 4.0F), 3);
    EXPECT_NEAR(out.norm(), 0.4, 1e-5);
    EXPECT_LT((out / 0.4F - capsule.normal[i]).norm(), 1e-4);
  }
  EXPECT_NEAR(area(capsule), 4 * pi * 0.16 + 2 * pi * 0.4 * 2, 0.02);
  Box box;
  box.center = Vec3(1, 0, 0);
  box.half_extents = Vec3(0.5, 0.4, 0.3);
  RenderMesh sharp = collider_mesh({box, {}, 0}, 0, {.inset = 0.1});
  for (Vec3f& p : sharp.position) p -= Vec3f(1, 0, 0);
  EXPECT_NEAR(volume(sharp), 8 * 0.4 * 0.3 * 0.2, 1e-5);
  EXPECT_NEAR(area(sharp), 8 * (0.4 * 0.3 + 0.3 * 0.2 + 0.2 * 0.4), 1e-4);
  RenderMesh round = collider_mesh({box, {}, 0}, 0, {.inset = 0.1, .rounding = 0.05});
  for (Vec3f& p : round.position) p -= Vec3f(1, 0, 0);
  const double r = 0.05, a = 0.7, b = 0.5, c = 0.3;  // radius, and sides of the core
  EXPECT_NEAR(volume(round),
              a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) +
                  4 * pi / 3 * r * r * r,
              1e-3);
  Plane plane;
  plane.normal = Vec3(0.6, 0.8, 0);
  plane.offset = 2;
  const Vec3 above(3, 4, 5);
  const RenderMesh ground =
      collider_mesh({plane, {}, 0}, 0, {.inset = 0.1, .centre = above, .reach = 1.5});
  Vec3f mean = Vec3f::Zero();
  for (const Vec3f& p : ground.position) {
    EXPECT_NEAR(p.dot(plane.normal.cast<float>()), 1.9, 1e-5);
    mean += p / static_cast<float>(ground.position.size());
  }
  EXPECT_LT((mean - (above - plane.normal * (plane.normal.dot(above) - 1.9)).cast<float>()).norm(),
            1e-4);
  EXPECT_NEAR(area(ground), 9, 1e-4);
}

TEST(DrawnCloth, IsLiftedOutOfACollidersSkinAlone) {
  Scene scene = test::level_sheet(3);
  scene.colliders.push_back({Ball{Vec3::Zero(), 1}, {}, 0});
  RenderMesh mesh;
  for (const float r : {1.2f, 1.05f, 0.9f, 0.81f, 0.79f, 0.5f})
    mesh.position.emplace_back(r, 0.0f, 0.0f);
  mesh.triangles = {{0, 1, 2}};
  lift_out_of_colliders(mesh, scene, 0, 0.1);
  const float after[] = {1.2f, 1.1f, 1.1f, 1.1f, 0.79f, 0.5f};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(mesh.position[i].x(), after[i], 1e-5);
  EXPECT_EQ(mesh.normal.size(), 6u);
}

Camera camera_in_front() {
  const std::vector<Vec3> points{Vec3(-1, -1, 0), Vec3(1, 1, 0)};
  return fit_camera(points, Vec3::UnitY(), View{}, 1, FitRegion{});
}

TEST(Lights, AreAKeyFromTheLeftAFillFromTheRightAndTheSky) {
  const Camera camera = camera_in_front();
  const std::vector<Light> lights = light_set(36, Vec3f::UnitY(), camera);
  ASSERT_EQ(lights.size(), 36u);
  const auto part = [&](std::size_t from, std::size_t to) {
    Light sum{Vec3f::Zero(), 0};
    for (std::size_t i = from; i < to; ++i) {
      EXPECT_NEAR(lights[i].direction.norm(), 1, 1e-5);
      sum.direction += lights[i].direction * lights[i].weight;
      sum.weight += lights[i].weight;
    }
    sum.direction.normalize();
    return sum;
  };
  const Light key = part(0, 12), fill = part(12, 18), sky = part(18, 36);
  EXPECT_NEAR(key.weight, 0.72, 1e-5);
  EXPECT_NEAR(fill.weight, 0.24, 1e-5);
  EXPECT_NEAR(sky.weight, 0.52, 1e-5);
  const float degree = std::numbers::pi_v<float> / 180;
  EXPECT_NEAR(std::asin(key.direction.y()) / degree, 52, 1.5);
  EXPECT_NEAR(std::asin(fill.direction.y()) / degree, 34, 5);
  EXPECT_GT(sky.direction.y(), 0.95);
  EXPECT_LT(key.direction.dot(camera.right), -0.4);
  EXPECT_GT(fill.direction.dot(camera.right), 0.5);
  EXPECT_GT(key.direction.dot(camera.back), 0);
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_GT(lights[i].direction.dot(key.direction), std::cos(11 * degree));
  for (std::size_t i = 18; i < 36; ++i) EXPECT_GT(lights[i].direction.y(), 0);
}

/// Mean brightness of the pixels around this place of a picture, 0 to 1.
double brightness(const Image& picture, double x, double y) {
  double sum = 0;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i) {
      const Rgb8 c = picture.at(static_cast<int>(x * picture.width()) + i,
                                static_cast<int>(y * picture.height()) + j);
      sum += (c.r + c.g + c.b) / (3 * 255.0 * 25);
    }
  return sum;
}

// A canopy above level ground, seen from 60 degrees above: its shadow is dark. Its upper side, and
// ground far from it, are as bright as without any other object.
TEST(Lights, OpenGroundIsBrightAndBelowACanopyDark) {
  Panel panel;
  const std::vector<Vec3> seen{Vec3(-2, 0, -2), Vec3(2, 0, 2)};
  panel.camera = fit_camera(seen, Vec3::UnitY(), View{0, 60}, 1, FitRegion{});
  panel.theme = Theme::paper();
  panel.theme.line = 0;
  panel.theme.shadow = 1;
  panel.lights = light_set(24, Vec3f::UnitY(), panel.camera);
  panel.ground.half_side = 2;
  panel.casters = {Vec3f::Zero(), 1};
  const GlContext gl;
  const Renderer renderer(gl, 200, 200, 1, {24, 256, 80});

  const Scene scene = test::level_sheet(9);
  const std::vector<double> none(scene.start.x.size(), 0);
  std::vector<Vec3> x = scene.start.x;
  const ClothMesher mesher(scene, 8);
  const auto sheet = [&](double scale, double height) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = scale * scene.start.x[i] + Vec3(0, height, 0);
    return mesher.mesh(x, none, none);
  };
  /// brightness, 0 to 1, where the picture shows a point of the world
  const auto at = [&](const Image& picture, const Vec3f& p) {
    const Eigen::Vector4d clip = (panel.camera.world_to_clip(1) * p.homogeneous()).cast<double>();
    return brightness(picture, 0.5 + 0.5 * clip.x() / clip.w(), 0.5 - 0.5 * clip.y() / clip.w());
  };
  const Vec3f far(1.7f, 0, 0), below(0, 0, 0.3f);
  const RenderMesh speck = sheet(0.001, 0), high = sheet(0.9, 0.5), lower = sheet(0.2, 0.05);

  panel.painted = {{&speck, rgb(0x808080), 0}};
  const Image open = renderer.draw(panel);
  EXPECT_NEAR(at(open, below), at(open, far), 0.02) << "open ground is the background";
  EXPECT_NEAR(at(open, far), 0.92, 0.03);

  panel.painted = {{&high, {}, 0}};
  const Image covered = renderer.draw(panel);
  panel.painted = {{&lower, {}, 0}};
  const double uncovered = at(renderer.draw(panel), Vec3f(0, 0.05f, 0));
  EXPECT_NEAR(at(covered, Vec3f(0, 0.5f, 0)), uncovered, 0.01) << "height makes no difference";
  EXPECT_NEAR(at(covered, far), at(open, far), 0.01) << "far from it";
  // The key light comes from the left at 52 degrees, so that the shadow lies to the right of the
  // canopy.
  EXPECT_LT(at(covered, Vec3f(0.65f, 0, -0.1f)), 0.85 * at(open, far)) << "in its shade";
  EXPECT_GT(at(covered, Vec3f(-0.65f, 0, -0.1f)), 0.9 * at(open, far)) << "on its bright side";
}

TEST(Places, FollowClothThatNothingHolds) {
  Scene scene = test::level_sheet(5);
  const std::vector<RecordedRun> runs{test::stretched(scene, 0)};
  const Placing loose = place(scene, runs, {0}, View{}, FitRegion{}, 1, 0.01);
  EXPECT_TRUE(loose.follows);
  EXPECT_NEAR(loose.radius, std::sqrt(0.5), 1e-6);
  EXPECT_LT(loose.centre.norm(), 1e-9);
  EXPECT_NEAR(loose.ground, -0.08 * loose.radius, 1e-6);
  EXPECT_EQ(loose.floor, nullptr);
  EXPECT_GE(loose.cell, 0.3 * loose.radius);
  EXPECT_LE(loose.cell, loose.radius);
  EXPECT_LT(centroid(runs, 0).norm(), 1e-9);
  const Ground below = loose.floor_below(Vec3(1, 5, 2));
  EXPECT_NEAR(below.origin.y(), loose.ground, 1e-6);
  EXPECT_NEAR(below.origin.x(), 1, 1e-6);
  EXPECT_NEAR(below.half_side, 2.6 * loose.radius, 1e-5);
  EXPECT_NEAR(below.u.cross(below.v).dot(below.up), 1, 1e-5);
  const Vec3 high(0, 10.3 * loose.cell, 0);
  const Ground wall = loose.wall(high);
  EXPECT_NEAR(wall.origin.y(), 10 * loose.cell, 1e-5) << "its lines stay where they are";
  EXPECT_NEAR(wall.half_side, 2.2 * loose.radius, 1e-5);
  EXPECT_LT((wall.origin - high.cast<float>()).dot(loose.camera.back), 0);
  scene.pins = {0};
  EXPECT_FALSE(place(scene, runs, {0}, View{}, FitRegion{}, 1, 0.01).follows);
  Plane plane;
  plane.normal = Vec3::UnitY();
  plane.offset = -0.7;
  scene.colliders.push_back({plane, {}, 0});
  const Placing floored = place(scene, runs, {0}, View{}, FitRegion{}, 1, 0.01);
  EXPECT_NE(floored.floor, nullptr);
  EXPECT_NEAR(floored.ground, -0.71, 1e-9);
}

}  // namespace
}  // namespace taut::surfaces_test
