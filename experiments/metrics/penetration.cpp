#include <array>

#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

constexpr std::size_t kKinds = std::variant_size_v<Shape>;  // order of Shape's alternatives

/// Depths of vertices below the surfaces of one kind of collider at one moment.
struct Depths {
  double max = 0, sum = 0;
  int count = 0;
  void add(double depth) {
    if (!(depth > 0)) return;
    max = std::max(max, depth);
    sum += depth;
    ++count;
  }
  double mean() const { return count > 0 ? sum / count : 0; }
};

class Penetration final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "penetration.max",
       .unit = kErrorLength,
       .help = "largest depth of a free vertex below a collider's surface, thickness not counted, "
               "in the last second",
       .in_series = true,
       .title = "largest penetration of vertices",
       .shown_over_time = true,
       .kept = true},
      {"penetration.peak", kErrorLength, "the same over the run", false, Window::run,
       "peak penetration of vertices", Role::vertex_depth},
      {"penetration.mean", kErrorLength,
       "mean depth of the vertices that are below a surface, mean over the last second"},
      {"penetration.plane.max", kErrorLength, "penetration.max of planes alone", true},
      {"penetration.plane.peak", kErrorLength, "penetration.peak of planes alone", false,
       Window::run},
      {"penetration.plane.mean", kErrorLength, "penetration.mean of planes alone"},
      {"penetration.ball.max", kErrorLength, "penetration.max of balls alone", true},
      {"penetration.ball.peak", kErrorLength, "penetration.peak of balls alone", false,
       Window::run},
      {"penetration.ball.mean", kErrorLength, "penetration.mean of balls alone"},
      {"penetration.box.max", kErrorLength, "penetration.max of boxes alone", true},
      {"penetration.box.peak", kErrorLength, "penetration.peak of boxes alone", false, Window::run},
      {"penetration.box.mean", kErrorLength, "penetration.mean of boxes alone"},
      {"penetration.capsule.max", kErrorLength, "penetration.max of capsules alone", true},
      {"penetration.capsule.peak", kErrorLength, "penetration.peak of capsules alone", false,
       Window::run},
      {"penetration.capsule.mean", kErrorLength, "penetration.mean of capsules alone"},
      {"penetration.mesh.max", kErrorLength, "penetration.max of bodies of triangles alone", true},
      {"penetration.mesh.peak", kErrorLength, "penetration.peak of bodies of triangles alone",
       false, Window::run},
      {"penetration.mesh.mean", kErrorLength, "penetration.mean of bodies of triangles alone"},
      {"penetration.share", kErrorShare,
       "share of the free vertices that are below a surface, mean over the last second", true},
      {"penetration.gap", kSignedLength,
       "least distance of a free vertex to a collider minus the scene's thickness, mean over the "
       "last second: positive where the cloth hovers, negative where it eats into the thickness",
       true},
  };
  static bool measures(const Scene& scene) {
    return !scene.colliders.empty() && !free_vertices(scene).empty();
  }
  explicit Penetration(const Scene& scene)
      : colliders_(scene.colliders),
        thickness_(scene.thickness),
        free_(free_vertices(scene)),
        end_(scene) {
    for (const Collider& c : colliders_) exists_[c.shape.index()] = true;
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step);
    const Contact contact = measure(m);
    const auto add = [&](Kind& kind, const Depths& d) {
      kind.max.add(m.step, at_end, d.max);
      kind.mean.add(m.step, at_end, d.mean());
    };
    add(any_, contact.any);
    for (std::size_t k = 0; k < kKinds; ++k)
      if (exists_[k]) add(kinds_[k], contact.kinds[k]);
    share_.add(m.step, at_end, share(contact));
    gap_.add(m.step, at_end, contact.least - thickness_);
  }

  std::vector<double> finish() override {
    std::vector<double> values{any_.max.max(), any_.max.peak(), any_.mean.mean()};
    for (const Kind& k : kinds_)
      values.insert(values.end(), {k.max.max(), k.max.peak(), k.mean.mean()});
    values.insert(values.end(), {share_.mean(), gap_.mean()});
    return values;
  }

  std::vector<double> now(const Snapshot& m) const override {
    constexpr double none = Summary::kNone;
    const Contact contact = measure(m);
    std::vector<double> values{contact.any.max, none, none};
    for (std::size_t k = 0; k < kKinds; ++k)
      values.insert(values.end(), {exists_[k] ? contact.kinds[k].max : none, none, none});
    values.insert(values.end(), {share(contact), contact.least - thickness_});
    return values;
  }

 private:
  struct Contact {
    Depths any;  ///< in the deepest collider of each vertex
    std::array<Depths, kKinds> kinds;
    double least = std::numeric_limits<double>::infinity();  ///< m, least signed distance
  };
  Contact measure(const Snapshot& m) const {
    Contact contact;
    std::vector<double> nearest(free_.size(), std::numeric_limits<double>::infinity());
    for (const Collider& collider : colliders_) {
      const Shape shape = shape_at(collider, m.t);
      Depths& kind = contact.kinds[shape.index()];
      for (std::size_t k = 0; k < free_.size(); ++k) {
        const double distance = surface(shape, m.state.x[free_[k]]).distance;
        kind.add(-distance);
        nearest[k] = std::min(nearest[k], distance);
      }
    }
    for (const double distance : nearest) {
      contact.any.add(-distance);
      contact.least = std::min(contact.least, distance);
    }
    return contact;
  }
  double share(const Contact& c) const { return c.any.count / static_cast<double>(free_.size()); }

  struct Kind {
    Summary max, mean;
  };
  std::vector<Collider> colliders_;
  double thickness_;
  std::vector<std::size_t> free_;
  LastSecond end_;
  std::array<bool, kKinds> exists_{};
  Kind any_;
  std::array<Kind, kKinds> kinds_;
  Summary share_, gap_;
};

}  // namespace

TAUT_METRIC(penetration, Penetration,
            "How deep vertices are in colliders after the last pass of the step",
            "max(0, -signed distance), exact for plane, ball, box, capsule and triangles");

}  // namespace taut
