// Depths and passages at a pyramid, a torus and a lumpy ball that move through a cloth, each at
// three resolutions. The second implementation has no tree: it searches all triangles at thousands
// of moments.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <utility>

#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"
#include "tests/metrics/measured.hpp"
#include "tests/support/bodies.hpp"

namespace taut::body_oracle_test {
namespace {

/// Splits each triangle into four.
Triangles finer(const Triangles& body) {
  Triangles fine{body.vertices, {}};
  const auto middle = [&](int a, int b) {
    const Vec3 m = (body.vertices[to_index(a)] + body.vertices[to_index(b)]) / 2;
    for (std::size_t v = body.vertices.size(); v < fine.vertices.size(); ++v)
      if (fine.vertices[v] == m) return static_cast<int>(v);
    fine.vertices.push_back(m);
    return static_cast<int>(fine.vertices.size()) - 1;
  };
  for (const auto& [a, b, c] : body.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(),
                          {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

Triangles lumpy_ball(int cuts) {
  Triangles ball = ball_of_triangles(1, cuts);
  for (Vec3& x : ball.vertices)
    x *= 0.3 + 0.05 * std::sin(7 * x.x() + 1) * std::cos(5 * x.y()) * std::sin(6 * x.z() + 2);
  return ball;
}

struct Named {
  const char* name;
  Triangles body;
};
std::vector<Named> bodies() {
  const Triangles coarse = pyramid(0.7, 0.5), middle = finer(coarse);
  return {{"pyramid 1", coarse},
          {"pyramid 2", middle},
          {"pyramid 3", finer(middle)},
          {"torus 1", torus(0.3, 0.13, 7, 5)},
          {"torus 2", torus(0.3, 0.13, 12, 8)},
          {"torus 3", torus(0.3, 0.13, 20, 12)},
          {"lumps 1", lumpy_ball(0)},
          {"lumps 2", lumpy_ball(1)},
          {"lumps 3", lumpy_ball(2)}};
}

// The code below uses the corners of triangles and nothing else of the library's geometry.

struct Body {
  const Triangles& triangles;
  Vec3 corner(const Triangle& t, std::size_t k) const { return triangles.vertices[to_index(t[k])]; }

  /// Whether the surface covers the full solid angle (4 pi) around p.
  bool contains(const Vec3& p) const {
    double sum = 0;
    for (const Triangle& t : triangles.triangles) {
      const Vec3 a = (corner(t, 0) - p).normalized(), b = (corner(t, 1) - p).normalized(),
                 c = (corner(t, 2) - p).normalized();
      sum += std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
    }
    return sum > std::numbers::pi;
  }
  /// Distance by minimisation over each triangle's barycentric coordinates: first its interior,
  /// then its sides.
  double distance(const Vec3& p) const {
    double least2 = 1e300;
    for (const Triangle& t : triangles.triangles) {
      Eigen::Matrix<double, 3, 2> sides;
      sides << corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0);
      const Eigen::Vector2d at =
          (sides.transpose() * sides).ldlt().solve(sides.transpose() * (p - corner(t, 0)));
      if (at.minCoeff() >= 0 && at.sum() <= 1) {
        least2 = std::min(least2, (corner(t, 0) + sides * at - p).squaredNorm());
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 from = corner(t, k), way = corner(t, (k + 1) % 3) - from;
        const double share = std::min(1.0, std::max(0.0, way.dot(p - from) / way.dot(way)));
        least2 = std::min(least2, (from + share * way - p).squaredNorm());
      }
    }
    return std::sqrt(least2);
  }
  Vec3 normal_near(const Vec3& p) const {
    double least = 1e300;
    Vec3 normal = Vec3::Zero();
    for (const Triangle& t : triangles.triangles) {
      const Triangles one{{corner(t, 0), corner(t, 1), corner(t, 2)}, {{0, 1, 2}}};
      const double distance = Body{one}.distance(p);
      if (distance >= least) continue;
      least = distance;
      normal = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).normalized();
    }
    return normal;
  }
};

Motion tumbling() {
  return {.velocity = {0, 0.4, 1}, .spin = {0.2, -0.7, 0.4}, .pivot = {1, 0, 0}};
}

/// Sheet whose vertices have new random places in every step; no vertex starts inside.
struct Wild {
  Scene scene = sheet(4);
  std::vector<State> states;
  std::vector<std::vector<Vec3>> body_at;  ///< [steps + 1][vertices] m, in the body's frame
  explicit Wild(const Triangles& body, bool deforms = false) {
    scene.steps = 3;
    scene.colliders = {{MeshBody{body.mesh(), {0.5, 0, 0.5}}, tumbling(), 0}};
    Draw draw(11);
    body_at.assign(to_index(scene.steps) + 1, body.vertices);
    if (deforms) {
      for (std::size_t step = 1; step < body_at.size(); ++step)
        for (Vec3& x : body_at[step]) x += draw.vector(0.1);
      scene.colliders[0].frames =
          std::make_shared<BodyFrames>(BodyFrames{.places = body_at, .fps = 1 / scene.dt});
    }
    states.assign(to_index(scene.steps) + 1, scene.start);
    for (std::size_t i = 0; i < scene.start.x.size(); ++i)
      for (State& state : states) do
          state.x[i] = Vec3(0.5, 0, 0.5) + draw.vector(0.5);
        while (&state == &states[0] && Body{body}.contains(local(0, state.x[i])));
    scene.start = states[0];
  }
  Vec3 local(int step, const Vec3& x) const {
    Collider rigid = scene.colliders[0];
    rigid.frames = nullptr;
    const auto body = std::get<MeshBody>(shape_at(rigid, step * scene.dt));
    return body.rotation.conjugate() * (x - body.center);
  }
  Vec3 local(int step, int vertex) const {
    return local(step, states[to_index(step)].x[to_index(vertex)]);
  }
};

TEST(BodyOracle, DepthsAgree) {
  for (const auto& [name, triangles] : bodies()) {
    const Wild wild(triangles);
    const Body body{triangles};
    double peak = 0;
    int below = 0;
    for (int step = 0; step <= wild.scene.steps; ++step)
      for (int i = 0; i < wild.scene.mesh.size(); ++i) {
        const Vec3 p = wild.local(step, i);
        const double distance = body.contains(p) ? -body.distance(p) : body.distance(p);
        peak = std::max(peak, -distance);
        below += distance < 0;
      }
    const Values v = measure(wild.scene, [&](int step) { return wild.states[to_index(step)]; });
    EXPECT_NEAR(v.at("penetration.mesh.peak"), peak, 1e-12) << name;
    EXPECT_NEAR(v.at("penetration.peak"), peak, 1e-12) << name;
    EXPECT_GE(below, 2) << name;
  }
}

TEST(BodyOracle, PassagesOfVerticesAgree) {
  for (const auto& [name, triangles] : bodies()) {
    const Wild wild(triangles);
    const Body body{triangles};
    int events = 0;
    for (int i = 0; i < wild.scene.mesh.size(); ++i) {
      bool in = false;
      Vec3 entry = Vec3::Zero();
      for (int step = 1; step <= wild.scene.steps; ++step) {
        const Vec3 from = wild.local(step - 1, i), to = wild.local(step, i);
        constexpr int kMoments = 1000;
        for (int k = 1; k <= kMoments; ++k) {
          const Vec3 p = from + k / double{kMoments} * (to - from);
          if (body.contains(p) == in) continue;
          in = !in;
          const Vec3 normal = body.normal_near(p);
          if (in) entry = normal;
          events += !in && entry.dot(normal) < 0;
        }
      }
    }
    const Values v = measure(wild.scene, [&](int step) { return wild.states[to_index(step)]; });
    EXPECT_EQ(v.at("tunnelling.events"), events) << name;
    EXPECT_GT(events, 0) << name;
  }
}

/// Whether p is above the plane through a, b and c.
bool above(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  return (b - a).cross(c - a).dot(p - a) > 0;
}

/// Whether the vertex, projected along the face's normal, is within the face at this moment.
bool covers(const std::array<Vec3, 3>& face, const Vec3& p) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << face[1] - face[0], face[2] - face[0];
  const Eigen::Vector2d at = sides.colPivHouseholderQr().solve(p - face[0]);
  return at.minCoeff() >= 0 && at.sum() <= 1;
}

/// Whether two edges that are nearly in one plane intersect within it.
bool meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  Eigen::Matrix<double, 3, 2> ways;
  ways << q - p, a - b;
  const Eigen::Vector2d at = ways.colPivHouseholderQr().solve(a - p);
  return at.minCoeff() >= 0 && at.maxCoeff() < 1;
}

std::set<std::pair<int, int>> edges_of(const std::vector<Triangle>& triangles) {
  std::set<std::pair<int, int>> edges;
  for (const auto& [a, b, c] : triangles)
    for (const auto& [v, w] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      edges.insert({std::min(v, w), std::max(v, w)});
  return edges;
}

/// Calls seen(share) at every moment at which the sign of `side(share)` changes.
template <class Side, class Seen>
void changes(const Side& side, const Seen& seen) {
  constexpr int kMoments = 400;
  auto before = side(0);
  for (int k = 1; k <= kMoments; ++k) {
    double low = (k - 1) / double{kMoments}, high = k / double{kMoments};
    const auto was = std::exchange(before, side(high));
    if (was == before) continue;
    for (int n = 0; n < 40; ++n) {
      const double middle = (low + high) / 2;
      (side(middle) == was ? low : high) = middle;
    }
    seen(high);
  }
}

void expect_passages_of_edges_and_faces(bool deforms) {
#ifdef TAUT_SANITIZED
  GTEST_SKIP() << "nearly all of its time is the test's own; BodyMetrics runs the same metrics";
#endif
  int all_of_faces = 0;
  for (const auto& [name, triangles] : bodies()) {
    // too many pairs of edges and moments
    if (triangles.triangles.size() > (deforms ? 70 : 130)) continue;
    const Wild wild(triangles, deforms);
    int of_edges = 0, of_faces = 0;
    for (int step = 1; step <= wild.scene.steps; ++step) {
      const auto at = [&](int i, double share) {
        const Vec3 from = wild.local(step - 1, i), to = wild.local(step, i);
        return Vec3(from + share * (to - from));
      };
      const auto of_body = [&](int v, double share) {
        const Vec3 &from = wild.body_at[to_index(step - 1)][to_index(v)],
                   &to = wild.body_at[to_index(step)][to_index(v)];
        return Vec3(from + share * (to - from));
      };
      for (const auto& edge : edges_of(wild.scene.mesh.triangles))
        for (const auto& fixed : edges_of(triangles.triangles)) {
          changes(
              [&](double share) {
                return above(at(edge.first, share), at(edge.second, share),
                             of_body(fixed.first, share), of_body(fixed.second, share));
              },
              [&](double share) {
                of_edges += meet(at(edge.first, share), at(edge.second, share),
                                 of_body(fixed.first, share), of_body(fixed.second, share));
              });
        }
      for (const Triangle& face : wild.scene.mesh.triangles)
        for (std::size_t v = 0; v < triangles.vertices.size(); ++v) {
          const auto p = [&](double share) { return of_body(static_cast<int>(v), share); };
          const auto corners = [&](double share) {
            return std::array{at(face[0], share), at(face[1], share), at(face[2], share)};
          };
          changes(
              [&](double share) {
                const auto t = corners(share);
                return above(t[0], t[1], t[2], p(share));
              },
              [&](double share) { of_faces += covers(corners(share), p(share)); });
        }
    }
    const Values v = measure(wild.scene, [&](int step) { return wild.states[to_index(step)]; });
    EXPECT_EQ(v.at("edge.passages"), of_edges) << name;
    EXPECT_EQ(v.at("face.passages"), of_faces) << name;
    EXPECT_GT(of_edges, 50) << name;
    all_of_faces += of_faces;
  }
  EXPECT_GT(all_of_faces, 5);
}

TEST(BodyOracle, PassagesOfEdgesAndFacesAgree) { expect_passages_of_edges_and_faces(false); }
TEST(BodyOracle, AndAtABodyThatDeforms) { expect_passages_of_edges_and_faces(true); }

}  // namespace
}  // namespace taut::body_oracle_test
