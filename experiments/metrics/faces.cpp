#include <array>
#include <set>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Faces final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = "face.max",
       .unit = kErrorLength,
       .help = "largest depth of a point of a face below the surface of a ball, box, capsule or "
               "solid body of triangles, thickness not counted, in the last second",
       .in_series = true,
       .title = "largest penetration of faces",
       .kept = true},
      {"face.peak", kErrorLength, "the same over the run", false, Window::run,
       "peak penetration of faces", Role::face_depth},
      {"face.geometry", kLength,
       "part of a face's depth in a ball or capsule that its size alone causes: its depth if its "
       "corners lay exactly at the scene's thickness, in a ball l^2/(4R) for a right triangle with "
       "legs l; largest in the last second",
       true},
      {"face.excess", kErrorLength,
       "largest depth of a face in a ball or capsule beyond the part that its size causes, in the "
       "last second",
       true},
      {"face.ball", kErrorLength, "face.max of the balls alone"},
      {"face.box", kErrorLength, "face.max of the boxes alone"},
      {"face.capsule", kErrorLength, "face.max of the capsules alone"},
      {"face.mesh", kErrorLength,
       lasting("face.max of the bodies of triangles alone, to " + percent(kDepthError) +
               " of a face's longest side")},
      {"face.passages", kErrorCount,
       "number of times that the centre of a ball, a corner of a box, a point of a capsule's axis "
       "or a vertex of a body of triangles passes through a face, returns included; paths are "
       "straight from step to step (a body's in its own frame)",
       false, Window::run, "passages through faces"},
  };
  static bool measures(const Scene& scene) {
    return !scene.mesh.triangles.empty() && has_solid(scene);
  }
  explicit Faces(const Scene& scene) : thickness_(scene.thickness), end_(scene) {
    const auto pinned = [&](int i) { return is_pinned(scene, i); };
    for (const Triangle& face : scene.mesh.triangles)
      if (!std::all_of(face.begin(), face.end(), pinned)) faces_.push_back(face);
    for (const Collider& c : scene.colliders)
      if (std::holds_alternative<MeshBody>(c.shape))
        bodies_.push_back(c);
      else if (!std::holds_alternative<Plane>(c.shape))
        colliders_.push_back(c);
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step);
    count_passages(m);
    const Depths d = measure(m);
    if (has_depth()) any_.add(m.step, at_end, d.max());
    if (has<Ball>()) ball_.add(m.step, at_end, d.ball);
    if (has<Box>()) box_.add(m.step, at_end, d.box);
    if (has<Capsule>()) capsule_.add(m.step, at_end, d.capsule);
    if (has_solid_body()) mesh_.add(m.step, at_end, d.mesh);
    if (has_round()) {
      geometry_.add(m.step, at_end, d.geometry);
      excess_.add(m.step, at_end, d.excess);
    }
  }
  std::vector<double> finish() override {
    return {any_.max(),     any_.peak(), geometry_.max(),
            excess_.max(),  ball_.max(), box_.max(),
            capsule_.max(), mesh_.max(), static_cast<double>(passages_)};
  }
  std::vector<double> now(const Snapshot& m) const override {
    constexpr double none = Summary::kNone;
    const Depths d = measure(m);
    const bool round = has_round();
    return {has_depth() ? d.max() : none,
            none,
            round ? d.geometry : none,
            round ? d.excess : none,
            none,
            none,
            none,
            none,
            none};
  }

 private:
  struct Depths {
    double ball = 0, geometry = 0, excess = 0, box = 0, capsule = 0, mesh = 0;
    double max() const { return std::max({ball, box, capsule, mesh}); }
  };

  template <class T>
  bool has() const {
    return std::any_of(colliders_.begin(), colliders_.end(),
                       [](const Collider& c) { return std::holds_alternative<T>(c.shape); });
  }

  static bool is_solid(const Collider& body) {
    return std::get<MeshBody>(body.shape).sides == MeshBody::Sides::out;
  }
  bool has_solid_body() const { return std::ranges::any_of(bodies_, is_solid); }
  bool has_depth() const { return !colliders_.empty() || has_solid_body(); }
  bool has_round() const { return has<Ball>() || has<Capsule>(); }

  Depths measure(const Snapshot& m) const {
    Depths depths;
    for (const Collider& collider : colliders_) {
      const Shape shape = shape_at(collider, m.t);
      if (const Ball* ball = std::get_if<Ball>(&shape)) add(*ball, m.state, depths.ball, depths);
      if (const Capsule* capsule = std::get_if<Capsule>(&shape))
        add(*capsule, m.state, depths.capsule, depths);
      if (const Box* box = std::get_if<Box>(&shape)) add(*box, m.state, depths);
    }
    for (const Collider& collider : bodies_)
      if (is_solid(collider)) {
        const auto body = std::get<MeshBody>(shape_at(collider, m.t));
        for (const Triangle& face : faces_)
          depths.mesh = deepest_in(*body.mesh, in_frame(body, corners(face, m.state)), depths.mesh);
      }
    return depths;
  }

  /// Adds a face. A point with barycentric weights b of a face whose corners are at least `hover`
  /// from it is at least sqrt(hover^2 - r^2) from a centre, where r is the enclosing radius of the
  /// face. The centre is a ball's, or the point of an axis that is nearest.
  template <class Round>
  void add(const Round& shape, const State& state, double& deepest, Depths& depths) const {
    const double hover = shape.radius + thickness_;
    for (const Triangle& face : faces_) {
      const Corners t = corners(face, state);
      const double depth = deepest_in(shape, t).depth;
      if (!(depth > 0)) continue;
      const double r = std::min(enclosing_radius(t), hover);
      const double geometry = std::max(0.0, shape.radius - std::sqrt(hover * hover - r * r));
      deepest = std::max(deepest, depth);
      depths.geometry = std::max(depths.geometry, std::min(depth, geometry));
      depths.excess = std::max(depths.excess, depth - geometry);
    }
  }

  void add(const Box& box, const State& state, Depths& depths) const {
    for (const Triangle& face : faces_)
      depths.box = std::max(depths.box, deepest_in(box, corners(face, state), depths.box).depth);
  }

  /// Points of a solid that a face cannot pass without being pierced by them.
  static std::vector<Vec3> places_of(const Shape& shape) {
    if (const Ball* ball = std::get_if<Ball>(&shape)) return {ball->center};
    std::vector<Vec3> places;
    if (const Capsule* capsule = std::get_if<Capsule>(&shape))
      for (const double at : {0.0, 0.25, 0.5, 0.75, 1.0})
        places.push_back(capsule->from + at * (capsule->to - capsule->from));
    if (const Box* box = std::get_if<Box>(&shape))
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
          for (const double z : {-1.0, 1.0})
            places.push_back(box->center +
                             box->rotation * Vec3(x, y, z).cwiseProduct(box->half_extents));
    return places;
  }
  /// Whether three corners surround a point in their plane; corners are relative to the point.
  static bool surround(const Corners& t) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const auto side = [&](std::size_t a, std::size_t b) {
      return t[a].cross(t[b]).dot(normal) >= 0;
    };
    return side(0, 1) && side(1, 2) && side(2, 0);
  }
  void count_passages(const Snapshot& m) {
    std::vector<Vec3> places;
    for (const Collider& collider : colliders_)
      for (const Vec3& p : places_of(shape_at(collider, m.t))) places.push_back(p);
    for (std::size_t f = 0; m.step > 0 && f < faces_.size(); ++f) {
      const Corners now = corners(faces_[f], m.state), before = corners(faces_[f], last_);
      for (std::size_t k = 0; k < places.size(); ++k)
        passages_ += passes(before, now, places_[k], places[k]);
    }
    for (const Collider& body : bodies_)
      if (m.step > 0) count_passages(body, m);
    places_ = std::move(places);
    last_ = m.state;
    last_t_ = m.t;
  }
  /// Counts passages of those vertices, in the body's frame, that are in the box around a face's
  /// path.
  void count_passages(const Collider& collider, const Snapshot& m) {
    const auto was_there = std::get<MeshBody>(shape_at(collider, last_t_)),
               is_there = std::get<MeshBody>(shape_at(collider, m.t));
    const TriangleMesh &mesh = *is_there.mesh, &before_it = *was_there.mesh;
    const double farther = longest_way(before_it, mesh);
    std::set<int> near;
    for (const Triangle& face : faces_) {
      const Corners before = in_frame(was_there, corners(face, last_)),
                    now = in_frame(is_there, corners(face, m.state));
      Eigen::AlignedBox3d way;
      for (std::size_t c = 0; c < 3; ++c) way.extend(before[c]).extend(now[c]);
      way.min().array() -= farther;
      way.max().array() += farther;
      near.clear();
      mesh.in_box(way, [&](int triangle) {
        for (const int v : mesh.triangles()[to_index(triangle)]) near.insert(v);
      });
      for (const int v : near) {
        passages_ +=
            passes(before, now, before_it.vertices()[to_index(v)], mesh.vertices()[to_index(v)]);
      }
    }
  }
  /// Longest displacement of a vertex in the body's frame [m]; 0: the body is rigid.
  static double longest_way(const TriangleMesh& from, const TriangleMesh& to) {
    double longest = 0;
    for (std::size_t v = 0; &from != &to && v < to.vertices().size(); ++v)
      longest = std::max(longest, (to.vertices()[v] - from.vertices()[v]).norm());
    return longest;
  }
  /// How often a point passes through a face while all move straight. Six times the volume between
  /// them is a cubic in the share of the path, and 0 where they are in one plane.
  static int passes(Corners before, Corners now, const Vec3& from, const Vec3& to) {
    Eigen::AlignedBox3d way;
    Corners d;
    for (std::size_t c = 0; c < 3; ++c) {
      before[c] -= from;
      now[c] -= to;
      d[c] = now[c] - before[c];
      way.extend(before[c]).extend(now[c]);
    }
    if (!way.contains(Vec3::Zero())) return 0;
    const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) {
      return a.dot(b.cross(c));
    };
    const auto& [a, b, c] = before;
    const double k0 = volume(a, b, c),
                 k1 = volume(d[0], b, c) + volume(a, d[1], c) + volume(a, b, d[2]),
                 k2 = volume(d[0], d[1], c) + volume(d[0], b, d[2]) + volume(a, d[1], d[2]),
                 k3 = volume(d[0], d[1], d[2]);
    const auto above = [&](double s) { return k0 + s * (k1 + s * (k2 + s * k3)) > 0; };
    std::array<double, 4> turns{0, 1, 1, 1};  // it is monotone between these
    const double discriminant = k2 * k2 - 3 * k3 * k1;
    if (discriminant > 0) {
      const double root = -(k2 + std::copysign(std::sqrt(discriminant), k2));
      turns[1] = std::clamp(k3 != 0 ? root / (3 * k3) : 1, 0.0, 1.0);
      turns[2] = std::clamp(root != 0 ? k1 / root : 1, 0.0, 1.0);
      std::sort(turns.begin(), turns.end());
    }
    int count = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      double low = turns[n], high = turns[n + 1];
      if (above(low) == above(high)) continue;
      constexpr int kHalvings = 50;
      for (int k = 0; k < kHalvings; ++k)
        (above((low + high) / 2) == above(low) ? low : high) = (low + high) / 2;
      count += surround({a + high * d[0], b + high * d[1], c + high * d[2]});
    }
    return count;
  }

  static Corners in_frame(const MeshBody& body, Corners t) {
    for (Vec3& x : t) x = body.rotation.conjugate() * (x - body.center);
    return t;
  }
  static Corners corners(const Triangle& t, const State& s) {
    return {s.x[to_index(t[0])], s.x[to_index(t[1])], s.x[to_index(t[2])]};
  }

  /// Colliders without planes, on which faces add nothing to vertices. Bodies of triangles count
  /// for passages.
  std::vector<Collider> colliders_, bodies_;
  std::vector<Triangle> faces_;
  double thickness_;
  LastSecond end_;
  Summary any_, ball_, geometry_, excess_, box_, capsule_, mesh_;
  std::vector<Vec3> places_;  ///< m, of all colliders, at the last step
  State last_;
  double last_t_ = 0;  ///< s
  int passages_ = 0;
};

}  // namespace

TAUT_METRIC(faces, Faces,
            "How deep the faces, not just the vertices, are in balls, boxes, capsules and bodies",
            "exact depth of a triangle in a ball, box and capsule; in a body by bisection");

}  // namespace taut
