#include "core/model/index.hpp"
#include "core/model/triangle.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Faces final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "face.max",
       .unit = kErrorLength,
       .help = "largest depth of a point of a face below the surface of a ball, box or capsule, "
               "thickness not counted, in the last second",
       .in_series = true,
       .title = "largest penetration of faces",
       .kept = true},
      {"face.peak", kErrorLength, "the same over the run", false, Window::run,
       "peak penetration of faces", Role::face_depth},
      {"face.geometry", kLength,
       "the part of a face's depth in a ball or capsule that is geometry: how deep it could be if "
       "its corners lay exactly at the scene's thickness, in a ball l^2/(4R) for a right triangle "
       "with legs l; largest in the last second",
       true},
      {"face.excess", kErrorLength,
       "largest depth of a face below a ball's or capsule's surface beyond its geometric part, in "
       "the last second",
       true},
      {"face.ball", kErrorLength, "face.max of the balls alone"},
      {"face.box", kErrorLength, "face.max of the boxes alone"},
      {"face.capsule", kErrorLength, "face.max of the capsules alone"},
      {"face.passages", kErrorCount,
       "how often the middle of a ball, a corner of a box or a place of a capsule's axis goes "
       "through a face, returns included; their ways are straight from step to step",
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
      if (!std::holds_alternative<Plane>(c.shape)) colliders_.push_back(c);
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step);
    count_passages(m);
    const Depths d = measure(m);
    any_.add(m.step, at_end, d.max());
    if (has<Ball>()) ball_.add(m.step, at_end, d.ball);
    if (has<Box>()) box_.add(m.step, at_end, d.box);
    if (has<Capsule>()) capsule_.add(m.step, at_end, d.capsule);
    if (has_round())
      geometry_.add(m.step, at_end, d.geometry), excess_.add(m.step, at_end, d.excess);
  }
  std::vector<double> finish() override {
    return {any_.max(),  any_.peak(), geometry_.max(), excess_.max(),
            ball_.max(), box_.max(),  capsule_.max(),  static_cast<double>(passages_)};
  }
  std::vector<double> now(const Snapshot& m) const override {
    constexpr double none = Summary::kNone;
    const Depths d = measure(m);
    const bool round = has_round();
    return {d.max(), none, round ? d.geometry : none, round ? d.excess : none, none, none,
            none,    none};
  }

 private:
  struct Depths {
    double ball = 0, geometry = 0, excess = 0, box = 0, capsule = 0;
    double max() const { return std::max({ball, box, capsule}); }
  };

  template <class T>
  bool has() const {
    return std::any_of(colliders_.begin(), colliders_.end(),
                       [](const Collider& c) { return std::holds_alternative<T>(c.shape); });
  }

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
    return depths;
  }

  /// A point with barycentric weights b of a face whose corners are at least `hover` from it is at
  /// least sqrt(hover^2 - r^2) from a centre, r being the face's enclosing radius: from a ball's,
  /// and from that of an axis which is nearest to the point.
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

  /// Places of a solid that a face cannot be on both sides of without having been pierced.
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
  /// Height above the face's plane, times twice its area.
  static double height(const Corners& t, const Vec3& p) {
    return (t[1] - t[0]).cross(t[2] - t[0]).dot(p - t[0]);
  }
  static bool within(const Corners& t, const Vec3& p) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const auto side = [&](std::size_t a, std::size_t b) {
      return (t[b] - t[a]).cross(p - t[a]).dot(normal) >= 0;
    };
    return side(0, 1) && side(1, 2) && side(2, 0);
  }
  void count_passages(const Snapshot& m) {
    std::vector<Vec3> places;
    for (const Collider& collider : colliders_)
      for (const Vec3& p : places_of(shape_at(collider, m.t))) places.push_back(p);
    for (std::size_t f = 0; m.step > 0 && f < faces_.size(); ++f) {
      const Corners now = corners(faces_[f], m.state), before = corners(faces_[f], last_);
      for (std::size_t k = 0; k < places.size(); ++k) {
        const double was = height(before, places_[k]), is = height(now, places[k]);
        if ((was > 0) == (is > 0)) continue;
        const double share = was / (was - is);
        const auto between = [&](const Vec3& a, const Vec3& b) {
          return Vec3(a + share * (b - a));
        };
        passages_ += within(
            {between(before[0], now[0]), between(before[1], now[1]), between(before[2], now[2])},
            between(places_[k], places[k]));
      }
    }
    places_ = std::move(places);
    last_ = m.state;
  }

  static Corners corners(const Triangle& t, const State& s) {
    return {s.x[to_index(t[0])], s.x[to_index(t[1])], s.x[to_index(t[2])]};
  }

  std::vector<Collider> colliders_;  ///< no planes: on those faces add nothing to vertices
  std::vector<Triangle> faces_;
  double thickness_;
  LastSecond end_;
  Summary any_, ball_, geometry_, excess_, box_, capsule_;
  std::vector<Vec3> places_;  ///< m, of all colliders, at the last step
  State last_;
  int passages_ = 0;
};

}  // namespace

TAUT_METRIC(faces, Faces,
            "How deep the faces, not just the vertices, are in balls, boxes and capsules",
            "exact depth of a triangle in a ball, in a box and in a capsule");

}  // namespace taut
