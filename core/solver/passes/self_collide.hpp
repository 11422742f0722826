#pragma once

#include "core/model/scene.hpp"
#include "core/solver/contact/neighbours.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// The cloth against itself: every particle is a ball, no two may overlap. Pairs come from a hash
/// grid, found once a substep and projected in every sweep. Three things the report's octree lacks:
///
/// - pairs are found wherever they are, not only within one cell;
/// - two particles keep at most their distance at rest, so that a radius larger than the spacing
///   does not make neighbours fight (M. Mueller, Ten Minute Physics 15), and linked ones are left
///   to their link;
/// - two particles that have changed sides since the step began go back, so that a layer that
///   arrives fast, by up to four diameters a step, does not pass between.
///
/// The pairs are those within a diameter and a skin. They serve until a particle has moved a
/// quarter of the skin against the cloth as a whole (L. Verlet, 1967): a cloth at rest does not
/// search at all. A cloth so fast that the skin serves one step alone keeps only those pairs that
/// may meet in it, by their own motion.
template <class Real>
class SelfCollidePass final : public Pass<Real> {
 public:
  explicit SelfCollidePass(const Scene& scene)
      : diameter_(static_cast<Real>(2 * scene.self_collision->radius)),
        neighbours_(scene.start.x.size()) {
    for (const Vec3& x : scene.mesh.rest) rest_.push_back(x.cast<Real>());
    link(scene);
  }

  void restart() override { searched_at_.clear(); }

  void begin(Particles<Real>& p, double, double) override {
    const Real motion = largest_motion(p.x, p.previous);
    const bool fresh = !searched_at_.empty() && 4 * motion_since_search(p.x) <= skin_;
    if (!fresh) search(p, motion);
    fast_.clear();
    if (8 * motion < diameter_) return;  // nothing can come from one side to the other
    for (const Pair& pair : pairs_)
      if ((p.previous[pair.b] - p.previous[pair.a]).squaredNorm() < 16 * motion * motion)
        fast_.push_back(pair);
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Pair& pair : fast_) {
      const Point before = p.previous[pair.b] - p.previous[pair.a];
      const Point now = p.x[pair.b] - p.x[pair.a];
      if (now.dot(before) < 0 && passed(before, now, pair.least)) separate(p, pair, before);
    }
    for (const Pair& pair : pairs_) {
      const Point now = p.x[pair.b] - p.x[pair.a];
      if (now.squaredNorm() < pair.least * pair.least) separate(p, pair, now);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "self-collide",
             .items = pairs_.size(),
             .bytes = sizeof(*this) + neighbours_.bytes() + 2 * rest_.size() * sizeof(Point) +
                      (pairs_.capacity() + fast_.capacity()) * sizeof(Pair) +
                      (links_.size() + first_link_.size()) * sizeof(std::uint32_t)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Pair {
    std::uint32_t a, b;
    Real least;  ///< m
  };

  /// Whether the way from `before` to `now` comes nearer to the origin than `least`.
  static bool passed(const Point& before, const Point& now, Real least) {
    const Point way = now - before;
    const Real share = std::clamp(-before.dot(way) / way.squaredNorm(), Real(0), Real(1));
    return (before + share * way).squaredNorm() < least * least;
  }

  /// Moves the two apart along `out` until they are pair.least apart in that direction.
  static void separate(Particles<Real>& p, const Pair& pair, const Point& out) {
    const Real length = out.norm();
    if (!(length > 0)) return;  // at one place: no direction is better than another
    const Point a = p.x[pair.a], b = p.x[pair.b];
    const Real push =
        (pair.least - out.dot(b - a) / length) / ((p.w[pair.a] + p.w[pair.b]) * length);
    p.x.set(pair.a, a - p.w[pair.a] * push * out);
    p.x.set(pair.b, b + p.w[pair.b] * push * out);
  }

  void search(const Particles<Real>& p, Real motion) {
    skin_ = diameter_ / 2 + std::min(2 * motion, 4 * diameter_);
    const bool one_step = skin_ < 4 * motion;
    pairs_.clear();
    neighbours_.pairs(p.x, diameter_ + skin_, [&](std::uint32_t a, std::uint32_t b) {
      if (one_step && !may_meet(p, a, b)) return;
      const Real rest2 = (rest_[b] - rest_[a]).squaredNorm();
      const bool near_at_rest = rest2 < diameter_ * diameter_ * Real(1.01);
      if (p.w[a] + p.w[b] == 0 || (near_at_rest && linked(a, b))) return;
      pairs_.push_back({a, b, near_at_rest ? std::min(diameter_, std::sqrt(rest2)) : diameter_});
    });
    searched_at_.clear();
    if (one_step) return;
    for (std::size_t i = 0; i < p.size(); ++i) searched_at_.push_back(p.x[i]);
  }

  /// (diameter + half of it + way)^2 <= 2 ((3/2 diameter)^2 + way^2).
  bool may_meet(const Particles<Real>& p, std::uint32_t a, std::uint32_t b) const {
    const Point now = p.x[b] - p.x[a], before = p.previous[b] - p.previous[a];
    return now.squaredNorm() <
           2 * (Real(2.25) * diameter_ * diameter_ + (now - before).squaredNorm());
  }

  /// The largest of a particle against the cloth as a whole, between two times [m].
  template <class Now, class Then>
  Real largest_motion(const Now& now, const Then& then) const {
    Point mean = Point::Zero();
    for (std::size_t i = 0; i < rest_.size(); ++i) mean += now[i] - then[i];
    mean /= static_cast<Real>(rest_.size());
    Real largest2 = 0;
    for (std::size_t i = 0; i < rest_.size(); ++i)
      largest2 = std::max(largest2, (now[i] - then[i] - mean).squaredNorm());
    return std::sqrt(largest2);
  }
  Real motion_since_search(const Points<Real>& x) const { return largest_motion(x, searched_at_); }

  void link(const Scene& scene) {
    std::vector<std::vector<std::uint32_t>> lists(rest_.size());
    for (const Link& l : scene.links) {
      lists[static_cast<std::size_t>(l.a)].push_back(static_cast<std::uint32_t>(l.b));
      lists[static_cast<std::size_t>(l.b)].push_back(static_cast<std::uint32_t>(l.a));
    }
    for (const auto& list : lists) {
      first_link_.push_back(static_cast<std::uint32_t>(links_.size()));
      links_.insert(links_.end(), list.begin(), list.end());
    }
    first_link_.push_back(static_cast<std::uint32_t>(links_.size()));
  }
  bool linked(std::uint32_t a, std::uint32_t b) const {
    const auto begin = links_.begin() + first_link_[a], end = links_.begin() + first_link_[a + 1];
    return std::find(begin, end, b) != end;
  }

  Real diameter_;  ///< m
  Neighbours<Real> neighbours_;
  std::vector<Point> rest_;
  std::vector<std::uint32_t> first_link_, links_;  ///< partners of particle i: [first, next first)
  Real skin_ = 0;                                  ///< m
  std::vector<Point> searched_at_;                 ///< [n] m; empty: to be searched
  std::vector<Pair> pairs_, fast_;  ///< fast: may come from one side to the other in this step
};

}  // namespace taut
