#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// How fast vertices that touch a body with friction get along its surface, relative to the body,
/// from the ends of steps and the body's motion alone. It is 0 where friction holds them, and the
/// speed of sliding where it does not. A vertex touches a body while it is inside, or at most
///
///     thickness + 2 |g| dt^2 + 1e-4 L,   L the extent of the cloth,
///
/// outside: a solver that sees a contact only at a predicted place rests at g dt^2. The way from
/// where the window begins to where it ends counts, so that a vertex that trembles about its place
/// does not creep. Of bodies that move apart a vertex can follow one: that one counts.
class ContactCreep final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "contact.creep",
       .unit = kSpeed,
       .help = "largest distance along the surface, relative to the body, by which a vertex that "
               "touches a body with friction throughout the last second gets on in it, per second; "
               "0 if friction holds",
       .title = "creep of vertices in contact"},
  };
  static bool measures(const Scene& scene) {
    return std::ranges::any_of(scene.colliders, is_rough) && !free_vertices(scene).empty();
  }
  explicit ContactCreep(const Scene& scene)
      : near_(scene.thickness + 2 * scene.gravity.norm() * scene.dt * scene.dt +
              1e-4 * extent(scene)),
        free_(free_vertices(scene)),
        end_(scene) {
    for (const Collider& collider : scene.colliders)
      if (is_rough(collider)) bodies_.push_back({collider, {}});
  }

  void observe(const Snapshot& m) override {
    if (end_.contains(m.step)) {
      for (Body& body : bodies_) follow(body, m);
    } else if (end_.contains(m.step + 1)) {
      for (Body& body : bodies_) begin(body, m);
      began_ = m.t;
    } else {
      return;
    }
    t_ = m.t;
  }
  std::vector<double> finish() override {
    std::vector<double> ways(free_.empty() ? 0 : free_.back() + 1, Summary::kInfinity);
    for (const Body& body : bodies_)
      for (const Touch& touch : body.touches)
        ways[touch.vertex] = std::min(ways[touch.vertex], (touch.x - touch.from).norm());
    std::erase(ways, Summary::kInfinity);
    return {ways.empty() ? Summary::kNone : std::ranges::max(ways) / (t_ - began_)};
  }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  struct Touch {
    std::size_t vertex;
    Vec3 x;     ///< m
    Vec3 from;  ///< m, where it would be if it had moved along with the surface
  };
  struct Body {
    Collider collider;
    std::vector<Touch> touches;  ///< those that last since the window began
  };
  static bool is_rough(const Collider& collider) { return collider.friction > 0; }

  void begin(Body& body, const Snapshot& m) const {
    const Shape shape = shape_at(body.collider, m.t);
    for (const std::size_t i : free_) {
      const Vec3& x = m.state.x[i];
      if (surface(shape, x).distance <= near_) body.touches.push_back({i, x, x});
    }
  }
  void follow(Body& body, const Snapshot& m) const {
    if (body.touches.empty()) return;
    std::vector<Vec3> points;
    for (const Touch& touch : body.touches) points.insert(points.end(), {touch.x, touch.from});
    points = carried(body.collider, t_, m.t - t_, points);
    const Shape shape = shape_at(body.collider, m.t);
    std::vector<Touch> last;
    for (std::size_t k = 0; k < body.touches.size(); ++k) {
      const std::size_t i = body.touches[k].vertex;
      const Vec3 &x = m.state.x[i], &before = points[2 * k], &from = points[2 * k + 1];
      const auto [distance, normal] = surface(shape, x);
      if (distance <= near_) last.push_back({i, x, from + normal.dot(x - before) * normal});
    }
    body.touches = std::move(last);
  }

  double near_;  ///< m
  std::vector<std::size_t> free_;
  LastSecond end_;
  std::vector<Body> bodies_;  ///< with friction
  double began_ = 0, t_ = 0;  ///< s
};

}  // namespace

TAUT_METRIC(contact_creep, ContactCreep, "Whether vertices that friction should hold creep",
            "displacement relative to the body without its normal parts, from step ends alone");

}  // namespace taut
