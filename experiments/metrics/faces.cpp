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
       .help = "largest depth of a point of a face below the surface of a ball or box, thickness "
               "not counted, in the last second",
       .in_series = true,
       .title = "largest penetration of faces",
       .kept = true},
      {"face.peak", kErrorLength, "the same over the run", false, Window::run,
       "peak penetration of faces", Role::face_depth},
      {"face.geometry", kLength,
       "the part of a face's depth in a ball that is geometry: how deep it would be if its corners "
       "lay exactly at the scene's thickness, l^2/(4R) for a right triangle with legs l; largest "
       "in the last second",
       true},
      {"face.excess", kErrorLength,
       "largest depth of a face below a ball's surface beyond its geometric part, in the last "
       "second",
       true},
      {"face.ball", kErrorLength, "face.max of the balls alone"},
      {"face.box", kErrorLength, "face.max of the boxes alone"},
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
    const Depths d = measure(m);
    any_.add(m.step, at_end, std::max(d.ball, d.box));
    if (has<Ball>()) {
      ball_.add(m.step, at_end, d.ball);
      geometry_.add(m.step, at_end, d.geometry), excess_.add(m.step, at_end, d.excess);
    }
    if (has<Box>()) box_.add(m.step, at_end, d.box);
  }
  std::vector<double> finish() override {
    return {any_.max(), any_.peak(), geometry_.max(), excess_.max(), ball_.max(), box_.max()};
  }
  std::vector<double> now(const Snapshot& m) const override {
    constexpr double none = Summary::kNone;
    const Depths d = measure(m);
    const bool ball = has<Ball>();
    return {std::max(d.ball, d.box), none, ball ? d.geometry : none,
            ball ? d.excess : none,  none, none};
  }

 private:
  struct Depths {
    double ball = 0, geometry = 0, excess = 0, box = 0;
  };

  template <class T>
  bool has() const {
    return std::any_of(colliders_.begin(), colliders_.end(),
                       [](const Collider& c) { return std::holds_alternative<T>(c.shape); });
  }

  Depths measure(const Snapshot& m) const {
    Depths depths;
    for (const Collider& collider : colliders_) {
      const Shape shape = shape_at(collider, m.t);
      if (const Ball* ball = std::get_if<Ball>(&shape)) add(*ball, m.state, depths);
      if (const Box* box = std::get_if<Box>(&shape)) add(*box, m.state, depths);
    }
    return depths;
  }

  void add(const Ball& ball, const State& state, Depths& depths) const {
    const double hover = ball.radius + thickness_;
    for (const Triangle& face : faces_) {
      const Corners t = corners(face, state);
      const double depth = deepest_in(ball, t).depth;
      if (!(depth > 0)) continue;
      const double r = std::min(enclosing_radius(t), hover);
      const double geometry = std::max(0.0, ball.radius - std::sqrt(hover * hover - r * r));
      depths.ball = std::max(depths.ball, depth);
      depths.geometry = std::max(depths.geometry, std::min(depth, geometry));
      depths.excess = std::max(depths.excess, depth - geometry);
    }
  }

  void add(const Box& box, const State& state, Depths& depths) const {
    for (const Triangle& face : faces_)
      depths.box = std::max(depths.box, deepest_in(box, corners(face, state), depths.box).depth);
  }

  static Corners corners(const Triangle& t, const State& s) {
    return {s.x[to_index(t[0])], s.x[to_index(t[1])], s.x[to_index(t[2])]};
  }

  std::vector<Collider> colliders_;  ///< balls and boxes; faces add nothing to vertices on a plane
  std::vector<Triangle> faces_;
  double thickness_;
  LastSecond end_;
  Summary any_, ball_, geometry_, excess_, box_;
};

}  // namespace

TAUT_METRIC(faces, Faces, "How deep the faces, not just the vertices, are in balls and boxes",
            "exact depth of a triangle in a ball and in a box");

}  // namespace taut
