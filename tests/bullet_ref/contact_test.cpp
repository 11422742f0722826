// btSoftBody against rigid colliders. Every collider is at the scene's place at every time, and
// cloth keeps the distance of Bullet's contact rule: thickness + g h^2 on a plane.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "bullet_ref/read_back.hpp"
#include "bullet_ref/rigid_colliders.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/solver.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"

namespace taut::bullet_ref_contact_test {
namespace {

constexpr double kThickness = 0.02;  // m

/// Sheet of half a metre on (or just above) a collider's top, spanned by u and v.
Scene sheet_above(const Collider& collider, const Vec3& middle, const Vec3& u, const Vec3& v) {
  Scene scene;
  scene.mesh = make_sheet({.nu = 11,
                           .nv = 11,
                           .width = 0.5,
                           .height = 0.5,
                           .origin = middle - 0.25 * (u + v),
                           .u = u,
                           .v = v,
                           .mass = 0.2});
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.colliders = {collider};
  scene.thickness = kThickness;
  scene.dt = static_cast<double>(1 / 60.0F);
  scene.steps = 180;
  return scene;
}

struct Range {
  double least, most;  ///< m, over all vertices
};

Range distances(const Solver& solver, const Scene& scene, double t) {
  State state;
  solver.store(state);
  Range range{1e9, -1e9};
  for (const Vec3& x : state.x) {
    const double d = surface(shape_at(scene.colliders[0], t), x).distance;
    range = {std::min(range.least, d), std::max(range.most, d)};
  }
  return range;
}

/// Range of distances from the surface at the end of the scene.
Range settle(const Scene& scene, const std::string& text) {
  const SolverChoice choice = parse_solver(text);
  EXPECT_EQ(choice.entry->unsupported(scene, choice.params), std::vector<std::string>{});
  const auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  for (int n = 0; n < scene.steps; ++n) solver->step(n * scene.dt, scene.dt);
  return distances(*solver, scene, scene.duration());
}

/// Axes of a plane: horizontal, and down the slope.
std::pair<Vec3, Vec3> axes(const Vec3& normal) {
  const Vec3 level = normal.cross(Vec3::UnitY()).normalized();
  return {level, normal.cross(level)};
}

TEST(BulletContact, ClothRestsAtThicknessPlusTheFallOfOneStep) {
  Scene scene =
      sheet_above({.shape = Plane{Vec3::UnitY(), 0.3}}, {0, 0.33, 0}, Vec3::UnitX(), Vec3::UnitZ());
  scene.steps = 600;
  for (const char* order : {"contacts-first", "links-first"})
    for (const int substeps : {1, 3}) {
      const double h = scene.dt / substeps;
      const Range d = settle(scene, std::string("bullet:iterations=10,order=") + order +
                                        ",substeps=" + std::to_string(substeps));
      EXPECT_NEAR(d.least, kThickness + 9.81 * h * h, 1e-5) << order << substeps;
      EXPECT_NEAR(d.most, kThickness + 9.81 * h * h, 1e-5) << order << substeps;
    }
}

/// The law in bullet_ref/README.md for a single vertex on a slope [rad], implemented independently.
/// State: distances moved in one substep along the slope and out of it, and the height above the
/// distance at which contact begins.
struct LawOfFriction {
  double slope, mu, hardness;
  int passes;
  double h;  ///< s
  double height = 0, along = 0;
  double way_out = 0, way_along = 0;  ///< in the last substep [m]
  void substep() {
    way_out -= 9.81 * std::cos(slope) * h * h;
    way_along += 9.81 * std::sin(slope) * h * h;
    const double depth = -(height + way_out);
    if (depth > 0) {
      const double kept = std::abs(way_along) < mu * std::abs(way_out) ? 0 : 1 - mu;
      for (int pass = 0; pass < passes && way_out <= 1e-16; ++pass) {
        way_along *= kept;
        way_out = -hardness * (height + way_out);
      }
    }
    height += way_out;
    along += way_along;
  }
};

/// Distance that the middle of a sheet slides down a slope in one second [m].
double slide(double slope, double mu, const std::string& bullet, double start_height,
             Range* range) {
  const Vec3 normal(std::sin(slope), std::cos(slope), 0);
  const auto [u, v] = axes(normal);
  const Vec3 start = (kThickness + start_height) * normal;
  Scene scene = sheet_above({.shape = Plane{normal, 0}, .friction = mu}, start, u, v);
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  const SolverChoice choice = parse_solver(bullet);
  const auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  for (int n = 0; n < scene.steps; ++n) solver->step(n * scene.dt, scene.dt);
  State state;
  solver->store(state);
  if (range) *range = distances(*solver, scene, scene.duration());
  return (state.x[60] - scene.start.x[60]).dot(Vec3(std::cos(slope), -std::sin(slope), 0));
}

TEST(BulletFriction, IsTheLawThatTheReadmeStates) {
  const double slope = 17 * std::numbers::pi / 180, h = 1.0 / 64;
  for (const double mu : {0.0, 0.1, 0.3, 0.32, 0.335, 0.345, 0.35, 0.7, 1.0})
    for (const double hardness : {0.05, 0.1, 0.3, 1.0})
      for (const int passes : {1, 3}) {
        // Avoids ties, which rounding decides: from height 0 a hard contact lands on the surface.
        // Softer ones come to rest just touching it, but not within 64 steps.
        const double start = hardness == 0.1 ? 0 : 0.3 * 9.81 * h * h;
        LawOfFriction law{slope, mu, hardness, passes, h, start};
        for (int n = 0; n < 64; ++n) law.substep();
        const std::string bullet =
            "bullet:hardness=" + std::to_string(hardness) + ",iterations=" + std::to_string(passes);
        EXPECT_NEAR(slide(slope, mu, bullet, start, nullptr), law.along, 1e-8)
            << bullet << ", mu " << mu;
      }
}

// tan(17 degrees) = 0.306. Coulomb's law holds the sheet from this friction on. Bullet's law does
// so from tan/(1 - hardness) = 0.3397 on if the sheet lies at the distance at which contact begins.
TEST(BulletFriction, HoldsAboveATangentThatHardnessRaises) {
  const double slope = 17 * std::numbers::pi / 180;
  const double threshold = std::tan(slope) / (1 - 0.1);
  EXPECT_GT(slide(slope, 0.99 * threshold, "bullet", 0, nullptr), 0.05);
  Range d{};
  EXPECT_NEAR(slide(slope, 1.01 * threshold, "bullet", 0, &d), 0, 1e-9);
  const double rest = kThickness + 9.81 * std::cos(slope) / 64 / 64;
  EXPECT_NEAR(d.least, rest, 1e-5);
  EXPECT_NEAR(d.most, rest, 1e-5);
  EXPECT_GT(slide(slope, 1, "bullet:hardness=1", 0.001, nullptr), 0.05) << "it hops down";
}

TEST(BulletContact, AMovingPlaneCarriesTheCloth) {
  Scene scene = sheet_above(
      {.shape = Plane{Vec3::UnitY(), 0}, .motion = {.velocity = {0, 0.4, 0}}, .friction = 1},
      {0, 0.03, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const Range d = settle(scene, "bullet:iterations=10");
  EXPECT_GT(d.least, kThickness);
  EXPECT_LT(d.most, kThickness + 2 * 9.81 * scene.dt * scene.dt);
}

// Friction acts on the relative velocity: with mu = 1 it removes all slip.
TEST(BulletContact, AFloorThatRunsTakesTheClothAlong) {
  const Vec3 runs(0.3, 0, -0.2);
  const Scene scene =
      sheet_above({.shape = Plane{Vec3::UnitY(), 0}, .motion = {.velocity = runs}, .friction = 1},
                  {0, kThickness, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const SolverChoice choice = parse_solver("bullet:iterations=10");
  const auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  for (int n = 0; n < scene.steps; ++n) solver->step(n * scene.dt, scene.dt);
  State state;
  solver->store(state);
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    EXPECT_LT((state.v[i] - runs).norm(), 0.01) << i;
    EXPECT_LT((state.x[i] - scene.start.x[i] - scene.duration() * runs).norm(), 0.02) << i;
  }
}

TEST(BulletContact, ATiltingFloorStaysUnderTheCloth) {
  Scene scene = sheet_above({.shape = Plane{Vec3::UnitY(), 0},
                             .motion = {.spin = {0, 0, 0.1}, .pivot = {-2, 0, 0}},
                             .friction = 1},
                            {0, 0.03, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const Range d = settle(scene, "bullet:iterations=10");
  EXPECT_GT(d.least, kThickness - 1e-3);
  EXPECT_LT(d.most, kThickness + 2 * 9.81 * scene.dt * scene.dt);
}

TEST(BulletContact, OnAThinBoxTheClothRestsAsOnAPlane) {
  const Scene scene = sheet_above({.shape = Box{{0, 0, 0}, {0.4, 0.03, 0.4}}, .friction = 1},
                                  {0, 0.06, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const Range d = settle(scene, "bullet:iterations=10");
  EXPECT_NEAR(d.least, kThickness + 9.81 * scene.dt * scene.dt, 1e-4);
  EXPECT_NEAR(d.most, kThickness + 9.81 * scene.dt * scene.dt, 1e-4);
}

/// Two bodies as one: vertices and triangles of the second follow those of the first.
Triangles both(Triangles one, const Triangles& other) {
  const auto first = static_cast<int>(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles)
    one.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return one;
}

TEST(BulletContact, OnAConvexBodyOfTrianglesItRestsAsOnTheBox) {
  const Triangles box = box_of_triangles({0.4, 0.03, 0.4});
  Triangles apart = box;
  for (Vec3& x : apart.vertices) x.x() += 3;
  const double above = kThickness + 9.81 / 64 / 64;
  const auto rests = [](const char* text, const MeshBody& body) {
    Scene scene =
        sheet_above({.shape = body, .friction = 1}, {0, 0.16, 0}, Vec3::UnitX(), Vec3::UnitZ());
    scene.steps = 128;
    return settle(scene, text);
  };
  for (const char* text : {"bullet:iterations=10", "bullet-deformable:newton=4"}) {
    const Range convex = rests(text, {box.mesh()});
    EXPECT_NEAR(convex.least, above, 3e-3) << text;
    EXPECT_NEAR(convex.most, above, 3e-3) << text;
  }
  // it rests 0.06 m higher; with substeps, also by the margin, which a substep's fall does not
  // cross
  for (const MeshBody& other : {MeshBody{both(box, apart).mesh()},
                                MeshBody{.mesh = box.mesh(), .sides = MeshBody::Sides::both}}) {
    EXPECT_TRUE(is_met_by_triangles({.shape = other}));
    EXPECT_NEAR(rests("bullet:iterations=10", other).least, above + 0.06, 0.005);
    const double in_substeps = rests("bullet:substeps=15", other).least - kThickness;
    EXPECT_GT(in_substeps, 0.08);
    EXPECT_LT(in_substeps, 0.101);
  }
  const Collider ring{.shape = MeshBody{torus(0.3, 0.1, 7, 5).mesh()}};
  EXPECT_TRUE(is_met_by_triangles(ring));
  const SolverChoice choice = parse_solver("bullet");
  const ResolvedSettings settings = choice.entry->resolved_settings(
      sheet_above(ring, Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitZ()), choice.params);
  EXPECT_EQ(find_setting(settings, "body of triangles")->text,
            "each triangle a hull 0.06 m thick on both of its sides "
            "(BT_SOFTBODY_TRIANGLE_EXTRUSION), and a margin of 0.04 m around it: cloth rests 0.06 "
            "to 0.1 m above");
  EXPECT_FALSE(is_met_by_triangles({.shape = MeshBody{ball_of_triangles(1, 2).mesh()}}));
  EXPECT_FALSE(is_met_by_triangles({.shape = Ball{}}));
}

// Across its axis a capsule acts like a ball; along the axis its top is level.
TEST(BulletContact, AFinerDistanceFieldLetsClothSinkLess) {
  const Scene scene = sheet_above({.shape = Capsule{{0, 0, -0.5}, {0, 0, 0.5}, 0.3}, .friction = 1},
                                  {0, 0.33, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const double coarse = settle(scene, "bullet:iterations=10,voxel=0.25").least;
  const double fine = settle(scene, "bullet:iterations=10,voxel=0.05").least;
  EXPECT_LT(coarse, fine - 0.01);
  EXPECT_GT(fine, 0);
}

TEST(BulletContact, AFinerDistanceFieldLetsTheClothLessIntoABall) {
  const Scene scene = sheet_above({.shape = Ball{{0, 0, 0}, 0.3}, .friction = 1}, {0, 0.33, 0},
                                  Vec3::UnitX(), Vec3::UnitZ());
  const double coarse = settle(scene, "bullet:iterations=10,voxel=0.25").least;
  const double fine = settle(scene, "bullet:iterations=10,voxel=0.05").least;
  EXPECT_LT(coarse, fine - 0.01);
  EXPECT_GT(fine, 0);
}

enum class Moves { as_a_whole, by_frames, by_frames_that_deform };

/// Scene of a box that moves for a second. What deforms is its lower side, which grows.
Scene on_a_box(const Vec3& velocity, Moves how, MeshBody::Sides sides = MeshBody::Sides::both) {
  const Triangles box = box_of_triangles({2, 0.2, 2});
  Collider body{.shape = MeshBody{.mesh = box.mesh(), .center = {0, -0.2, 0}, .sides = sides},
                .friction = 1};
  if (how == Moves::as_a_whole) {
    body.motion.velocity = velocity;
  } else {
    auto frames = std::make_shared<BodyFrames>();
    frames->fps = 1;
    frames->places = {box.vertices, box.vertices};
    for (Vec3& x : frames->places[1]) {
      if (how == Moves::by_frames_that_deform && x.y() < 0) x.y() -= 0.05;
      x += velocity;
    }
    body.frames = frames;
  }
  const double height = sides == MeshBody::Sides::both ? 0.08 : 0.01;
  return sheet_above(body, {0, height, 0}, Vec3::UnitX(), Vec3::UnitZ());
}

Vec3 middle_after_a_second(const Scene& scene, const std::string& solver) {
  const State state = simulate(scene, solver, 60);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : state.x) sum += x;
  return sum / static_cast<double>(state.x.size());
}

// Bullet's own contact does not know about motion by frames: it would not carry the cloth along,
// and at 0.3 m/s upwards the body would pass through it.
TEST(BulletContact, ABodyThatFramesDeformCarriesAndLiftsAsOneThatMovesAsAWhole) {
  for (const char* solver :
       {"bullet:iterations=10", "bullet-deformable:implicit=false,substeps=70"})
    for (const Vec3& velocity : {Vec3(0, 0.1, 0), Vec3(0, 0.5, 0), Vec3(0.4, 0, 0.2)}) {
      constexpr Moves kDeforms = Moves::by_frames_that_deform;
      const Vec3 whole = middle_after_a_second(on_a_box(velocity, Moves::as_a_whole), solver),
                 frames = middle_after_a_second(on_a_box(velocity, kDeforms), solver),
                 still = middle_after_a_second(on_a_box(Vec3::Zero(), kDeforms), solver);
      EXPECT_LT((frames - whole).norm(), 0.006) << solver << ' ' << velocity.transpose();
      EXPECT_GT((whole - still).norm(), 0.7 * velocity.norm()) << solver;
    }
}

// 6 m/s is 0.1 m a step: by triangles, whose hulls are 0.1 m thick, the cloth would be thrown.
TEST(BulletContact, ABodyThatFramesOnlyMoveIsARigidOne) {
  for (const MeshBody::Sides sides : {MeshBody::Sides::out, MeshBody::Sides::both})
    for (const Vec3& velocity : {Vec3(0, 6, 0), Vec3(0.4, 0.5, 0.2)}) {
      const Scene whole = on_a_box(velocity, Moves::as_a_whole, sides),
                  frames = on_a_box(velocity, Moves::by_frames, sides);
      for (const char* solver : {"bullet", "bullet-deformable:implicit=false,substeps=70"})
        EXPECT_LT(largest_distance(simulate(frames, solver, 20).x, simulate(whole, solver, 20).x),
                  1e-6)
            << solver << ' ' << velocity.transpose();
      EXPECT_EQ(is_met_by_triangles(frames.colliders[0]), sides == MeshBody::Sides::both);
      EXPECT_FALSE(deforms(frames.colliders[0]));
    }
  EXPECT_TRUE(deforms(on_a_box({0, 6, 0}, Moves::by_frames_that_deform).colliders[0]));
  // A turn of 0.1 rad a frame: between frames, straight ways are 0.05^2/2 of the radius too short.
  Scene turns = on_a_box(Vec3::Zero(), Moves::as_a_whole, MeshBody::Sides::out), frames = turns;
  turns.colliders[0].motion = {.spin = {0, 1, 0}, .pivot = {0.3, 0, 0}};
  auto turning = std::make_shared<BodyFrames>();
  turning->fps = 10;
  const MeshBody& body = std::get<MeshBody>(turns.colliders[0].shape);
  for (int k = 0; k < 12; ++k) {
    auto& places = turning->places.emplace_back();
    for (const Vec3& x : body.mesh->vertices())
      places.push_back(turns.colliders[0].motion.moved(body.center + x, k / 10.0) - body.center);
  }
  frames.colliders[0].frames = turning;
  EXPECT_FALSE(deforms(frames.colliders[0]));
  EXPECT_LT(largest_distance(simulate(frames, "bullet", 60).x, simulate(turns, "bullet", 60).x),
            2e-3);
  const SolverChoice choice = parse_solver("bullet");
  const auto solver = choice.entry->make(frames, choice.params);
  solver->load(frames.start);
  const MeshBody read = std::get<MeshBody>(read_back(*solver).colliders[0].shape);
  EXPECT_LT((read.center - body.center).norm(), 1e-12);
  EXPECT_LT(read.rotation.angularDistance(body.rotation), 1e-7);
}

TEST(BulletContact, RestartingGivesTheSameBits) {
  // A moving ball in contact: with the collider's old place its velocity would be wrong.
  const Scene scene =
      sheet_above({.shape = Ball{{0, 0, 0}, 0.3}, .motion = {.velocity = {0, 0.5, 0.5}}},
                  {0, 0.31, 0}, Vec3::UnitX(), Vec3::UnitZ());
  const SolverChoice choice = parse_solver("bullet");
  const auto solver = choice.entry->make(scene, choice.params);
  State first, second;
  for (State* state : {&first, &second}) {
    solver->load(scene.start);
    for (int n = 0; n < 60; ++n) solver->step(n * scene.dt, scene.dt);
    solver->store(*state);
  }
  EXPECT_EQ(first.x, second.x);
  EXPECT_EQ(first.v, second.v);
}

TEST(BulletLimits, SaysWhatItWouldMisread) {
  Scene scene = sheet_above({.shape = Ball{{0, 0, 0}, 0.3}, .friction = 0.5}, {0, 0.33, 0},
                            Vec3::UnitX(), Vec3::UnitZ());
  const auto reasons = [&](const char* text) {
    const SolverChoice choice = parse_solver(text);
    return choice.entry->unsupported(scene, choice.params).size();
  };
  EXPECT_EQ(reasons("bullet"), 0u);
  EXPECT_EQ(reasons("bullet:friction=refuse"), 1u);
  scene.colliders[0].friction = 1.5;
  EXPECT_EQ(reasons("bullet"), 1u);
  scene.colliders.clear();
  scene.self_collision = SelfCollision{0.01};
  EXPECT_EQ(reasons("bullet"), 1u);
  scene.self_collision.reset();
  scene.damping = 1;
  EXPECT_EQ(reasons("bullet:iterations=0"), 1u);
}

}  // namespace
}  // namespace taut::bullet_ref_contact_test
