// Depths and passages at bodies of triangles, against closed forms and thousands of sample points
// on each path.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"
#include "core/model/triangle.hpp"
#include "tests/metrics/measured.hpp"
#include "tests/support/bodies.hpp"

namespace taut::body_metrics_test {
namespace {

/// States with random positions within 0.6 m of the sheet's middle; no vertex starts inside the
/// collider.
std::vector<State> wild(const Scene& scene, double size) {
  Draw draw(7);
  std::vector<State> states(to_index(scene.steps) + 1, scene.start);
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)
    for (State& state : states) do
        state.x[i] = Vec3(0.5, 0, 0.5) + draw.vector(size);
      while (&state == &states[0] && surface(scene.colliders[0].shape, state.x[i]).distance < 0);
  return states;
}

Motion tumbling() {
  return {.velocity = {0, 0.4, 1}, .spin = {0.2, -0.7, 0.4}, .pivot = {1, 0, 0}};
}

TEST(BodyMetrics, AtABoxOfTrianglesTheyAreTheBoxs) {
  Scene scene = sheet(8);
  scene.pins = {3};
  scene.steps = 12;
  const Vec3 half(0.25, 0.3, 0.35), center(0.5, 0, 0.5);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()));
  scene.colliders = {{Box{center, half, turned}, tumbling(), 0}};
  const std::vector<State> states = wild(scene, 0.6);
  scene.start = states[0];
  const auto motion = [&](int step) { return states[to_index(step)]; };
  const Values want = measure(scene, motion);
  scene.colliders = {{MeshBody{box_of_triangles(half).mesh(), center, turned}, tumbling(), 0}};
  const Values got = measure(scene, motion);
  for (const char* name :
       {"tunnelling.count", "tunnelling.events", "tunnelling.share", "penetration.max",
        "penetration.peak", "penetration.mean", "penetration.share", "penetration.gap"})
    EXPECT_NEAR(got.at(name), want.at(name), 1e-12) << name;
  for (const char* of : {"max", "peak", "mean"})
    EXPECT_NEAR(got.at(std::string("penetration.mesh.") + of),
                want.at(std::string("penetration.box.") + of), 1e-12)
        << of;
  EXPECT_GT(want.at("tunnelling.events"), 20);
  EXPECT_TRUE(std::isnan(want.at("penetration.mesh.max")));
}

/// Whether p is inside: the triangles then cover the full solid angle (Van Oosterom, Strackee
/// 1983).
bool surrounds(const TriangleMesh& mesh, const Vec3& p) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vec3 a = mesh.vertices()[to_index(i)] - p, b = mesh.vertices()[to_index(j)] - p,
               c = mesh.vertices()[to_index(k)] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum > std::numbers::pi;
}

/// Triangle below whose inner side p lies, found by a search of all triangles.
std::size_t triangle_at(const TriangleMesh& mesh, const Vec3& p) {
  double least = 1e9;
  std::size_t nearest = 0;
  for (std::size_t n = 0; n < mesh.triangles().size(); ++n) {
    const auto& [i, j, k] = mesh.triangles()[n];
    const Corners t{mesh.vertices()[to_index(i)], mesh.vertices()[to_index(j)],
                    mesh.vertices()[to_index(k)]};
    const double distance = (closest_point(t, p).position - p).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = n;
  }
  return nearest;
}

Vec3 in_frame(const Collider& collider, double t, const Vec3& x) {
  const auto body = std::get<MeshBody>(shape_at(collider, t));
  return body.rotation.conjugate() * (x - body.center);
}

/// Frames of a body that bends further from step to step.
std::shared_ptr<const BodyFrames> bending(const Triangles& body, const Scene& scene) {
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 1 / scene.dt;
  for (int k = 0; k <= scene.steps; ++k) {
    auto& places = frames->places.emplace_back(body.vertices);
    for (Vec3& x : places) x += 0.1 * k * Vec3(x.y(), 0.5 * x.x(), x.z() * x.z());
  }
  return frames;
}

constexpr int kMoments = 2000;  ///< moments per step

/// The body's mesh, by step and moment.
std::vector<std::shared_ptr<const TriangleMesh>> moments(const Collider& c, const Scene& scene) {
  std::vector<std::shared_ptr<const TriangleMesh>> all;
  for (int n = 0; n <= scene.steps * kMoments; ++n)
    all.push_back(std::get<MeshBody>(shape_at(c, n * scene.dt / kMoments)).mesh);
  return all;
}

TEST(BodyMetrics, PassagesThroughPyramidAndTorusAreThoseOfPoints) {
  for (const auto& [body, deforms] : {std::pair{pyramid(0.7, 0.6), false},
                                      {torus(0.3, 0.13, 7, 5), false},
                                      {torus(0.3, 0.13, 7, 5), true}}) {
    Scene scene = sheet(6);
    scene.steps = 4;
    scene.colliders = {{MeshBody{body.mesh(), {0.5, 0, 0.5}}, tumbling(), 0}};
    if (deforms) scene.colliders[0].frames = bending(body, scene);
    const auto meshes = moments(scene.colliders[0], scene);
    const std::vector<State> states = wild(scene, 0.5);
    scene.start = states[0];
    int events = 0, beyond = 0;
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      bool in = false, through = false;
      std::size_t entry = 0;
      for (int step = 1; step <= scene.steps; ++step) {
        const Collider& c = scene.colliders[0];
        const Vec3 from = in_frame(c, (step - 1) * scene.dt, states[to_index(step - 1)].x[i]),
                   to = in_frame(c, step * scene.dt, states[to_index(step)].x[i]);
        for (int k = 1; k <= kMoments; ++k) {
          const Vec3 p = from + k / double{kMoments} * (to - from);
          const TriangleMesh& mesh = *meshes[to_index((step - 1) * kMoments + k)];
          if (surrounds(mesh, p) == in) continue;
          in = !in;
          const std::size_t at = triangle_at(mesh, p);
          if (in) entry = at;
          const auto normal = [&](std::size_t triangle) {  // normal at the end of the step
            return meshes[to_index(step * kMoments)]->normal(static_cast<int>(triangle));
          };
          if (in || normal(entry).dot(normal(at)) >= 0) continue;
          through = !through;
          ++events;
        }
      }
      beyond += through;
    }
    const Values v = measure(scene, [&](int step) { return states[to_index(step)]; });
    EXPECT_GT(events, 10);
    EXPECT_EQ(v.at("tunnelling.events"), events);
    EXPECT_EQ(v.at("tunnelling.count"), beyond);
  }
}

TEST(BodyMetrics, EveryCrossingOfAThinBodyIsAPassage) {
  Scene scene = sheet(6);
  scene.steps = 9;
  const Triangles wall{{{-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3}}, {{0, 2, 1}, {0, 3, 2}}};
  scene.colliders = {{.shape = MeshBody{.mesh = wall.mesh(), .sides = MeshBody::Sides::both}}};
  const std::vector<State> states = wild(scene, 0.5);
  scene.start = states[0];
  int events = 0, beyond = 0;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    for (std::size_t step = 1; step < states.size(); ++step)
      events += (states[step].x[i].y() > 0) != (states[step - 1].x[i].y() > 0);
    beyond += (states.back().x[i].y() > 0) != (states[0].x[i].y() > 0);
  }
  const Values v = measure(scene, [&](int step) { return states[to_index(step)]; });
  EXPECT_GT(events, 50);
  EXPECT_EQ(v.at("tunnelling.events"), events);
  EXPECT_EQ(v.at("tunnelling.count"), beyond);
  EXPECT_EQ(v.at("penetration.max"), 0);
}

// A wall of two triangles behaves like their plane, from both sides.
TEST(BodyMetrics, SlipOnAFlatBodyIsThatOnItsPlane) {
  Scene scene = sheet(4);
  scene.steps = 20;
  const Vec3 normal = Vec3(0.3, 1, 0.1).normalized();
  const auto slides = [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x) x += 1e-4 * step * step * Vec3(1, -0.3, 0.2);
    return state;
  };
  scene.colliders = {{Plane{normal, -1}, {}, 0.3}};
  const Values want = measure(scene, slides);
  const Triangles wall{{{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}}, {{0, 2, 1}, {0, 3, 2}}};
  for (const double side : {1.0, -1.0}) {
    scene.colliders = {
        {MeshBody{.mesh = wall.mesh(),
                  .center = -normal,
                  .rotation = Eigen::Quaterniond::FromTwoVectors(side * Vec3::UnitY(), normal),
                  .sides = MeshBody::Sides::both},
         {},
         0.3}};
    const Values got = measure(scene, slides);
    for (const char* name : {"slip.error", "slip.error.peak", "slip.distance"})
      EXPECT_NEAR(got.at(name), want.at(name), 1e-12) << name << ' ' << side;
  }
  EXPECT_GT(want.at("slip.distance"), 1e-3);
  scene.colliders = {{MeshBody{.mesh = pyramid(1, 1).mesh()}, {}, 0.3}};
  EXPECT_EQ(measure(scene, slides).count("slip.error"), 0u);
}

// The tip of a pyramid passes through one face of the sheet that falls on it, and no other vertex
// does. Checked without the tree.
TEST(BodyMetrics, AVertexOfTheBodyThatPiercesAFaceIsAPassage) {
  Scene scene = sheet(6);
  scene.steps = 6;
  scene.colliders = {{MeshBody{pyramid(0.7, 0.2).mesh(), {0.52, -0.3, 0.47}}, {}, 0}};
  const auto falls = [&](int step) {
    State state = scene.start;
    for (Vec3& x : state.x) x.y() -= 0.04 * step;
    return state;
  };
  const Values v = measure(scene, falls);
  EXPECT_EQ(v.at("face.passages"), 1);
  // a vertex 0.1 m below the tip and above the base is nearest to the sides, whose slope is
  // 0.2/0.35
  const double deepest = 0.1 * 0.35 / std::hypot(0.35, 0.2), side = 0.2 * std::sqrt(2);
  EXPECT_LE(v.at("face.mesh"), deepest + 1e-12);
  EXPECT_GE(v.at("face.mesh"), deepest - 0.01 * side);
  EXPECT_EQ(v.at("face.max"), v.at("face.mesh"));
  scene.colliders[0].motion.velocity = {0, -0.04 / scene.dt, 0};  // falls with the sheet
  EXPECT_EQ(measure(scene, falls).at("face.passages"), 0);
}

// The same passage with the sheet at rest, where frames raise the tip of the pyramid.
TEST(BodyMetrics, AVertexThatItsFramesRaiseIsAPassageToo) {
  Scene scene = sheet(6);
  scene.steps = 6;
  const Triangles body = pyramid(0.7, 0.2);
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 1 / scene.dt;
  for (int k = 0; k <= 6; ++k) {
    frames->places.push_back(body.vertices);
    frames->places.back()[4].y() += 0.04 * k;
  }
  scene.colliders = {
      {.shape = MeshBody{body.mesh(), {0.52, -0.3, 0.47}}, .frames = std::move(frames)}};
  const Values v = measure(scene, [&](int) { return scene.start; });
  EXPECT_EQ(v.at("face.passages"), 1);
  EXPECT_EQ(v.at("tunnelling.events"), 0);
  EXPECT_GT(v.at("face.mesh"), 0.03);  // the tip is 0.14 m above the sheet
}

}  // namespace
}  // namespace taut::body_metrics_test
