// Bullet simulates the same scene as our solvers: the scene is read back from Bullet's own objects
// after construction and compared with the requested one.
#include "bullet_ref/read_back.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "core/model/body_frames.hpp"
#include "tests/bullet_ref/differences.hpp"
#include "tests/support/bodies.hpp"

namespace taut::read_back_test {
namespace {

Scene sheet(int nu, int nv) {
  Scene scene;
  scene.mesh = make_sheet({.nu = nu, .nv = nv, .width = 1, .height = 1, .mass = 0.2});
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.pins = {0, nu - 1};
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

/// Scene with every feature that btSoftBody supports; no value equals Bullet's default.
Scene everything() {
  Scene scene = sheet(9, 7);
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    scene.mesh.mass[i] *= 1 + 20 * static_cast<double>(i);      // from grams to kilograms
    scene.start.x[i] = 1.1 * scene.start.x[i] + Vec3(0, 2, 0);  // stretched at the start
    scene.start.v[i] = {0.1, -0.2, 0.01 * static_cast<double>(i)};
  }
  for (Link& link : scene.links) link.rest *= 0.9;  // shorter than in the rest shape
  scene.pin_motions = {{{0}, {.velocity = {0, 0, 1}}}};
  const Vec3 tilted = Vec3(1, 2, 3).normalized();
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.7, tilted));
  scene.colliders = {
      {.shape = Plane{tilted, -0.5}},
      {.shape = Plane{-Vec3::UnitY(), -9}, .motion = {.velocity = {0, -0.1, 0}}},
      {.shape = Ball{{0.1, 0.2, 0.3}, 0.4},
       .motion = {.spin = {0, 1, 0}, .pivot = {1, 0, 0}, .path = {{0.5, {1, 2, 3}}}}},
      {.shape = Box{{-3, 0, 0.3}, {0.1, 0.2, 0.3}, turned}, .motion = {.spin = {0, 0, 2}}},
      {.shape = Capsule{{2, -0.3, 0.1}, {2.5, 0.4, 0.9}, 0.2},
       .motion = {.velocity = {0, 1, 0}, .spin = {1, 0, 2}}},
      {.shape = Capsule{{-2, 5, 0}, {-2, 4, 0}, 0.3}},
      {.shape = MeshBody{pyramid(0.3, 0.2).mesh(), {-3, 0.2, 2}, turned}},
      {.shape = MeshBody{torus(0.3, 0.1, 7, 5).mesh(), {3, 0.2, 0.7}, turned},
       .motion = {.velocity = {0, 1, 0}, .spin = {1, 0, 2}}}};
  scene.wind = Wind{.velocity = {3, 0, 1}, .strength = 0.2, .law = Wind::Law::literal};
  scene.gravity = {0.5, -3.7, 0.1};
  scene.damping = 0.3;
  scene.thickness = 0.01;
  scene.dt = static_cast<double>(1 / 60.0F);
  return scene;
}

std::unique_ptr<Solver> bullet(const Scene& scene, const std::string& text = "bullet") {
  const SolverChoice choice = parse_solver(text);
  EXPECT_EQ(choice.entry->unsupported(scene, choice.params), std::vector<std::string>{});
  auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  return solver;
}

TEST(BulletReadBack, HoldsEverythingThatTheSceneSays) {
  const Scene scene = everything();
  EXPECT_EQ(differences(scene, read_back(*bullet(scene)), 1e-13), std::vector<std::string>{});
}

TEST(BulletReadBack, SoDoesTheDeformableBody) {
  const Scene scene = everything();
  EXPECT_EQ(differences(scene, read_back(*bullet(scene, "bullet-deformable")), 1e-13),
            std::vector<std::string>{});
}

TEST(BulletReadBack, ABodyThatDeformsIsWhereItsFramesAre) {
  for (const char* text : {"bullet:substeps=2", "bullet-deformable"}) {
    Scene scene = sheet(5, 5);
    const Triangles body = torus(0.3, 0.1, 7, 5);
    auto frames = std::make_shared<BodyFrames>();
    frames->fps = 20;
    for (int k = 0; k < 4; ++k) {
      auto& x = frames->places.emplace_back(body.vertices);
      for (Vec3& p : x) p = (1 + 0.3 * k) * p + 0.2 * k * Vec3(p.y(), 1, p.x());
    }
    scene.colliders = {{.shape = MeshBody{body.mesh(), {3, 0.2, 0.7}}, .frames = frames}};
    const auto solver = bullet(scene, text);
    for (const int steps : {3, 5}) {
      for (int n = 0; n < steps; ++n) solver->step(n * scene.dt, scene.dt);
      const Scene held = read_back(*solver);
      const auto at_end = std::get<MeshBody>(shape_at(scene.colliders[0], steps * scene.dt));
      const auto& mesh = *std::get<MeshBody>(held.colliders[0].shape).mesh;
      ASSERT_EQ(mesh.vertices().size(), body.vertices.size());
      for (std::size_t i = 0; i < body.vertices.size(); ++i)
        EXPECT_NEAR((mesh.vertices()[i] - at_end.mesh->vertices()[i]).norm(), 0, 1e-6) << text;
    }
  }
}

TEST(BulletReadBack, WithoutFacesItHoldsAllElse) {
  const Scene scene = everything();
  Scene held = read_back(*bullet(scene, "bullet:faces=off"));
  EXPECT_EQ(held.mesh.triangles.size(), 0u);
  held.mesh.triangles = scene.mesh.triangles;
  EXPECT_EQ(differences(scene, held, 1e-13), std::vector<std::string>{});
}

/// Links of each vertex, in order.
std::vector<std::vector<std::array<int, 2>>> links_of_vertices(const Scene& scene) {
  std::vector<std::vector<std::array<int, 2>>> lists(scene.mesh.rest.size());
  for (const Link& link : scene.links)
    for (const int end : {link.a, link.b})
      lists[static_cast<std::size_t>(end)].push_back({link.a, link.b});
  return lists;
}

int waiting(const Scene& scene) {
  int count = 0;
  for (std::size_t i = 1; i < scene.links.size(); ++i) {
    const Link &p = scene.links[i - 1], &q = scene.links[i];
    count += q.a == p.a || q.a == p.b || q.b == p.a || q.b == p.b;
  }
  return count;
}

TEST(BulletReadBack, ReorderedItHoldsTheSameLinksAtEveryVertex) {
  const Scene scene = everything();
  const auto solver = bullet(scene, "bullet:reorder=on");
  Scene held = read_back(*solver);
  EXPECT_EQ(links_of_vertices(held), links_of_vertices(scene));
  EXPECT_LT(waiting(held), waiting(scene) / 10);
  const SolverChoice choice = parse_solver("bullet:reorder=on");
  const ResolvedSettings settings = choice.entry->resolved_settings(scene, choice.params);
  const std::string said = find_setting(settings, "links that wait")->text;
  EXPECT_TRUE(said.starts_with(std::to_string(waiting(held)) + " of ")) << said;
  EXPECT_EQ(find_setting(settings, kLinkOrder)->token, "reordered");
  EXPECT_NE(said.find("(" + std::to_string(waiting(scene)) + " in the"), std::string::npos) << said;
  std::vector<std::string> passes;
  for (const PassCost& cost : solver->step_cost()) passes.push_back(cost.pass);
  EXPECT_EQ(std::ranges::count(passes, "links, reordered"), 1);
  const auto by_ends = [](const Link& p, const Link& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  };
  Scene sorted = scene;
  std::ranges::sort(sorted.links, by_ends);
  std::ranges::sort(held.links, by_ends);
  EXPECT_EQ(differences(sorted, held, 1e-13), std::vector<std::string>{});
}

TEST(BulletReadBack, SubstepsChangeTheTimeStepByRoundingToBinary32) {
  const Scene scene = everything();
  const auto solver = bullet(scene, "bullet:substeps=7");
  EXPECT_NE(differences(scene, read_back(*solver), 1e-13), std::vector<std::string>{});
  EXPECT_EQ(differences(scene, read_back(*solver), 6e-8), std::vector<std::string>{});
}

TEST(BulletReadBack, StillHoldsTheMaterialAfterAHundredSteps) {
  Scene scene = everything();
  const auto solver = bullet(scene);
  for (int n = 0; n < 100; ++n) solver->step(n * scene.dt, scene.dt);
  solver->load(scene.start);
  solver->step(0, scene.dt);
  Scene held = read_back(*solver);
  held.start = scene.start;          // has changed during the steps
  held.colliders = scene.colliders;  // have moved as well
  EXPECT_EQ(differences(scene, held, 1e-13), std::vector<std::string>{});
}

TEST(BulletReadBack, ComparisonSeesEveryMember) {
  const Scene scene = everything();
  const auto changed = [&](auto change) {
    Scene other = scene;
    change(other);
    return differences(scene, other, 1e-9).size();
  };
  EXPECT_EQ(changed([](Scene&) {}), 0u);
  EXPECT_EQ(changed([](Scene& s) { s.mesh.rest[3].x() += 1e-6; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { std::swap(s.mesh.triangles[0][0], s.mesh.triangles[0][1]); }),
            1u);
  EXPECT_EQ(changed([](Scene& s) { s.mesh.mass[3] *= 1.001; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.start.x[3].y() += 1e-6; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.start.v[3].z() += 1e-3; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.pins.pop_back(); }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.pin_motions.clear(); }), 1u);
  EXPECT_EQ(changed([](Scene& s) { std::swap(s.links[0].a, s.links[0].b); }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.links[5].rest *= 1.001; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.links[5].family = Family::bend; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { std::get<Plane>(s.colliders[0].shape).offset += 1e-6; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { std::get<Ball>(s.colliders[2].shape).radius += 1e-6; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { std::get<Box>(s.colliders[3].shape).rotation.setIdentity(); }),
            1u);
  EXPECT_EQ(changed([](Scene& s) { s.colliders[2].motion.path.clear(); }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.colliders[1].friction = 1; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.wind->law = Wind::Law::relative; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.self_collision = SelfCollision{0.01}; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.gravity.x() = 0; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.damping = 0; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.thickness = 0; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.dt = 1 / 61.0; }), 1u);
  EXPECT_EQ(changed([](Scene& s) { s.steps = 1; }), 1u);
}

}  // namespace
}  // namespace taut::read_back_test
