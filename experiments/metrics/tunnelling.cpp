
#include "core/model/deforming_body.hpp"
#include "core/model/triangle_mesh.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Where a straight path enters and leaves a solid, and the outward unit normals there.
struct Passage {
  bool hit = false;
  double in_at = 0, out_at = 1;  ///< shares of the path
  Vec3 in = Vec3::Zero(), out = Vec3::Zero();
};

/// A solid at the origin of its own frame, in which it does not move.
struct Solid {
  double radius = 0;                 ///< > 0: a ball, or a capsule along y; 0: a box
  double half_length = 0;            ///< of the capsule's axis
  Vec3 half_extents = Vec3::Zero();  ///< of a box

  bool contains(const Vec3& p) const {
    if (radius > 0) return (p - on_axis(p.y())).squaredNorm() < radius * radius;
    return (p.cwiseAbs() - half_extents).maxCoeff() < 0;
  }
  Vec3 nearest_normal(const Vec3& p) const {
    const Shape shape = radius > 0
                            ? Shape(Capsule{on_axis(-half_length), on_axis(half_length), radius})
                            : Shape(Box{.half_extents = half_extents});
    return surface(shape, p).normal;
  }
  Passage pass(const Vec3& a, const Vec3& b) const { return radius > 0 ? round(a, b) : box(a, b); }

 private:
  /// The point of the axis at that height, or the nearer end.
  Vec3 on_axis(double y) const { return {0, std::clamp(y, -half_length, half_length), 0}; }
  /// Share of the line a + s d where it first meets the round solid; infinite if it does not. It
  /// meets the sphere about the point of the axis at whose height it enters the infinite cylinder,
  /// or about the end on that side.
  double first(const Vec3& a, const Vec3& d) const {
    const double across2 = d.x() * d.x() + d.z() * d.z(), toward = a.x() * d.x() + a.z() * d.z(),
                 above = a.x() * a.x() + a.z() * a.z() - radius * radius,
                 within = toward * toward - across2 * above;
    double height = d.y() > 0 ? -half_length : half_length;  // for a line along the axis
    if (across2 > 0)
      height = a.y() + (-toward - std::sqrt(std::max(within, 0.0))) / across2 * d.y();
    const Vec3 from = a - on_axis(height);
    const double dd = d.squaredNorm(), ad = from.dot(d),
                 discriminant = ad * ad - dd * (from.squaredNorm() - radius * radius);
    if (dd == 0 || discriminant <= 0) return Summary::kInfinity;
    return (-ad - std::sqrt(discriminant)) / dd;
  }
  Passage round(const Vec3& a, const Vec3& b) const {
    const Vec3 d = b - a;
    const double in = first(a, d), out = -first(a, -d);
    if (!std::isfinite(in) || !std::isfinite(out)) return {};
    const auto normal = [&](double s) { return nearest_normal(a + s * d); };
    return {true, in, out, normal(in), normal(out)};
  }
  Passage box(const Vec3& a, const Vec3& b) const {
    Passage p{true, -Summary::kInfinity, Summary::kInfinity, {}, {}};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double d = b[axis] - a[axis], h = half_extents[axis];
      if (d == 0) {
        if (std::abs(a[axis]) >= h) return {};
        continue;
      }
      const double side = d > 0 ? 1 : -1;
      const double in = (-side * h - a[axis]) / d, out = (side * h - a[axis]) / d;
      if (in > p.in_at) {
        p.in_at = in;
        p.in = -side * Vec3::Unit(axis);
      }
      if (out < p.out_at) {
        p.out_at = out;
        p.out = side * Vec3::Unit(axis);
      }
    }
    p.hit = p.in_at < p.out_at && std::isfinite(p.in_at);
    return p;
  }
};

/// A rotation that puts an axis along y, whichever way it points.
Eigen::Quaterniond onto_y(const Vec3& axis) {
  const Vec3 along = (axis.y() < 0 ? -axis : axis).normalized();
  const double twice_cosine = std::sqrt(2 * (1 + along.y()));  // of half the angle
  const Vec3 sine = along.cross(Vec3::UnitY()) * (1 / twice_cosine);
  return {twice_cosine * 0.5, sine.x(), sine.y(), sine.z()};
}

/// Follows every free vertex past one collider and remembers the side on which it entered.
class SideTracker {
 public:
  SideTracker(Collider collider, std::size_t vertices)
      : collider_(std::move(collider)),
        last_(vertices),
        in_(vertices),
        inside_(vertices),
        through_(vertices) {
    if (const Ball* ball = std::get_if<Ball>(&collider_.shape)) solid_.radius = ball->radius;
    if (const Box* box = std::get_if<Box>(&collider_.shape))
      solid_.half_extents = box->half_extents;
    if (const Capsule* capsule = std::get_if<Capsule>(&collider_.shape)) {
      const Vec3 along = capsule->to - capsule->from;
      solid_.radius = capsule->radius;
      solid_.half_length = along.norm() / 2;
      if (solid_.half_length > 0) along_y_ = onto_y(along);
    }
  }

  void place(double t) {
    const Shape shape = shape_at(collider_, t);
    if (const Ball* ball = std::get_if<Ball>(&shape)) center_ = ball->center;
    if (const Box* box = std::get_if<Box>(&shape)) {
      center_ = box->center;
      to_local_ = box->rotation.conjugate().toRotationMatrix();
    }
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
      center_ = capsule->middle();
      to_local_ = (along_y_ * collider_.motion.rotation(t).conjugate()).toRotationMatrix();
    }
  }
  void start(std::size_t k, const Vec3& world) {
    last_[k] = local(world);
    inside_[k] = solid_.contains(last_[k]);
    in_[k] = solid_.nearest_normal(last_[k]);
  }
  /// Returns whether the vertex leaves on another side than the one on which it entered.
  bool move(std::size_t k, const Vec3& world) {
    const Vec3 from = last_[k], to = local(world);
    last_[k] = to;
    const Passage path = solid_.pass(from, to);
    const bool was_inside = inside_[k];
    if (!was_inside) {
      if (!path.hit || path.in_at < 0 || path.in_at > 1) return false;
      in_[k] = path.in;
    }
    inside_[k] = solid_.contains(to);
    if (inside_[k]) return false;
    const bool crossed_out = path.hit && path.out_at >= 0 && path.out_at <= 1;
    const Vec3 out = crossed_out ? path.out : solid_.nearest_normal(to);
    if (in_[k].dot(out) >= 0) return false;
    through_[k] = !through_[k];
    return true;
  }
  bool through(std::size_t k) const { return through_[k]; }

 private:
  Vec3 local(const Vec3& world) const { return to_local_ * (world - center_); }
  Collider collider_;
  Solid solid_;
  Eigen::Quaterniond along_y_ = Eigen::Quaterniond::Identity();  ///< turns a capsule's axis to y
  Vec3 center_ = Vec3::Zero();
  Eigen::Matrix3d to_local_ = Eigen::Matrix3d::Identity();
  std::vector<Vec3> last_, in_;  ///< [free vertices], in the solid's frame
  std::vector<bool> inside_, through_;
};

/// Like SideTracker for a body of triangles, by the triangles that a vertex' path crosses.
class BodyTracker {
 public:
  BodyTracker(Collider collider, std::size_t vertices)
      : collider_(std::move(collider)),
        body_(std::get<MeshBody>(collider_.shape)),
        deforming_(collider_.frames ? std::make_unique<DeformingBody>(collider_) : nullptr),
        last_(vertices),
        entered_(vertices),
        inside_(vertices),
        through_(vertices) {}

  void place(double t) {
    if (deforming_) deforming_->move(t_, t);
    body_ = deforming_ ? deforming_->body() : std::get<MeshBody>(shape_at(collider_, t));
    t_ = t;
  }
  void start(std::size_t k, const Vec3& world) {
    last_[k] = local(world);
    settle(k);
  }
  /// Returns how often the vertex leaves on another side than the one on which it entered or, for a
  /// thin body, how often it passes through.
  int move(std::size_t k, const Vec3& world) {
    const Vec3 from = last_[k], to = local(world);
    last_[k] = to;
    int passages = 0;
    double left_at = -1;  // share at an edge, which belongs to two triangles
    for (const MeshHit& hit :
         deforming_ ? deforming_->hits(from, to) : body_.mesh->hits(from, to)) {
      const Vec3& normal = body_.mesh->normal(hit.triangle);
      if (is_thin()) {
        if (hit.share > left_at + 1e-12) passages += pass(k);
        left_at = hit.share;
      } else if (hit.inward && !inside_[k]) {
        inside_[k] = true;
        entered_[k] = hit.triangle;
      } else if (!hit.inward && inside_[k]) {
        passages += leave(k, normal);
      }
    }
    if (inside_[k] && !contains(to)) passages += leave(k, nearest(to).normal);
    if (!inside_[k]) settle(k);
    return passages;
  }
  bool through(std::size_t k) const { return through_[k]; }

 private:
  bool is_thin() const { return body_.sides == MeshBody::Sides::both; }
  Vec3 local(const Vec3& world) const {
    return body_.rotation.conjugate() * (world - body_.center);
  }
  NearestPlace nearest(const Vec3& p) const { return body_.mesh->nearest(p); }
  bool contains(const Vec3& p) const {
    return !is_thin() && body_.mesh->box().contains(p) && nearest(p).distance < 0;
  }
  /// Corrects the vertex' side if rounding lost a crossing.
  void settle(std::size_t k) {
    inside_[k] = contains(last_[k]);
    if (inside_[k]) entered_[k] = nearest(last_[k]).triangle;
  }
  int pass(std::size_t k) {
    through_[k] = !through_[k];
    return 1;
  }
  int leave(std::size_t k, const Vec3& out) {
    inside_[k] = false;
    return body_.mesh->normal(entered_[k]).dot(out) < 0 ? pass(k) : 0;
  }

  Collider collider_;
  MeshBody body_;                             ///< at the last time
  std::unique_ptr<DeformingBody> deforming_;  ///< null: the body is rigid
  double t_ = 0;                              ///< s, last time
  std::vector<Vec3> last_;                    ///< [free vertices] in the body's frame
  /// [free vertices] for those inside, the triangle where they entered.
  std::vector<int> entered_;
  std::vector<bool> inside_, through_;
};

class Tunnelling final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "tunnelling.count",
       .unit = kErrorCount,
       .help = "free vertices that end on the other side of a ball, box, capsule or body of "
               "triangles: they went in through one side and out through the opposite one, even "
               "within one substep; paths are straight from substep to substep",
       .in_series = true,
       .window = Window::end,
       .title = "vertices on the other side",
       .shown_over_time = true},
      {"tunnelling.share", kErrorShare, "the same as a share of the free vertices", false,
       Window::end},
      {"tunnelling.events", kErrorCount,
       "passages through a ball, box, capsule or body over the run, returns included", false,
       Window::run, "passages through a collider", Role::passages},
  };
  static bool measures(const Scene& scene) {
    return has_solid(scene) && !free_vertices(scene).empty();
  }
  static constexpr bool kFollowsPath = true;
  explicit Tunnelling(const Scene& scene) : free_(free_vertices(scene)) {
    for (const Collider& c : scene.colliders)
      if (std::holds_alternative<MeshBody>(c.shape))
        bodies_.emplace_back(c, free_.size());
      else if (!std::holds_alternative<Plane>(c.shape))
        trackers_.emplace_back(c, free_.size());
  }

  void observe_within(const Snapshot& m) override { observe(m); }
  void observe(const Snapshot& m) override {
    follow(m, trackers_);
    follow(m, bodies_);
  }
  std::vector<double> finish() override {
    return {count(), count() / static_cast<double>(free_.size()), static_cast<double>(events_)};
  }
  std::vector<double> now(const Snapshot&) const override {
    return {count(), Summary::kNone, Summary::kNone};
  }

 private:
  template <class Tracker>
  void follow(const Snapshot& m, std::vector<Tracker>& trackers) {
    for (Tracker& tracker : trackers) {
      tracker.place(m.t);
      for (std::size_t k = 0; k < free_.size(); ++k) {
        const Vec3& x = m.state.x[free_[k]];
        if (m.step == 0)
          tracker.start(k, x);
        else
          events_ += tracker.move(k, x);
      }
    }
  }
  double count() const {
    int count = 0;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto is_through = [k](const auto& tracker) { return tracker.through(k); };
      count +=
          std::ranges::any_of(trackers_, is_through) || std::ranges::any_of(bodies_, is_through);
    }
    return count;
  }
  std::vector<std::size_t> free_;
  std::vector<SideTracker> trackers_;
  std::vector<BodyTracker> bodies_;
  int events_ = 0;
};

}  // namespace

TAUT_METRIC(tunnelling, Tunnelling, "Vertices that pass through a ball, box, capsule or body",
            "labels of sides, kept along the path in the collider's frame; a plane's solid has no "
            "other side");

}  // namespace taut
