#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/model/deforming_body.hpp"
#include "core/model/index.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

struct StraightEdge {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m
};

/// The edges of a solid in its own frame; the edge of a capsule is its axis. Of a body of triangles
/// only those near a path are looked up (edges_near). If a thread gets
/// through the solid between two of the thread's vertices, it passes through one of these edges.
std::vector<StraightEdge> solid_edges(const Shape& shape) {
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return {{capsule->from, capsule->to}};
  std::vector<StraightEdge> edges;
  if (const Box* box = std::get_if<Box>(&shape))
    for (int axis = 0; axis < 3; ++axis)
      for (const double u : {-1.0, 1.0})
        for (const double v : {-1.0, 1.0}) {
          Vec3 end = box->half_extents;
          end[(axis + 1) % 3] *= u;
          end[(axis + 2) % 3] *= v;
          Vec3 start = end;
          start[axis] = -start[axis];
          edges.push_back({start, end});
        }
  return edges;
}

/// Whether the nearest points of the lines of two edges lie on both edges, first ends included. The
/// edges have the vectors `along` and `b`; `a` leads from the first end of the former to the first
/// end of the latter.
bool meet(const Vec3& along, const Vec3& a, const Vec3& b) {
  const Vec3 normal = along.cross(b);
  const double twice_area2 = normal.squaredNorm();
  if (twice_area2 == 0) return false;
  const double on_one = a.cross(b).dot(normal) / twice_area2,
               on_other = a.cross(along).dot(normal) / twice_area2;
  return on_one >= 0 && on_one < 1 && on_other >= 0 && on_other < 1;
}

/// How often an edge whose ends move straight passes through a fixed edge. The volume of the
/// tetrahedron between them is a polynomial of second degree in the share of the path, and 0 where
/// they are in one plane.
int times_through(const StraightEdge& before, const StraightEdge& now, const StraightEdge& fixed) {
  const Vec3 along = fixed.to - fixed.from;
  const Vec3 a0 = before.from - fixed.from, a1 = now.from - before.from;
  const Vec3 b0 = before.to - before.from, b1 = now.to - now.from - b0;
  const double c = along.dot(a0.cross(b0)), d = along.dot(a0.cross(b1) + a1.cross(b0)),
               e = along.dot(a1.cross(b1));
  const auto meet_at = [&](double share) {
    return static_cast<int>(share > 0 && share <= 1 &&
                            meet(along, a0 + share * a1, b0 + share * b1));
  };
  if (e == 0) return d == 0 ? 0 : meet_at(-c / d);
  const double discriminant = d * d - 4 * e * c;
  if (discriminant <= 0) return 0;
  const double half = -(d + std::copysign(std::sqrt(discriminant), d)) / 2;
  return meet_at(half / e) + (half == 0 ? 0 : meet_at(c / half));
}

/// How often an edge of the cloth passes through an edge of a body when both move.
int times_through(const MovingEdge& cloth, const MovingEdge& body) {
  int times = 0;
  for (const auto& [share, rises] : passes(cloth, body)) {
    const Vec3 p = cloth.end(0, share), from = body.end(0, share);
    times += meet(body.end(1, share) - from, p - from, cloth.end(1, share) - p);
  }
  return times;
}

/// Edges of the cloth: structural links except seams, and sides of faces, with at least one free
/// vertex.
std::vector<std::pair<int, int>> cloth_edges(const Scene& scene) {
  std::set<std::pair<int, int>> edges;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && link.rest > kSeamRest)
      edges.insert(std::minmax(link.a, link.b));
  for (const Triangle& t : scene.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  std::erase_if(edges, [&](const auto& edge) {
    return is_pinned(scene, edge.first) && is_pinned(scene, edge.second);
  });
  return {edges.begin(), edges.end()};
}

class Edges final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"edge.passages", kErrorCount,
       "number of times that an edge of the cloth passes through the axis of a capsule or through "
       "an edge of a box or a body of triangles, returns included; paths are straight from substep "
       "to substep in the collider's frame",
       false, Window::run, "passages of edges"},
  };
  static bool measures(const Scene& scene) {
    return !cloth_edges(scene).empty() && std::ranges::any_of(scene.colliders, has_edges);
  }
  static constexpr bool kFollowsPath = true;
  explicit Edges(const Scene& scene) : edges_(cloth_edges(scene)) {
    for (const Collider& collider : scene.colliders)
      if (has_edges(collider)) colliders_.emplace_back(collider);
  }

  void observe_within(const Snapshot& m) override { observe(m); }
  void observe(const Snapshot& m) override {
    for (Followed& collider : colliders_) {
      std::vector<Vec3> now;
      now.reserve(m.state.x.size());
      for (const Vec3& x : m.state.x) now.push_back(collider.local(x, m.t));
      if (m.step > 0 || !collider.last.empty()) {
        if (collider.body)
          count_at_deforming(collider, now, m.t);
        else
          count(collider, now);
      }
      collider.last = std::move(now);
      collider.last_t = m.t;
    }
  }
  std::vector<double> finish() override { return {static_cast<double>(passages_)}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  static bool has_edges(const Collider& c) {
    return std::holds_alternative<Capsule>(c.shape) || std::holds_alternative<Box>(c.shape) ||
           std::holds_alternative<MeshBody>(c.shape);
  }

  /// A collider in the frame in which it does not move as a whole, and the cloth in that frame at
  /// the last time.
  struct Followed {
    explicit Followed(const Collider& c) : collider(c) {
      if (c.frames) {
        body.emplace(c);
        return;
      }
      if (const MeshBody* b = std::get_if<MeshBody>(&c.shape)) {
        mesh = b->mesh;
        box = mesh->box();
      }
      edges = solid_edges(c.shape);
      for (const StraightEdge& edge : edges) box.extend(edge.from).extend(edge.to);
    }
    /// x in that frame: without the collider's motion and, for boxes and bodies, their position.
    Vec3 local(const Vec3& x, double t) const {
      const Motion& motion = collider.motion;
      const Vec3 start =
          motion.rotation(t).conjugate() * (x - motion.displacement(t) - motion.pivot) +
          motion.pivot;
      if (const Box* b = std::get_if<Box>(&collider.shape))
        return b->rotation.conjugate() * (start - b->center);
      if (const MeshBody* b = std::get_if<MeshBody>(&collider.shape))
        return b->rotation.conjugate() * (start - b->center);
      return start;
    }
    Collider collider;
    std::optional<DeformingBody> body;         ///< one that deforms
    std::shared_ptr<const TriangleMesh> mesh;  ///< of a rigid body of triangles
    std::vector<StraightEdge> edges;           ///< of another shape
    Eigen::AlignedBox3d box;
    std::vector<Vec3> last;  ///< empty: none yet
    double last_t = 0;       ///< s
  };

  /// Puts the edges of triangles in a box into `near_`, by the vertices at their ends.
  void find_near(const TriangleMesh& mesh, const Eigen::AlignedBox3d& box) {
    near_.clear();
    mesh.in_box(box, [&](int triangle) {
      const Triangle& t = mesh.triangles()[to_index(triangle)];
      for (std::size_t k = 0; k < 3; ++k) near_.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
    });
    std::ranges::sort(near_);
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
  }

  void count(const Followed& collider, const std::vector<Vec3>& now) {
    for (const auto& [a, b] : edges_) {
      const StraightEdge is{now[to_index(a)], now[to_index(b)]},
          was{collider.last[to_index(a)], collider.last[to_index(b)]};
      Eigen::AlignedBox3d way(is.from);
      way.extend(is.to).extend(was.from).extend(was.to);
      if (!way.intersects(collider.box)) continue;
      const auto pass = [&](const StraightEdge& fixed) {
        Eigen::AlignedBox3d around(fixed.from);
        if (around.extend(fixed.to).intersects(way)) passages_ += times_through(was, is, fixed);
      };
      std::ranges::for_each(collider.edges, pass);
      if (!collider.mesh) continue;
      find_near(*collider.mesh, way);
      for (const auto& [from, to] : near_)
        pass({collider.mesh->vertices()[to_index(from)], collider.mesh->vertices()[to_index(to)]});
    }
  }

  void count_at_deforming(Followed& collider, const std::vector<Vec3>& now, double t) {
    DeformingBody& body = *collider.body;
    body.move(collider.last_t, t);
    const TriangleMesh &mesh = body.after(), &before = body.before();
    const Vec3 wider = Vec3::Constant(body.longest_way());
    for (const auto& [a, b] : edges_) {
      const MovingEdge edge{{collider.last[to_index(a)], collider.last[to_index(b)]},
                            {now[to_index(a)], now[to_index(b)]}};
      Eigen::AlignedBox3d way(edge.before[0]);
      way.extend(edge.before[1]).extend(edge.now[0]).extend(edge.now[1]);
      find_near(mesh, {way.min() - wider, way.max() + wider});
      for (const auto& [low, high] : near_) {
        const std::size_t from = to_index(low), to = to_index(high);
        passages_ += times_through(edge, {{before.vertices()[from], before.vertices()[to]},
                                          {mesh.vertices()[from], mesh.vertices()[to]}});
      }
    }
  }

  std::vector<std::pair<int, int>> edges_;
  std::vector<Followed> colliders_;
  std::vector<std::pair<int, int>> near_;
  int passages_ = 0;
};

}  // namespace

TAUT_METRIC(edges, Edges, "How often edges of the cloth pass through edges of a collider",
            "roots of the volume between two edges along their way");

}  // namespace taut
