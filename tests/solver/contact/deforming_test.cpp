// Deforming bodies under cloth, in each of our solvers and with every response: frames of a rigid
// motion reproduce that motion, friction acts against the surface at the contact point, and nothing
// passes through.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/model/body_frames.hpp"
#include "core/model/solver.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"
#include "tests/support/settings.hpp"

namespace taut::deforming_contact_test {
namespace {

constexpr int kQuarterSecond = 16;

/// The same motion as frames, one frame per substep for 1 to 64 substeps a step.
Collider as_frames(Collider collider, double fps, int frames) {
  auto& body = std::get<MeshBody>(collider.shape);
  const Motion motion = std::exchange(collider.motion, {});
  auto over_time = std::make_shared<BodyFrames>();
  over_time->fps = fps;
  for (int k = 0; k < frames; ++k) {
    auto& places = over_time->places.emplace_back();
    for (const Vec3& x : body.mesh->vertices()) {
      const Vec3 moved = motion.moved(body.center + body.rotation * x, k / fps);
      places.push_back(body.rotation.conjugate() * (moved - body.center));
    }
  }
  body.mesh = std::make_shared<TriangleMesh>(over_time->places[0], body.mesh->triangles());
  collider.frames = over_time;
  return collider;
}

const Triangles kTorus = torus(0.3, 0.12, 8, 6);

TEST(DeformingContact, FramesOfAPathAreThatPathInEverySolver) {
  for (const std::string& solver : our_solvers()) {
    Scene scene = sheet_above(0.2);
    scene.colliders = {{.shape = MeshBody{kTorus.mesh(), {0.02, 0.05, 0.01}},
                        .motion = {.velocity = {0.3, 0.5, -0.2}},
                        .friction = 0.3}};
    const State want = simulate(scene, solver, kQuarterSecond);
    scene.colliders[0] = as_frames(scene.colliders[0], 64, 20);
    EXPECT_LE(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), 1e-9) << solver;
    scene.colliders[0].friction = 0;
    EXPECT_GT(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), 1e-3) << solver;
  }
}

TEST(DeformingContact, FramesOfATurnAreThatTurnInEverySolver) {
  for (const std::string& solver : our_solvers()) {
    Scene scene = sheet_above(0.2);
    scene.colliders = {{.shape = MeshBody{kTorus.mesh(), {0.02, 0.05, 0.01}},
                        .motion = {.velocity = {0.1, 0.5, 0}, .spin = {0.3, 1, 2}},
                        .friction = 0.3}};
    const State want = simulate(scene, solver, kQuarterSecond);
    constexpr int kFps = 64 * 960;
    scene.colliders[0] = as_frames(scene.colliders[0], kFps, kFps / 4 + 1);
    EXPECT_LE(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), 1e-9) << solver;
  }
}

TEST(DeformingContact, AndInEveryResponse) {
  for (const char* response : {"continuous", "discrete", "before", "after", "freeze", "halt"}) {
    const std::string solver = listing("precision=double,contact=" + std::string(response));
    Scene scene = sheet_above(0.2);
    scene.colliders = {{.shape = MeshBody{kTorus.mesh(), {0.02, 0.05, 0.01}},
                        .motion = {.velocity = {0.1, 0.5, 0}, .spin = {0.3, 1, 2}},
                        .friction = 0.3}};
    const State want = simulate(scene, solver, kQuarterSecond);
    scene.colliders[0] = as_frames(scene.colliders[0], 64, 17);
    EXPECT_LE(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), 1e-9)
        << response;
  }
}

/// Our solvers but vbd and avbd, which refuse `faces`.
std::vector<std::string> solvers_with_faces() {
  std::vector<std::string> all = our_solvers();
  std::erase_if(all, [](const std::string& s) { return solver_name(s).ends_with("vbd"); });
  return all;
}

/// One face that falls on the tip of a pyramid. (Whole sheets with faces=on would test nothing:
/// rounding decides which of two edges is deeper, and 1e-15 m become 1 cm in ten steps.)
Scene face_above_a_tip(const Motion& motion) {
  Scene scene;
  scene.mesh.rest = {{-0.4, 0.32, -0.3}, {0.5, 0.32, -0.2}, {0.05, 0.32, 0.4}};
  scene.mesh.triangles = {{0, 2, 1}};
  scene.mesh.mass = {0.1, 0.11, 0.12};
  scene.start = {scene.mesh.rest, std::vector<Vec3>(3, Vec3(0.1, -1, 0.05))};
  for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}})
    scene.links.push_back(
        {a, b, (scene.mesh.rest[to_index(a)] - scene.mesh.rest[to_index(b)]).norm()});
  scene.thickness = 0.005;
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  scene.colliders = {{.shape = MeshBody{pyramid(0.7, 0.3).mesh(), {0.023, 0, 0.011}},
                      .motion = motion,
                      .friction = 0.6}};
  return scene;
}

TEST(DeformingContact, AndForFaces) {
  for (const std::string& plain : solvers_with_faces())
    for (const double spin : {0.0, 1.0}) {
      const std::string solver = with(plain, "faces=on");
      Scene scene = face_above_a_tip({.velocity = {0.3, 0.2, 0}, .spin = {0, spin, 0}});
      const State want = simulate(scene, solver, kQuarterSecond);
      scene.colliders[0].friction = 0;
      EXPECT_GT(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), 1e-3)
          << solver;
      scene.colliders[0].friction = 0.6;
      constexpr int kFps = 64 * 960;
      scene.colliders[0] = as_frames(scene.colliders[0], kFps, kFps / 4 + 1);
      // Newton's iterations end at 1e-9 of the forces
      const double within = plain.starts_with("implicit") ? 1e-8 : 1e-9;
      EXPECT_LE(largest_distance(simulate(scene, solver, kQuarterSecond).x, want.x), within)
          << solver << ' ' << spin;
    }
}

/// Wall of many triangles; one side moves twice as fast as the other.
Collider wall(double speed, double friction) {
  Triangles sheet;
  constexpr int kSide = 9;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      sheet.vertices.emplace_back(0.5 * i - 2, 0, 0.5 * j - 2);
      if (i + 1 == kSide || j + 1 == kSide) continue;
      const int a = j * kSide + i;
      sheet.triangles.push_back({a, a + kSide, a + 1});
      sheet.triangles.push_back({a + 1, a + kSide, a + kSide + 1});
    }
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 64;
  for (int k = 0; k < 9; ++k) {
    auto& x = frames->places.emplace_back(sheet.vertices);
    for (Vec3& p : x) p.y() = speed * (1 + (p.x() + 2) / 4) * k / 64.0;
  }
  return {.shape = MeshBody{.mesh = sheet.mesh(), .sides = MeshBody::Sides::both},
          .friction = friction,
          .frames = frames};
}

// The wall travels half a metre in a step, as far as its triangles are long; the thickness is 5 mm.
TEST(DeformingContact, NothingPassesAThinBodyThatComesFromEitherSide) {
  for (const std::string& solver : our_solvers())
    for (const double side : {-1.0, 1.0}) {
      Scene scene = sheet_above(side * 0.3);
      for (Vec3& v : scene.start.v) v.setZero();
      scene.gravity.setZero();
      scene.colliders = {wall(side * 16, 0)};
      const State state = simulate(scene, solver, 4);
      const Shape at_end = shape_at(scene.colliders[0], 4 / 64.0);
      const auto& mesh = *std::get<MeshBody>(at_end).mesh;
      for (const Vec3& x : state.x)
        EXPECT_GE(side * mesh.nearest(x).distance, 0.005 - 1e-4) << solver << ' ' << side;
    }
}

TEST(DeformingContact, WhatIsPutOutOfOneWallOfAGrooveStaysAboveTheOther) {
  for (const std::string& solver : our_solvers()) {
    Scene scene = sheet_above(kGrooves + 0.1);
    for (Vec3& v : scene.start.v) v = {0.3, -20, 0};
    Collider grooves{.shape =
                         MeshBody{.mesh = grooved_sheet().mesh(), .sides = MeshBody::Sides::both}};
    scene.colliders = {as_frames(grooves, 64, 18)};
    EXPECT_EQ(below_grooves(simulate(scene, solver, kQuarterSecond)), 0) << solver;
  }
}

/// Height of the thread above x = 0 [m].
double height_over_origin(const State& state) {
  double highest = -1e9;
  for (std::size_t i = 1; i < state.x.size(); ++i) {
    const Vec3 &a = state.x[i - 1], &b = state.x[i];
    if ((a.x() <= 0) == (b.x() <= 0)) continue;
    highest = std::max(highest, a.y() - a.x() / (b.x() - a.x()) * (b.y() - a.y()));
  }
  return highest;
}

// The rod rises four times its own height in a step, between two vertices, and tilts as it rises.
TEST(DeformingContact, NoEdgeOfAThreadPassesARodThatItsFramesRaise) {
  Scene scene;
  constexpr int kVertices = 12, kSteps = 12;
  for (int i = 0; i < kVertices; ++i) {
    scene.mesh.rest.emplace_back(0.03 * (i - 5.6), 0.01, 0);
    scene.mesh.mass.push_back(1e-3);
    if (i > 0) scene.links.push_back({i - 1, i, 0.03});
  }
  scene.start = {scene.mesh.rest, std::vector<Vec3>(kVertices, Vec3::Zero())};
  scene.gravity.setZero();
  scene.damping = 2;
  scene.thickness = 0.001;
  scene.dt = 1.0 / 64;
  scene.steps = kSteps;
  const Triangles rod = box_of_triangles({0.002, 0.002, 0.3});
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 64;
  for (int k = 0; k <= kSteps; ++k) {
    auto& x = frames->places.emplace_back(rod.vertices);
    for (Vec3& p : x) p.y() += k / 64.0 * (1 + p.z());
  }
  scene.colliders = {{.shape = MeshBody{rod.mesh()}, .friction = 1, .frames = frames}};
  int discrete = 0;
  for (const std::string& solver : solvers_with_faces()) {
    const auto left_behind = [&](const std::string& settings) {
      const State end = simulate(scene, with(solver, settings), kSteps);
      return height_over_origin(end) < kSteps / 64.0;
    };
    EXPECT_TRUE(left_behind("faces=off")) << solver;
    discrete += left_behind("faces=edges,contact=discrete");
    EXPECT_FALSE(left_behind("faces=edges")) << solver;
  }
  EXPECT_GE(discrete, 4) << "all but those of many substeps";
}

// A belt whose points move at different speeds carries each vertex that cannot slip at the speed of
// the point under it.
TEST(DeformingContact, FrictionIsAgainstTheSurfaceWhereItTouches) {
  for (const std::string& solver : our_solvers()) {
    Scene scene = sheet_above(0.005);
    scene.links.clear();  // each vertex moves independently
    for (Vec3& v : scene.start.v) v.setZero();
    Collider belt = wall(0, 50);
    auto frames = std::make_shared<BodyFrames>();
    frames->fps = 64;
    const auto speed = [](const Vec3& p) { return Vec3(0.2 + 0.1 * p.x(), 0, 0.05 * p.z()); };
    for (int k = 0; k < 40; ++k) {
      auto& x = frames->places.emplace_back(std::get<MeshBody>(belt.shape).mesh->vertices());
      for (Vec3& p : x) p += k / 64.0 * speed(p);
    }
    belt.frames = frames;
    scene.colliders = {belt};
    const State state = simulate(scene, solver, kQuarterSecond);
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 way = state.x[i] - scene.start.x[i];
      EXPECT_NEAR((way - 0.25 * speed(scene.start.x[i])).norm(), 0, 2e-3) << solver << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace taut::deforming_contact_test
