#pragma once

#include "core/model/scene.hpp"
#include "core/solver/contact/neighbours.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// The cloth against itself: every particle is a ball, no two may overlap. Pairs come from a hash
/// grid and are projected in every sweep. Three things the report's octree lacks:
///
/// - pairs are found wherever they are, not only within one cell;
/// - two particles keep at most their distance at rest, so that a radius larger than the spacing
///   does not make neighbours fight (M. Mueller, Ten Minute Physics 15), and those that are linked
///   within 3/2 diameters are left to their link;
/// - two particles that have changed sides since the step began go back, so that a layer that
///   arrives fast, by up to four diameters a step, does not pass between.
///
/// In a cloth that moves fast, the pairs of a step are those within 3/2 diameters and their own way
/// in it: half a diameter is left for what the sweeps do to them. In a slow one they are those
/// within a diameter and a skin, and serve until a particle has moved a quarter of the skin against
/// the cloth as a whole (L. Verlet, 1967): a cloth at rest does not search at all.
template <class Real>
class SelfCollidePass final : public Pass<Real> {
 public:
  SelfCollidePass(const Scene& scene, Simd simd)
      : diameter_(static_cast<Real>(2 * scene.self_collision->radius)),
        neighbours_(scene.start.x.size(), simd) {
    find_close_at_rest(scene);
  }

  void restart() override { searched_at_.clear(); }

  void begin(Particles<Real>& p, double, double) override {
    stride_ = p.layout->stride();
    const Real motion = largest_motion(p.x, p.previous);
    if (8 * motion >= diameter_)
      search_step(p, motion);
    else if (searched_at_.empty() || 4 * largest_motion(p.x, searched_at_) > skin_)
      search_steps(p, motion);
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Crossing& pair : crossing_) {
      const Triple<Real> now = between(p.x, pair);
      if (dot(now, pair.before) < 0 && passed(pair.before, now, pair.least))
        separate(p, pair, pair.before);
    }
    for (const Pair& pair : pairs_) {
      const Triple<Real> now = between(p.x, pair);
      if (squared_norm(now) < pair.least * pair.least) separate(p, pair, now);
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "self-collide",
             .items = pairs_.size(),
             .bytes = sizeof(*this) + neighbours_.bytes() +
                      searched_at_.capacity() * sizeof searched_at_[0] +
                      pairs_.capacity() * sizeof(Pair) + crossing_.capacity() * sizeof(Crossing) +
                      close_.size() * sizeof(CloseAtRest) +
                      first_close_.size() * sizeof(std::uint32_t)}};
  }

 private:
  struct Pair {
    std::uint32_t a, b;  ///< slots
    Real least;          ///< m
    Real share;          ///< of a in their parting: w_a / (w_a + w_b)
  };
  /// A pair that may come from one side to the other in this step.
  struct Crossing : Pair {
    Triple<Real> before;  ///< from a to b when the step began [m]
  };
  struct CloseAtRest {
    std::uint32_t partner;
    Real least;  ///< m; 0: left to their link
  };

  [[gnu::always_inline]] Triple<Real> between(const Points<Real>& x, const Pair& pair) const {
    const Real *a = x.data() + pair.a, *b = x.data() + pair.b;
    return {b[0] - a[0], b[stride_] - a[stride_], b[2 * stride_] - a[2 * stride_]};
  }
  void move(Points<Real>& x, std::size_t slot, Real far, const Triple<Real>& along) const {
    Real* const r = x.data() + slot;
    r[0] += far * along.x, r[stride_] += far * along.y, r[2 * stride_] += far * along.z;
  }

  /// Whether the way from `before` to `now` comes nearer to the origin than `least`.
  static bool passed(const Triple<Real>& before, const Triple<Real>& now, Real least) {
    const Triple<Real> way = now - before;
    const Real share = std::clamp(-dot(before, way) / squared_norm(way), Real(0), Real(1));
    return squared_norm(before + share * way) < least * least;
  }

  /// Moves the two apart along `out` until they are pair.least apart in that direction.
  void separate(Particles<Real>& p, const Pair& pair, const Triple<Real>& out) const {
    const Real length = norm(out);
    if (!(length > 0)) return;  // at one place: no direction is better than another
    const Real gap = dot(out, between(p.x, pair)) / length;
    const Real push = (pair.least - gap) / length;
    move(p.x, pair.a, -pair.share * push, out), move(p.x, pair.b, (1 - pair.share) * push, out);
  }

  /// Of this step alone.
  void search_step(const Particles<Real>& p, Real motion) {
    pairs_.clear(), crossing_.clear(), searched_at_.clear();
    const Real within = kMeets * diameter_;
    const Real reach = within + std::min(2 * motion, 4 * diameter_);
    neighbours_.meetings(p.x, p.previous, within, reach,
                         [&](std::uint32_t a, std::uint32_t b, const auto& apart) {
                           if (!add_pair(p, a, b)) return;
                           const Triple<Real> way = apart.way(), before = apart.now() - way;
                           const Real crosses = diameter_ + 4 * norm(way);
                           if (squared_norm(before) < crosses * crosses)
                             crossing_.push_back({pairs_.back(), before});
                         });
  }

  /// Of this step and those that follow.
  void search_steps(const Particles<Real>& p, Real motion) {
    pairs_.clear(), crossing_.clear(), searched_at_.clear();
    skin_ = diameter_ / 2 + 2 * motion;
    neighbours_.pairs(p.x, diameter_ + skin_,
                      [&](std::uint32_t a, std::uint32_t b) { add_pair(p, a, b); });
    for (std::size_t i = 0; i < p.size(); ++i) searched_at_.push_back(at(p.x, i));
  }

  bool add_pair(const Particles<Real>& p, std::uint32_t a, std::uint32_t b) {
    const Real least = least_between(a, b), wa = p.w[a], wb = p.w[b];
    if (least == 0 || wa + wb == 0) return false;
    pairs_.push_back({static_cast<std::uint32_t>(p.layout->slot(a)),
                      static_cast<std::uint32_t>(p.layout->slot(b)), least,
                      wa == wb ? Real(0.5) : wa / (wa + wb)});
    return true;
  }

  /// No early way out: so few are close that a branch costs more.
  Real least_between(std::uint32_t a, std::uint32_t b) const {
    if (b < a) std::swap(a, b);
    Real least = diameter_;
    for (std::uint32_t k = first_close_[a]; k < first_close_[a + 1]; ++k)
      least = close_[k].partner == b ? close_[k].least : least;
    return least;
  }

  static Triple<Real> at(const Points<Real>& x, std::size_t i) {
    const auto point = x[i];
    return {point.x(), point.y(), point.z()};
  }
  static Triple<Real> at(const std::vector<Triple<Real>>& x, std::size_t i) { return x[i]; }

  /// The largest of a particle against the cloth as a whole, between two times [m]: no two move by
  /// more than twice that against each other. The cloth moves as the middle of all motions.
  template <class Then>
  Real largest_motion(const Points<Real>& now, const Then& then) const {
    const std::size_t n = first_close_.size() - 1;
    Triple<Real> least = at(now, 0) - at(then, 0), most = least;
    for (std::size_t i = 1; i < n; ++i) {
      const Triple<Real> moved = at(now, i) - at(then, i);
      least = {lesser(least.x, moved.x), lesser(least.y, moved.y), lesser(least.z, moved.z)};
      most = {greater(most.x, moved.x), greater(most.y, moved.y), greater(most.z, moved.z)};
    }
    const Triple<Real> middle = Real(0.5) * (least + most);
    Real largest2 = 0;
    for (std::size_t i = 0; i < n; ++i)
      largest2 = std::max(largest2, squared_norm(at(now, i) - at(then, i) - middle));
    return std::sqrt(largest2);
  }

  void find_close_at_rest(const Scene& scene) {
    const std::size_t n = scene.mesh.rest.size();
    Points<Real> rest(std::make_shared<const Layout>(Layout::packed(n)));
    for (std::size_t i = 0; i < n; ++i) rest.set(i, scene.mesh.rest[i].template cast<Real>());
    std::vector<std::vector<CloseAtRest>> lists(n);
    std::vector<std::vector<std::uint32_t>> linked(n);
    for (const Link& link : scene.links) {
      linked[static_cast<std::size_t>(link.a)].push_back(static_cast<std::uint32_t>(link.b));
      linked[static_cast<std::size_t>(link.b)].push_back(static_cast<std::uint32_t>(link.a));
    }
    neighbours_.pairs(rest, kMeets * diameter_, [&](std::uint32_t a, std::uint32_t b) {
      const Real distance = norm(at(rest, b) - at(rest, a));
      const bool link = std::find(linked[a].begin(), linked[a].end(), b) != linked[a].end();
      if (!link && distance >= diameter_) return;
      const Real least = link ? 0 : distance;
      lists[std::min(a, b)].push_back({std::max(a, b), least});
    });
    for (const auto& list : lists) {
      first_close_.push_back(static_cast<std::uint32_t>(close_.size()));
      close_.insert(close_.end(), list.begin(), list.end());
    }
    first_close_.push_back(static_cast<std::uint32_t>(close_.size()));
  }

  static constexpr Real kMeets = Real(1.5);  ///< diameters within which a pair may meet in a step
  Real diameter_;                            ///< m
  std::size_t stride_ = 1;                   ///< of the particles' layout
  Neighbours<Real> neighbours_;
  std::vector<CloseAtRest> close_;  ///< to particle i, of a greater number: [first, next first)
  std::vector<std::uint32_t> first_close_;
  Real skin_ = 0;                          ///< m
  std::vector<Triple<Real>> searched_at_;  ///< [n] m; empty: to be searched
  std::vector<Pair> pairs_;
  std::vector<Crossing> crossing_;
};

}  // namespace taut
