// Parts of a scene: sheets, links, moving colliders, content.
#include "core/model/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "core/model/adjacency.hpp"

namespace taut::scene_test {
namespace {

TEST(Sheet, OfThreeByTwoVerticesAsItIsDocumented) {
  const Mesh mesh = make_sheet({.nu = 3,
                                .nv = 2,
                                .width = 4,
                                .height = 5,
                                .origin = {1, 2, 3},
                                .u = Vec3::UnitZ(),
                                .v = -Vec3::UnitX(),
                                .mass = 16});
  const std::vector<Vec3> rest{{1, 2, 3}, {1, 2, 5}, {1, 2, 7}, {-4, 2, 3}, {-4, 2, 5}, {-4, 2, 7}};
  EXPECT_EQ(mesh.rest, rest);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 3, 4}, {0, 4, 1}, {1, 4, 2}, {2, 4, 5}}));
  EXPECT_EQ(mesh.mass, (std::vector<double>{2, 4, 2, 2, 4, 2}));
  EXPECT_EQ(make_sheet({.nu = 2, .nv = 4, .mass = 16, .lumping = Lumping::equal}).mass,
            std::vector<double>(8, 2));
  EXPECT_EQ(make_sheet({.nu = 1, .nv = 3, .height = 1, .mass = 8}).mass,
            (std::vector<double>{2, 4, 2}));
}

TEST(Sheet, LinksComeInTheOrderInWhichTheyAreVisited) {
  const Mesh mesh = make_sheet({.nu = 3, .nv = 3, .width = 6, .height = 8, .mass = 1});
  struct Expected {
    int a, b;
    double rest;
    Family family;
  };
  const auto s = Family::structural, h = Family::shear, b = Family::bend;
  const std::vector<Expected> expected{
      {0, 1, 3, s}, {0, 3, 4, s}, {1, 2, 3, s}, {1, 4, 4, s}, {2, 5, 4, s}, {3, 4, 3, s},
      {3, 6, 4, s}, {4, 5, 3, s}, {4, 7, 4, s}, {5, 8, 4, s}, {6, 7, 3, s}, {7, 8, 3, s},
      {0, 4, 5, h}, {1, 5, 5, h}, {1, 3, 5, h}, {2, 4, 5, h}, {3, 7, 5, h}, {4, 8, 5, h},
      {4, 6, 5, h}, {5, 7, 5, h}, {0, 2, 6, b}, {0, 6, 8, b}, {1, 7, 8, b}, {2, 8, 8, b},
      {3, 5, 6, b}, {6, 8, 6, b}};
  const auto links = grid_links(mesh, {.structural = true, .shear = true, .bend = true});
  ASSERT_EQ(links.size(), expected.size());
  for (std::size_t k = 0; k < links.size(); ++k) {
    EXPECT_EQ(std::pair(links[k].a, links[k].b), std::pair(expected[k].a, expected[k].b)) << k;
    EXPECT_DOUBLE_EQ(links[k].rest, expected[k].rest) << k;
    EXPECT_EQ(links[k].family, expected[k].family) << k;
  }
  EXPECT_EQ(grid_links(mesh, {}).size(), 12u) << "structural ones unless asked otherwise";
  EXPECT_TRUE(grid_links(mesh, {.structural = false}).empty());
}

// 0 - 1 - 2 - 3 in a row, 0 - 4 - 3 as a detour, 5 - 6 separate.
TEST(ShortestWays, LeadFromTheNearestStartAlongTheShortestLinks) {
  const std::vector<Link> links{{0, 1, 2}, {1, 2, 2}, {2, 3, 2}, {0, 4, 1.5}, {4, 3, 1}, {5, 6, 1}};
  const Adjacency neighbours(links, 7);
  EXPECT_EQ(neighbours.size(), 7u);
  const auto of_zero = neighbours.of(0);
  ASSERT_EQ(of_zero.size(), 2u);
  EXPECT_EQ(std::pair(of_zero[0].vertex, of_zero[0].link), std::pair(1, 0));
  EXPECT_EQ(std::pair(of_zero[1].vertex, of_zero[1].link), std::pair(4, 3));
  ASSERT_EQ(neighbours.of(6).size(), 1u);
  EXPECT_EQ(neighbours.of(6)[0].vertex, 5);
  const auto ways = [&](const std::vector<int>& starts) {
    return shortest_ways(neighbours, starts, [&](int, const Adjacency::End& end) {
      return links[to_index(end.link)].rest;
    });
  };
  const double far = std::numeric_limits<double>::infinity();
  const ShortestPaths<double> from_0 = ways({0});
  EXPECT_EQ(from_0.length, (std::vector<double>{0, 2, 4, 2.5, 1.5, far, far}));
  EXPECT_EQ(from_0.start, (std::vector{0, 0, 0, 0, 0, -1, -1}));
  EXPECT_EQ(from_0.before, (std::vector{-1, 0, 1, 4, 0, -1, -1}));
  const ShortestPaths<double> from_two = ways({2, 6});
  EXPECT_EQ(from_two.length, (std::vector<double>{4, 2, 0, 2, 3, 1, 0}));
  EXPECT_EQ(from_two.start, (std::vector{2, 2, 2, 2, 2, 6, 6}));
  EXPECT_EQ(from_two.before, (std::vector{1, 2, -1, 2, 3, 6, -1}));
}

/// Expects this distance and this outward normal.
void expect_surface(const Shape& shape, const Vec3& p, double distance, const Vec3& normal) {
  const Surface s = surface(shape, p);
  EXPECT_NEAR(s.distance, distance, 1e-15) << p.transpose();
  EXPECT_LT((s.normal - normal).norm(), 1e-15) << p.transpose() << ": " << s.normal.transpose();
}

TEST(Surface, OfABoxIsExactOnItsFacesItsEdgesAndInItsMiddle) {
  const Box box{{10, 20, 30}, {1, 2, 3}};
  const Vec3 c = box.center;
  expect_surface(box, c + Vec3(1, 0.5, 0.5), 0, Vec3::UnitX());
  expect_surface(box, c + Vec3(0.5, -2, 0.5), 0, -Vec3::UnitY());
  expect_surface(box, c + Vec3(-0.25, 0.5, 0.5), -0.75, -Vec3::UnitX());
  expect_surface(box, c + Vec3(0.5, 1.75, 0.5), -0.25, Vec3::UnitY());
  expect_surface(box, c + Vec3(0, 0, -2.875), -0.125, -Vec3::UnitZ());
  expect_surface(box, c, -1, Vec3::UnitX());
  expect_surface(box, c + Vec3(1.5, 0, 0), 0.5, Vec3::UnitX());
  expect_surface(box, c + Vec3(4, -6, 1), 5, Vec3(0.6, -0.8, 0));
  expect_surface(box, c + Vec3(2, 4, -5), 3, Vec3(1, 2, -2) / 3);
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));
  const Surface turned = surface(Box{c, box.half_extents, quarter}, c + Vec3(0, 1.5, 0));
  EXPECT_NEAR(turned.distance, 0.5, 1e-15) << "its own x lies along y";
  EXPECT_LT((turned.normal - Vec3::UnitY()).norm(), 1e-15);
}

TEST(Surface, OfABallAndAPlane) {
  expect_surface(Ball{{1, 2, 3}, 5}, {1, 2, 3}, -5, Vec3::UnitY());
  expect_surface(Ball{{1, 2, 3}, 5}, {4, 2, 7}, 0, Vec3(0.6, 0, 0.8));
  expect_surface(Ball{{1, 2, 3}, 5}, {1, 2, -4}, 2, -Vec3::UnitZ());
  expect_surface(Plane{{0, 0.6, 0.8}, 2}, {7, 5, 5}, 5, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(type_name(Plane{}), "plane");
  EXPECT_EQ(type_name(Ball{}), "ball");
  EXPECT_EQ(type_name(Box{}), "box");
}

TEST(Surface, OfACapsuleIsThatOfABallOnItsAxis) {
  const Capsule capsule{{0, 0, 0}, {0, 0, 4}, 0.5};
  expect_surface(capsule, {0.9, 1.2, 1}, 1, Vec3(0.6, 0.8, 0));
  expect_surface(capsule, {0, 0.2, 3}, -0.3, Vec3::UnitY());
  expect_surface(capsule, {0, 3, -4}, 4.5, Vec3(0, 0.6, -0.8));
  expect_surface(capsule, {4, 0, 7}, 4.5, Vec3(0.8, 0, 0.6));
  EXPECT_EQ(surface(capsule, {0, 0, 1}).distance, -0.5);
  EXPECT_NEAR(surface(capsule, {0, 0, 1}).normal.z(), 0, 1e-15) << "out of its side";
  const Capsule ball{{1, 2, 3}, {1, 2, 3}, 5};
  expect_surface(ball, {1, 2, 3}, -5, Vec3::UnitY());
  expect_surface(ball, {4, 2, 7}, 0, Vec3(0.6, 0, 0.8));
  EXPECT_EQ(type_name(capsule), "capsule");
}

TEST(Motion, AlongAPathIsLinearBetweenItsKeys) {
  Motion m;
  EXPECT_TRUE(m.at_rest());
  m.path = {{1, {1, 0, 0}}, {3, {1, 4, 0}}, {4, {0, 4, 2}}};
  EXPECT_FALSE(m.at_rest());
  const auto at = [&](double t) { return m.displacement(t); };
  EXPECT_EQ(at(-5), Vec3(1, 0, 0));
  EXPECT_EQ(at(1), Vec3(1, 0, 0));
  EXPECT_EQ(at(1.5), Vec3(1, 1, 0));
  EXPECT_EQ(at(3), Vec3(1, 4, 0));
  EXPECT_EQ(at(3.25), Vec3(0.75, 4, 0.5));
  EXPECT_EQ(at(4), Vec3(0, 4, 2));
  EXPECT_EQ(at(9), Vec3(0, 4, 2));
  m.velocity = {0, 0, 10};
  EXPECT_EQ(at(1.5), Vec3(1, 1, 15));
  EXPECT_EQ(m.moved({7, 7, 7}, 1.5), Vec3(8, 8, 22));
}

// A quarter turn per second about the vertical axis through (1, 0, 0).
TEST(Motion, TurnsEveryShapeAboutItsPivot) {
  Collider c{
      .motion = {.velocity = {0, 1, 0}, .spin = {0, std::numbers::pi / 2, 0}, .pivot = {1, 0, 0}}};
  c.shape = Ball{{3, 0, 0}, 0.5};
  const auto ball = std::get<Ball>(shape_at(c, 1));
  EXPECT_LT((ball.center - Vec3(1, 1, -2)).norm(), 1e-15);
  EXPECT_EQ(ball.radius, 0.5);
  c.shape = Box{{1, 0, 2}, {1, 2, 3}};
  const auto box = std::get<Box>(shape_at(c, 1));
  EXPECT_LT((box.center - Vec3(3, 1, 0)).norm(), 1e-15);
  EXPECT_LT((box.rotation * Vec3::UnitX() + Vec3::UnitZ()).norm(), 1e-15);
  c.shape = Capsule{{3, 0, 0}, {1, 0, 2}, 0.5};
  const auto capsule = std::get<Capsule>(shape_at(c, 1));
  EXPECT_LT((capsule.from - Vec3(1, 1, -2)).norm(), 1e-15);
  EXPECT_LT((capsule.to - Vec3(3, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(capsule.radius, 0.5);
  c.shape = Plane{Vec3::UnitX(), 3};
  const auto plane = std::get<Plane>(shape_at(c, 1));
  EXPECT_LT((plane.normal + Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_NEAR(plane.offset, 2, 1e-15) << "2 m before the pivot, which lies at z = 0";
  c.shape = Plane{Vec3(0.6, 0.8, 0), 5};  // the foot of the perpendicular is (3, 4, 0)
  EXPECT_NEAR(std::get<Plane>(shape_at(c, 2)).offset, -0.6 * -1 + 0.8 * 6, 1e-14);
}

Scene everything() {
  Scene s;
  s.mesh = make_sheet({.nu = 3, .nv = 2, .width = 1, .height = 1, .mass = 1});
  s.start = {s.mesh.rest, std::vector<Vec3>(6, Vec3::Ones())};
  s.pins = {0, 2};
  s.pin_motions = {{{2}, {.velocity = {1, 0, 0}, .path = {{1, {0, 0, 1}}}}}};
  s.links = grid_links(s.mesh, {});
  s.colliders = {{.shape = Plane{}, .friction = 0.5},
                 {.shape = Ball{{1, 2, 3}, 4}},
                 {.shape = Box{{1, 2, 3}, {4, 5, 6}}},
                 {.shape = Capsule{{1, 2, 3}, {4, 5, 6}, 7}}};
  s.wind = Wind{.velocity = {1, 2, 3}, .strength = 0.5};
  s.self_collision = SelfCollision{0.25};
  s.bending = Bending{2, 1};
  s.damping = 0.5;
  s.thickness = 0.125;
  s.dt = 0.25;
  s.steps = 7;
  return s;
}

TEST(Content, DiffersWithEveryMemberButTheLabels) {
  const Scene scene = everything();
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene& s) { s.mesh.rest[1].y() += 1; },
      [](Scene& s) { std::swap(s.mesh.triangles[0][1], s.mesh.triangles[0][2]); },
      [](Scene& s) { s.mesh.mass[5] *= 2; },
      [](Scene& s) { s.mesh.grid.reset(); },
      [](Scene& s) {
        s.mesh.grid->nu = 2;
        s.mesh.grid->nv = 3;
      },
      [](Scene& s) { s.start.x[0].z() += 1; },
      [](Scene& s) { s.start.v[5].x() += 1; },
      [](Scene& s) { s.pins[1] = 1; },
      [](Scene& s) { s.pin_motions[0].vertices[0] = 0; },
      [](Scene& s) { s.pin_motions[0].motion.velocity.y() = 1; },
      [](Scene& s) { s.pin_motions[0].motion.spin.y() = 1; },
      [](Scene& s) { s.pin_motions[0].motion.pivot.y() = 1; },
      [](Scene& s) { s.pin_motions[0].motion.path[0].t = 2; },
      [](Scene& s) { s.pin_motions[0].motion.path[0].displacement.y() = 1; },
      [](Scene& s) { std::swap(s.links[0].a, s.links[0].b); },
      [](Scene& s) { s.links[0].rest *= 2; },
      [](Scene& s) { s.links[0].family = Family::bend; },
      [](Scene& s) { std::get<Plane>(s.colliders[0].shape).normal = Vec3::UnitZ(); },
      [](Scene& s) { std::get<Plane>(s.colliders[0].shape).offset = 1; },
      [](Scene& s) { s.colliders[0].friction = 1; },
      [](Scene& s) { std::get<Ball>(s.colliders[1].shape).center.z() = 1; },
      [](Scene& s) { std::get<Ball>(s.colliders[1].shape).radius = 1; },
      [](Scene& s) { s.colliders[1].motion.velocity.x() = 1; },
      [](Scene& s) { std::get<Box>(s.colliders[2].shape).center.z() = 1; },
      [](Scene& s) { std::get<Box>(s.colliders[2].shape).half_extents.z() = 1; },
      [](Scene& s) {
        std::get<Box>(s.colliders[2].shape).rotation = {0, 1, 0, 0};
      },
      [](Scene& s) { std::get<Capsule>(s.colliders[3].shape).from.z() = 1; },
      [](Scene& s) { std::get<Capsule>(s.colliders[3].shape).to.z() = 1; },
      [](Scene& s) { std::get<Capsule>(s.colliders[3].shape).radius = 1; },
      [](Scene& s) { s.colliders.pop_back(); },
      [](Scene& s) { s.wind.reset(); },
      [](Scene& s) { s.wind->velocity.x() = 5; },
      [](Scene& s) { s.wind->strength = 1; },
      [](Scene& s) { s.wind->law = Wind::Law::literal; },
      [](Scene& s) { s.self_collision.reset(); },
      [](Scene& s) { s.self_collision->radius = 1; },
      [](Scene& s) { s.stiffness[0] = 1; },
      [](Scene& s) { s.link_damping = 1; },
      [](Scene& s) { s.bending.reset(); },
      [](Scene& s) { s.bending->warp = 1; },
      [](Scene& s) { s.bending->weft = 2; },
      [](Scene& s) { s.bending->direction = Vec3::UnitX(); },
      [](Scene& s) { s.gravity.x() = 1; },
      [](Scene& s) { s.damping = 1; },
      [](Scene& s) { s.thickness = 1; },
      [](Scene& s) { s.dt = 0.5; },
      [](Scene& s) { s.steps = 8; }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Scene other = scene;
    changes[k](other);
    EXPECT_NE(content(other), content(scene)) << "change " << k;
  }
  Scene stretched = scene;
  stretched.membrane = Membrane{.warp = 1, .weft = 1, .shear = 1};
  Scene damped = stretched;
  damped.membrane->damping = 1;
  EXPECT_NE(content(damped), content(stretched));
  Scene same = scene;
  same.name = "another";
  same.summary = "words";
  same.gravity = {-0.0, -9.81, 0};
  EXPECT_EQ(content(same), content(scene)) << "-0 is 0";
}

TEST(Scene, PinsHaveNoInverseMassAndTheirPlaceIsKnown) {
  Scene s = everything();
  s.mesh.mass = {1, 2, 4, 5, 8, 10};
  EXPECT_EQ(inverse_masses(s), (std::vector<double>{0, 0.5, 0, 0.2, 0.125, 0.1}));
  EXPECT_TRUE(is_pinned(s, 2));
  EXPECT_FALSE(is_pinned(s, 1));
  s.start.x[2] = {5, 6, 7};
  EXPECT_EQ(pin_position(s, 0, 9), s.start.x[0]);
  EXPECT_EQ(pin_position(s, 2, 3), Vec3(8, 6, 8));
  EXPECT_DOUBLE_EQ(s.duration(), 1.75);
  s.mesh.rest = {{1, 1, 1}, {4, 1, 1}, {1, 5, 1}, {1, 1, 13}};
  EXPECT_DOUBLE_EQ(extent(s), 13) << "3, 4 and 12";
}

}  // namespace
}  // namespace taut::scene_test
