// Bodies of triangles under cloth, in each of our solvers and with every response: triangles must
// reproduce a box, a plane or a moving frame that is known in closed form.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/solver.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"
#include "tests/support/settings.hpp"

namespace taut::body_contact_test {
namespace {

constexpr int kQuarterSecond = 16;

double apart(const State& a, const State& b) { return largest_distance(a.x, b.x); }

Motion tumbling(const Vec3& pivot) {
  return {.velocity = {0.1, 0.5, 0}, .spin = {0.3, 1, 2}, .pivot = pivot};
}

const Vec3 kHalf(0.3, 0.2, 0.25);

/// Largest distance between motions on the same box whose starts differ by a rounding error [m]. It
/// measures solvers whose iterations have not converged: there rounding decides which vertices
/// touch.
double spread(const Scene& scene, const std::string& solver, const State& want) {
  double most = 0;
  for (int n = 1; n <= 8; ++n) {
    Scene moved = scene;
    for (std::size_t i = 0; i < moved.start.x.size(); ++i)
      moved.start.x[i].y() += 1e-15 * std::sin(static_cast<double>(i) * n);
    most = std::max(most, apart(simulate(moved, solver, kQuarterSecond), want));
  }
  return most;
}

TEST(BodyContact, ABoxOfTrianglesIsTheBoxInEverySolver) {
  Scene scene = sheet_above(0.26);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.2, Vec3(1, 2, 3).normalized()));
  for (const bool moves : {false, true})
    for (const std::string& solver : our_solvers()) {
      const Motion motion = moves ? tumbling({0.1, 0, 0}) : Motion{};
      scene.colliders = {{Box{{0, 0.02, 0}, kHalf, turned}, motion, 0.4}};
      const State want = simulate(scene, solver, kQuarterSecond);
      const double within = solver.starts_with("implicit") ? 2 * spread(scene, solver, want) : 0;
      scene.colliders = {
          {MeshBody{box_of_triangles(kHalf).mesh(), {0, 0.02, 0}, turned}, motion, 0.4}};
      EXPECT_LE(apart(simulate(scene, solver, kQuarterSecond), want), std::max(1e-9, within))
          << solver << ", spread " << within << ' ' << moves;
      scene.colliders.clear();
      EXPECT_GT(apart(simulate(scene, solver, kQuarterSecond), want), 0.05) << solver;
    }
}

TEST(BodyContact, AndInEveryResponse) {
  Scene scene = sheet_above(0.26);
  for (const char* response : {"continuous", "discrete", "before", "after", "freeze", "halt"})
    for (const double thickness : {0.0, 0.005}) {
      scene.thickness = thickness;
      const std::string solver = listing("precision=double,contact=" + std::string(response));
      scene.colliders = {{Box{{0, 0, 0}, kHalf}, tumbling({0, 0, 0}), 0.4}};
      const State want = simulate(scene, solver, kQuarterSecond);
      scene.colliders = {{MeshBody{box_of_triangles(kHalf).mesh()}, tumbling({0, 0, 0}), 0.4}};
      EXPECT_LE(apart(simulate(scene, solver, kQuarterSecond), want), 1e-9)
          << response << ' ' << thickness;
    }
}

// A frame that moves at a constant velocity sees the same motion.
TEST(BodyContact, ASteadyBodyIsAtRestInAMovingFrame) {
  const Vec3 speed(0.7, -0.3, 0.4);
  for (const std::string& solver : our_solvers()) {
    // later, rounding decides which vertices touch, as the iterations have not converged
    const int steps = solver.starts_with("implicit") ? 3 : kQuarterSecond;
    Scene scene = sheet_above(0.2);
    scene.colliders = {
        {MeshBody{torus(0.3, 0.12, 16, 10).mesh(), {0.02, 0.05, 0.01}}, Motion{}, 0.3}};
    const State at_rest = simulate(scene, solver, steps);
    for (Vec3& v : scene.start.v) v += speed;
    scene.colliders[0].motion.velocity = speed;
    State moved = simulate(scene, solver, steps);
    for (Vec3& x : moved.x) x -= steps / 64.0 * speed;
    EXPECT_LE(apart(moved, at_rest), 1e-9) << solver;
  }
}

// A wall of two triangles behaves like their plane, friction included.
TEST(BodyContact, AWallOfTwoTrianglesIsAPlaneWithFriction) {
  const Vec3 normal = Vec3(0.5, 1, 0.2).normalized();
  const Eigen::Quaterniond turned = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitY(), normal);
  const Triangles wall{{{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}}, {{0, 2, 1}, {0, 3, 2}}};
  Scene scene = sheet_above(0.36);
  for (const double friction : {0.0, 0.3, 2.0})
    for (const std::string& solver : our_solvers()) {
      scene.colliders = {{Plane{normal, 0}, {}, friction}};
      const State want = simulate(scene, solver, kQuarterSecond);
      const double within = solver.starts_with("implicit") ? 2 * spread(scene, solver, want) : 0;
      scene.colliders = {
          {MeshBody{.mesh = wall.mesh(), .rotation = turned, .sides = MeshBody::Sides::both},
           {},
           friction}};
      EXPECT_LE(apart(simulate(scene, solver, kQuarterSecond), want), std::max(1e-9, within))
          << solver << ", spread " << within << ' ' << friction;
    }
}

/// Largest depth of a vertex below the body's surface [m].
double deepest(const Scene& scene, const State& state, double t) {
  double most = -1e9;
  const Shape shape = shape_at(scene.colliders[0], t);
  for (const Vec3& x : state.x) most = std::max(most, -surface(shape, x).distance);
  return most;
}

TEST(BodyContact, VerticesAreKeptFromABodyThatIsNotConvex) {
  for (const std::string& solver : our_solvers())
    for (const char* contact : {"continuous", "discrete"}) {
      Scene scene = sheet_above(0.25);
      scene.colliders = {
          {MeshBody{torus(0.3, 0.12, 16, 10, 0.02).mesh()}, tumbling({0, 0, 0}), 0.3}};
      const State state =
          simulate(scene, with(solver, "contact=" + std::string(contact)), kQuarterSecond);
      EXPECT_LE(deepest(scene, state, kQuarterSecond * scene.dt), -scene.thickness + 2e-3)
          << solver << ' ' << contact;
    }
}

TEST(BodyContact, NothingPassesAThinBodyFromEitherSide) {
  const Triangles wall{{{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, {{0, 2, 1}, {0, 3, 2}}};
  for (const std::string& solver : our_solvers())
    for (const double side : {-1.0, 1.0}) {
      Scene scene = sheet_above(side * 0.3);
      for (Vec3& v : scene.start.v) v = {0, -side * 30, 0};
      scene.colliders = {{.shape = MeshBody{.mesh = wall.mesh(), .sides = MeshBody::Sides::both}}};
      const State state = simulate(scene, solver, 4);
      for (const Vec3& x : state.x) EXPECT_GE(side * x.y(), 0.005 - 1e-4) << solver << ' ' << side;
    }
}

// Grooves are narrower than the distance by which one of their walls pushes vertices out.
TEST(BodyContact, WhatIsPutOutOfOneWallOfAGrooveStaysAboveTheOther) {
  for (const std::string& solver : our_solvers()) {
    Scene scene = sheet_above(kGrooves + 0.1);
    for (Vec3& v : scene.start.v) v = {0.3, -20, 0};
    scene.colliders = {
        {.shape = MeshBody{.mesh = grooved_sheet().mesh(), .sides = MeshBody::Sides::both}}};
    EXPECT_EQ(below_grooves(simulate(scene, solver, kQuarterSecond)), 0) << solver;
  }
}

/// Depth of the deepest of many sample points on the faces.
double deepest_of_faces(const Scene& scene, const State& state) {
  double most = 0;
  constexpr int kPieces = 20;
  for (const auto& [a, b, c] : scene.mesh.triangles)
    for (int i = 0; i <= kPieces; ++i)
      for (int j = 0; i + j <= kPieces; ++j) {
        const double u = i / double{kPieces}, v = j / double{kPieces};
        const Vec3 p = u * state.x[to_index(a)] + v * state.x[to_index(b)] +
                       (1 - u - v) * state.x[to_index(c)];
        most = std::max(most, -surface(scene.colliders[0].shape, p).distance);
      }
  return most;
}

// A ridge of half-angle a lies between vertices at distance l. The vertices stay outside, but their
// chord is (l/2) cos a deep, here 39 mm. With faces or edges the ridge stays out of the cloth, up
// to the error of the last sweep of the links or the last iteration of a solve.
TEST(BodyContact, ARidgePokesThroughVerticesAndNotThroughFaces) {
  const Triangles roof{
      {{-0.8, -0.8, -1}, {0.8, -0.8, -1}, {0, 0, -1}, {-0.8, -0.8, 1}, {0.8, -0.8, 1}, {0, 0, 1}},
      {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}};
  for (const char* solver : {"jakobsen:precision=double", "implicit", "pd"}) {
    Scene scene = hanging_sheet(10, 4);  // vertices 1/9 m apart, none over the ridge
    for (std::vector<Vec3>* places : {&scene.mesh.rest, &scene.start.x})
      for (Vec3& x : *places) x = Vec3(x.x() - 0.5, 0.06, x.y() + 0.15);
    scene.pins.clear();
    scene.colliders = {{.shape = MeshBody{roof.mesh()}, .friction = 2}};
    ASSERT_TRUE(roof.mesh()->closed() && roof.mesh()->volume() > 0);
    const double alone = deepest_of_faces(scene, simulate(scene, with(solver, "faces=off"), 96));
    EXPECT_NEAR(alone, std::sqrt(0.5) / 18, 2e-3) << solver;
    for (const char* faces : {"faces=on", "faces=edges"})
      EXPECT_LE(deepest_of_faces(scene, simulate(scene, with(solver, faces), 96)), 2.5e-3)
          << solver << ' ' << faces;
  }
}

// The tip of a pyramid is under the middle of a face and its edges are beside those of the face.
// With vertices alone, or with edges, the face falls on the tip and is pierced.
TEST(BodyContact, ATipIsKeptOutOfAFaceByFacesAlone) {
  Scene scene = hanging_sheet(2, 2);
  for (std::vector<Vec3>* places : {&scene.mesh.rest, &scene.start.x})
    for (Vec3& x : *places) x = Vec3(x.x(), 0.3, x.y());
  Vec3 middle = Vec3::Zero();
  for (const int v : scene.mesh.triangles[0]) middle += scene.start.x[to_index(v)] / 3;
  scene.pins.clear();
  scene.thickness = 0.005;
  scene.colliders = {
      {.shape = MeshBody{pyramid(0.4, 0.25).mesh(), {middle.x(), 0, middle.z()}}, .friction = 1}};
  for (const char* solver : {"jakobsen:precision=double", "implicit", "pd"}) {
    EXPECT_GT(deepest_of_faces(scene, simulate(scene, with(solver, "faces=off"), 12)), 1e-2)
        << solver;
    EXPECT_LT(deepest_of_faces(scene, simulate(scene, with(solver, "faces=on"), 12)), 5e-3)
        << solver;
  }
}

// A box rises by a third of the sheet's links in a step and stops: nothing was faster than the box,
// and a sheet of light springs rebounds at most at twice its speed.
TEST(BodyContact, AKickFromBelowGivesNoMoreThanItHas) {
  constexpr double kSpeed = 6;  // m/s
  Scene scene;
  scene.name = "kick";
  scene.mesh = make_sheet({.nu = 9,
                           .nv = 9,
                           .width = 0.6,
                           .height = 0.6,
                           .origin = {-0.3, 0.056, 0.3},
                           .v = -Vec3::UnitZ(),
                           .mass = 0.1});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(81, Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.stiffness = {10000, 10000, kRigid[2]};
  scene.thickness = 0.005;
  scene.dt = 1.0 / 240;
  const Motion kick{.path = {{0.05, Vec3::Zero()}, {0.05 + 0.25 / kSpeed, {0, 0.25, 0}}}};
  scene.colliders = {{MeshBody{box_of_triangles({0.2, 0.05, 0.2}).mesh()}, kick, 0.3}};
  for (const char* solver : {"implicit", "pd", "admm"}) {
    double fastest = 0;
    for (const int steps : {24, 30, 40, 60})
      for (const Vec3& v : simulate(scene, with(solver, "faces=edges"), steps).v)
        fastest = std::max(fastest, v.norm());
    EXPECT_GT(fastest, kSpeed / 2) << solver;
    EXPECT_LT(fastest, 2.5 * kSpeed) << solver;
  }
}

/// A strip that hangs from pins on top of a smooth collider, as long as four fifths of the way
/// round a capsule.
Scene strip_over(const Shape& shape, int across, double stiffness) {
  Scene scene;
  scene.name = "strip";
  scene.mesh = make_sheet({.nu = across,
                           .nv = 15,
                           .width = 0.04 * (across - 1),
                           .height = 0.44,
                           .origin = {-0.02 * (across - 1), 0.114, 0},
                           .v = -Vec3::UnitZ(),
                           .mass = 0.08});
  const std::size_t n = scene.mesh.rest.size();
  scene.start = {scene.mesh.rest, std::vector<Vec3>(n, Vec3::Zero())};
  for (std::size_t i = 0; i < n; ++i)
    if (scene.mesh.rest[i].z() == 0) scene.pins.push_back(static_cast<int>(i));
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.stiffness = {stiffness, stiffness, kRigid[2]};
  scene.thickness = 0.004;
  scene.damping = 3;
  scene.dt = 1.0 / 60;
  scene.colliders = {{shape}};
  return scene;
}

// Strains of the narrow strips over the capsule are those of an independent program, which
// minimises the energy of the springs with all edges outside of the collider (SLSQP): 1.2614 and
// 0.1265 %. The others are those of mass-spring:substeps=64, to 0.3 %, with the box given as
// triangles.
TEST(BodyContact, ClothWhoseEdgesTouchComesToRest) {
  const Shape capsule = Capsule{{-0.2, 0, 0}, {0.2, 0, 0}, 0.11};
  const Shape box = Box{{0, -0.01, 0}, {0.2, 0.12, 0.09}};
  struct Case {
    Shape shape;
    int across;
    double stiffness, strain;
  };
  for (const auto& [shape, across, stiffness, strain] :
       {Case{capsule, 2, 700, 0.01261}, Case{capsule, 2, 7000, 0.001265},
        Case{capsule, 6, 700, 0.003730}, Case{box, 2, 700, 0.01105}})
    for (const char* solver : {"implicit", "pd:iterations=60", "admm:links=elastic,iterations=60"})
      for (const char* faces : {"faces=edges", "faces=on"}) {
        if (faces == std::string("faces=on") && (across > 2 || stiffness > 700)) continue;
        const Scene scene = strip_over(shape, across, stiffness);
        const State end = simulate(scene, with(solver, faces), 360);
        double most = 0, fastest = 0;
        for (const Link& link : scene.links)
          most = std::max(
              most, (end.x[to_index(link.b)] - end.x[to_index(link.a)]).norm() / link.rest - 1);
        for (const Vec3& v : end.v) fastest = std::max(fastest, v.norm());
        EXPECT_NEAR(most, strain, 0.05 * strain) << type_name(shape) << ' ' << across << ' '
                                                 << stiffness << ' ' << solver << ' ' << faces;
        EXPECT_LT(fastest, 1e-3) << type_name(shape) << ' ' << across << ' ' << stiffness << ' '
                                 << solver << ' ' << faces;
      }
}

// vbd, avbd and primal=on bring vertices to rest, and not edges.
TEST(BodyContact, SolversThatLeaveEdgesMovingRefuseThem) {
  Scene scene = strip_over(Capsule{{-0.2, 0, 0}, {0.2, 0, 0}, 0.11}, 2, 700);
  const auto reasons = [&](const std::string& solver) {
    const SolverChoice choice = parse_solver(solver);
    return choice.entry->unsupported(scene, choice.params);
  };
  for (const std::string solver : {"vbd", "avbd", "xpbd:method=global,primal=on"}) {
    if (solver == "avbd") scene.stiffness = kRigid;
    EXPECT_TRUE(reasons(solver).empty()) << solver;
    for (const char* faces : {"faces=edges", "faces=on"}) {
      const auto why = reasons(with(solver, faces));
      ASSERT_EQ(why.size(), 1u) << solver;
      EXPECT_NE(why[0].find("take implicit, pd or admm"), std::string::npos) << why[0];
    }
  }
}

}  // namespace
}  // namespace taut::body_contact_test
