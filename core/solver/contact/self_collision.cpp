#include "core/solver/contact/self_collision.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "core/model/adjacency.hpp"
#include "core/solver/contact/neighbour_grid.hpp"
#include "core/solver/contact/projector.hpp"

namespace taut {

namespace {

/// Self-collision of the cloth: every particle is a ball, and no two balls may overlap. A uniform
/// grid finds the pairs, which are projected in every sweep. OctreePass (octree.cpp) lacks three
/// things:
///
/// - Pairs are found wherever they are, not only within one cell.
/// - Two particles keep at most their distance at rest, so that neighbours do not push each other
///   if the radius is larger than the spacing (M. Mueller, Ten Minute Physics 15). Linked particles
///   within 3/2 diameters are left to their link.
/// - Two particles that have changed sides since the step began go back, so that a layer that
///   arrives fast, by up to four diameters a step, does not pass between.
///
/// In a cloth that moves fast, the pairs of a step are those within 3/2 diameters plus their
/// relative motion in the step, which leaves half a diameter for the sweeps. In a slow cloth they
/// are those within a diameter and a skin, and are used until a particle has moved by a quarter of
/// the skin relative to the cloth as a whole (L. Verlet, 1967): a cloth at rest does not search at
/// all. Pairs within 3/2 diameters at rest are known from the start and never searched for; a sheet
/// that does not touch itself has few others.
///
/// With a solver that has a target y, a pair keeps the push c [m] from a to b that parts it, from
/// sweep to sweep and from substep to substep. Its length is what would be needed if a and b were
/// free:
///
///     c' = n max(0, least - n . (d - c)),    d = x_b - x_a,  n = d/|d|
///
/// c' - c moves x and y alike, so that links feel the force m/h^2 c, m = 1/(w_a + w_b). Once the
/// sweeps have converged, c is the multiplier of Signorini's conditions. Links that are not
/// compressed hold a pair back: it yields at most as its free masses do, so that c' does not
/// overshoot. Compressed links may let it yield more.
template <class Real>
class SelfCollidePass final : public Pass<Real> {
 public:
  /// solver: the pass of the links if it has a target, which moves with the particles; otherwise
  /// null.
  SelfCollidePass(const Scene& scene, Simd simd, Pass<Real>* solver, ThreadPool& pool)
      : diameter_(static_cast<Real>(2 * scene.self_collision->radius)),
        kernels_(kernels<Real>(simd)),
        solver_(solver),
        pool_(pool),
        grid_(scene.start.x.size(), pool, simd),
        close_(3 * grid_.parts()),
        close_found_(3 * grid_.parts()),
        others_found_(3 * grid_.parts()),
        motions_(grid_.parts()) {
    find_close_at_rest(scene);
  }

  void restart() override {
    searched_ = false;
    forget_pairs();
    kept_.clear();
  }

  void begin(Particles<Real>& p, double, double h) override {
    if (!placed_) place(p);
    find_pairs(p);
    if (solver_) stride_ == 1 ? begin_pushes<true>(p, h) : begin_pushes<false>(p, h);
  }

  void apply(Particles<Real>& p, double, double) override {
    stride_ == 1 ? sweep<true>(p.x) : sweep<false>(p.x);
  }

  std::vector<PassCost> cost() const override {
    std::size_t pairs = 0, bytes = sizeof(*this) + grid_.bytes() + searched_at_.bytes() +
                                   motions_.size() * sizeof(Motions);
    for (const auto& list : close_) bytes += list.capacity() * sizeof(Pair);
    for (const auto* lists : {&close_found_, &others_found_})
      for (const Found& found : *lists) {
        pairs += found.pairs.size();
        bytes += sizeof found + found.pairs.capacity() * sizeof(Pair) +
                 found.crossing.capacity() * sizeof(Crossing) +
                 found.pushes.capacity() * sizeof(Vec4T<Real>);
      }
    return {{.pass = "self-collide", .items = pairs, .bytes = bytes}};
  }

 private:
  struct Pair {
    std::uint32_t a, b;  ///< slots of the particles
    Real least;          ///< m
    Real share;          ///< of the correction that moves a: w_a / (w_a + w_b)
  };
  /// A pair that may swap sides in this step.
  struct Crossing : Pair {
    Vec4T<Real> before;  ///< from a to b when the step began [m]
  };
  /// The pairs of one list of the grid.
  struct alignas(64) Found {
    std::vector<Pair> pairs;
    std::vector<Crossing> crossing;
    std::vector<Vec4T<Real>> pushes;  ///< [pairs] m, c; empty without a solver's target
  };
  struct Push {
    std::uint64_t pair;
    std::array<Real, 3> by;  ///< m, push on the particle with the larger slot
  };
  /// Bounds of the motions of some of the particles.
  struct alignas(64) Motions {
    MotionBoxes<Real> boxes;
    Real largest2;  ///< m^2
  };

  void find_pairs(Particles<Real>& p) {
    const auto [step, search] = motion_boxes(p, searched_ ? searched_at_ : p.previous);
    const auto motion = [&](const auto& box) { return largest_motion(p, p.previous, box); };
    if (moved_more(p, p.previous, step, diameter_ / 8)) {
      stride_ == 1 ? search_step<true>(p, motion(step)) : search_step<false>(p, motion(step));
    } else if (!searched_ || moved_more(p, searched_at_, search, skin_ / 4)) {
      search_steps(p, motion(step));
      remember_places(p);
    }
  }

  template <bool packed>
  void sweep(Points<Real>& x) {
    for_found(&Found::crossing, [this, &x](const Found& found) {
      for (const Crossing& pair : found.crossing) {
        const Vec4T<Real> now = between<packed>(x, pair);
        if (dot(now, pair.before) < 0 && passed(pair.before, now, pair.least))
          separate<packed>(x, pair, pair.before);
      }
    });
    if (solver_)
      for_found(&Found::pairs, [this, &x, &y = *solver_->target()](Found& found) {
        for (std::size_t k = 0; k < found.pairs.size(); ++k)
          push<packed>(x, y, found.pairs[k], found.pushes[k]);
      });
    else
      for_found(&Found::pairs, [this, &x](const Found& found) {
        for (const Pair& pair : found.pairs) {
          const Vec4T<Real> now = between<packed>(x, pair);
          if (squared_norm(now) < pair.least * pair.least) separate<packed>(x, pair, now);
        }
      });
    pool_.finish();
  }

  /// Queues f(list) for all lists that have any of these pairs, those close at rest first. Lists
  /// run at the same time only if they share no particle, so that threads change nothing.
  template <class P, class F>
  void for_found(std::vector<P> Found::*pairs, const F& f) {
    const std::size_t parts = grid_.parts();
    for (auto* found : {&close_found_, &others_found_}) {
      const auto empty = [&](const Found& list) { return (list.*pairs).empty(); };
      if (std::ranges::all_of(*found, empty)) continue;
      const auto visit = [f, lists = found->data()](std::size_t n) { f(lists[n]); };
      pool_.queue(
          parts,
          [visit](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) visit(n);
          },
          parts > 1);
      pool_.queue_pairs(
          parts, [visit, parts](std::size_t n) { visit(parts + n); }, parts > 1);
      pool_.finish();  // the remaining lists are of other parts
      for (std::size_t n = 2 * parts; n < found->size(); ++n) visit(n);
    }
  }

  template <bool packed>
  [[gnu::always_inline]] Vec4T<Real> between(const Points<Real>& x, const Pair& pair) const {
    return load_vec4<packed>(x.data() + pair.b, stride_) -
           load_vec4<packed>(x.data() + pair.a, stride_);
  }
  template <bool packed>
  void move(Points<Real>& x, std::size_t slot, const Vec4T<Real>& by) const {
    Real* const r = x.data() + slot;
    store_vec4<packed>(r, stride_, load_vec4<packed>(r, stride_) + by);
  }

  /// Whether the path from `before` to `now` comes nearer to the origin than `least`.
  static bool passed(const Vec4T<Real>& before, const Vec4T<Real>& now, Real least) {
    const Vec4T<Real> way = now - before;
    const Real share = std::clamp(-dot(before, way) / squared_norm(way), Real(0), Real(1));
    return squared_norm(before + share * way) < least * least;
  }

  /// Moves the two apart along `out` until they are pair.least apart in that direction.
  template <bool packed>
  void separate(Points<Real>& x, const Pair& pair, const Vec4T<Real>& out) const {
    const Real length = std::sqrt(squared_norm(out));
    if (!(length > 0)) return;  // both are at one point: no direction is better than another
    const Real gap = dot(out, between<packed>(x, pair)) / length;
    const Real push = (pair.least - gap) / length;
    move<packed>(x, pair.a, -pair.share * push * out);
    move<packed>(x, pair.b, (1 - pair.share) * push * out);
  }

  template <bool packed>
  void part(Points<Real>& x, const Pair& pair, const Vec4T<Real>& by) const {
    move<packed>(x, pair.a, -pair.share * by);
    move<packed>(x, pair.b, (1 - pair.share) * by);
  }

  template <bool packed>
  void push(Points<Real>& x, Points<Real>& y, const Pair& pair, Vec4T<Real>& held) const {
    const Vec4T<Real> way = between<packed>(x, pair);
    const Real length = std::sqrt(squared_norm(way)), held2 = squared_norm(held);
    if (!(length > 0) || (length >= pair.least && held2 == 0)) return;
    const Vec4T<Real> out = Real(1) / length * way;
    const Vec4T<Real> now = std::max(Real(0), pair.least - length + dot(out, held)) * out;
    const Vec4T<Real> change = now - held;
    part<packed>(x, pair, change);
    part<packed>(y, pair, change);
    held = now;
  }

  /// Key of a pair, the same for a, b and b, a.
  static std::uint64_t name_of(const Pair& pair) {
    const auto [less, more] = std::minmax(pair.a, pair.b);
    return std::uint64_t{less} << 32 | more;
  }

  /// Keeps the pushes before pairs are found anew.
  void keep_pushes() {
    kept_.clear();
    for (const auto* lists : {&close_found_, &others_found_})
      for (const Found& found : *lists)
        for (std::size_t k = 0; k < found.pushes.size(); ++k)
          if (squared_norm(found.pushes[k]) > 0) {
            const Real sign = found.pairs[k].a < found.pairs[k].b ? 1 : -1;
            const Vec4T<Real> by = sign * found.pushes[k];
            kept_.push_back({name_of(found.pairs[k]), {by.v[0], by.v[1], by.v[2]}});
          }
    std::ranges::sort(kept_, {}, &Push::pair);
  }

  /// Applies the pushes of the last substep at the start of this one; p.x is y.
  template <bool packed>
  void begin_pushes(Particles<Real>& p, double h) {
    const Real scale = pushed_for_ > 0 ? static_cast<Real>(h * h / (pushed_for_ * pushed_for_)) : 1;
    pushed_for_ = h;
    for (auto* lists : {&close_found_, &others_found_})
      for (Found& found : *lists) {
        if (found.pushes.size() != found.pairs.size()) recall_pushes(found);
        for (std::size_t k = 0; k < found.pairs.size(); ++k) {
          if (squared_norm(found.pushes[k]) == 0) continue;
          found.pushes[k] = scale * found.pushes[k];
          part<packed>(p.x, found.pairs[k], found.pushes[k]);
        }
      }
  }
  void recall_pushes(Found& found) const {
    found.pushes.assign(found.pairs.size(), Vec4T<Real>{});
    if (kept_.empty()) return;
    for (std::size_t k = 0; k < found.pairs.size(); ++k) {
      const std::uint64_t name = name_of(found.pairs[k]);
      const auto at = std::ranges::lower_bound(kept_, name, {}, &Push::pair);
      if (at == kept_.end() || at->pair != name) continue;
      const Real sign = found.pairs[k].a < found.pairs[k].b ? 1 : -1;
      found.pushes[k].v = sign * typename Vec4T<Real>::V{at->by[0], at->by[1], at->by[2], 0};
    }
  }

  void place(const Particles<Real>& p) {
    stride_ = p.layout->stride();
    for (auto& list : close_)
      for (Pair& pair : list) pair = pair_of(p, pair.a, pair.b, pair.least);
    placed_ = true;
  }

  /// Finds the pairs of this step alone.
  template <bool packed>
  void search_step(const Particles<Real>& p, Real motion) {
    forget_pairs();
    const Real within = kNearby * diameter_;
    const auto consider = [&](Found & found, const Pair& pair) __attribute__((always_inline)) {
      const Vec4T<Real> now = between<packed>(p.x, pair),
                        before = between<packed>(p.previous, pair);
      const Real way2 = squared_norm(now - before);
      if (!less(squared_norm(now), within * within, way2)) return;
      found.pairs.push_back(pair);
      if (less(squared_norm(before), diameter_ * diameter_, 16 * way2))
        found.crossing.push_back({pair, before});
    };
    for_close([&](Found& found, const Pair& pair) { consider(found, pair); });
    const Real reach = within + std::min(2 * motion, 4 * diameter_);
    grid_.moving_pairs(p.x, p.previous, within, reach,
                       [&](std::size_t list, std::uint32_t a, std::uint32_t b) {
                         if (p.w[a] + p.w[b] != 0)
                           consider(others_found_[list], pair_of(p, a, b, diameter_));
                       });
  }

  /// Finds the pairs of this step and of those that follow.
  void search_steps(const Particles<Real>& p, Real motion) {
    forget_pairs();
    skin_ = diameter_ / 2 + 2 * motion;
    const Real reach = diameter_ + skin_;
    for_close([&](Found& found, const Pair& pair) {
      if (squared_norm(between<false>(p.x, pair)) < reach * reach) found.pairs.push_back(pair);
    });
    grid_.pairs(p.x, reach, [&](std::size_t list, std::uint32_t a, std::uint32_t b) {
      if (p.w[a] + p.w[b] != 0) others_found_[list].pairs.push_back(pair_of(p, a, b, diameter_));
    });
  }

  void remember_places(const Particles<Real>& p) {
    if (searched_at_.empty()) searched_at_ = p.x;
    pool_.run(p.layout->blocks(), [&](std::size_t begin, std::size_t end) {
      const Real* const x = p.x.data();
      const std::size_t first = p.layout->place_of_block(begin);
      std::copy(x + first, x + p.layout->place_of_block(end), searched_at_.data() + first);
    });
    searched_ = true;
  }

  void forget_pairs() {
    if (solver_) keep_pushes();
    for (auto* lists : {&close_found_, &others_found_})
      for (Found& found : *lists) {
        found.pairs.clear();
        found.crossing.clear();
        found.pushes.clear();
      }
    searched_ = false;
  }

  /// Calls f(found, pair) for the pairs close at rest, at the same time for different lists.
  template <class F>
  void for_close(const F& f) {
    pool_.run(grid_.parts(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t part = begin; part < end; ++part)
        for (std::size_t list = part; list < close_.size(); list += grid_.parts())
          for (const Pair& pair : close_[list]) f(close_found_[list], pair);
    });
  }

  /// Whether a < b + c, given their squares.
  static bool less(Real a2, Real b2, Real c2) {
    const Real more = a2 - c2 - b2;
    return more < 0 || more * more < 4 * b2 * c2;
  }

  [[gnu::always_inline]] static Pair pair_of(const Particles<Real>& p, std::uint32_t a,
                                             std::uint32_t b, Real least) {
    const Real wa = p.w[a], wb = p.w[b];
    return {static_cast<std::uint32_t>(p.layout->slot(a)),
            static_cast<std::uint32_t>(p.layout->slot(b)), least,
            wa == wb ? Real(0.5) : wa / (wa + wb)};
  }

  /// Bounds of the motions since the step began and since the particles were at `then`.
  MotionBoxes<Real> motion_boxes(Particles<Real>& p, const Points<Real>& then) {
    const ParticleSpan<Real> span = span_of(p, p.x);
    pool_.run_parts(motions_.size(), span.parts(),
                    [&](std::size_t n, std::size_t begin, std::size_t end) {
                      motions_[n].boxes = kernels_.motion_boxes(span, then.data(), begin, end);
                    });
    MotionBoxes<Real> all = motions_.front().boxes;
    const auto add = [](MotionBox<Real>& to, const MotionBox<Real>& box) {
      const auto& [least, most] = box;
      to.least = {lesser(to.least.x, least.x), lesser(to.least.y, least.y),
                  lesser(to.least.z, least.z)};
      to.most = {greater(to.most.x, most.x), greater(to.most.y, most.y),
                 greater(to.most.z, most.z)};
    };
    for (const Motions& some : motions_) {
      add(all.since_previous, some.boxes.since_previous);
      add(all.since_then, some.boxes.since_then);
    }
    return all;
  }

  /// Square of the largest motion of a particle relative to the cloth as a whole since it was at
  /// `then` [m^2]; two particles move relative to each other by at most twice that. The motion of
  /// the cloth is the middle of the box of all motions.
  Real largest_motion2(Particles<Real>& p, const Points<Real>& then, const MotionBox<Real>& box) {
    const ParticleSpan<Real> span{p.x.data(), then.data(), p.layout->sheet(), p.size()};
    const Vec3T<Real> middle = Real(0.5) * (box.least + box.most);
    pool_.run_parts(motions_.size(), span.parts(),
                    [&](std::size_t n, std::size_t begin, std::size_t end) {
                      motions_[n].largest2 = kernels_.largest_motion2(span, middle, begin, end);
                    });
    Real largest = 0;
    for (const Motions& some : motions_) largest = greater(largest, some.largest2);
    return largest;
  }
  Real largest_motion(Particles<Real>& p, const Points<Real>& then, const MotionBox<Real>& box) {
    return std::sqrt(largest_motion2(p, then, box));
  }

  /// Whether the largest motion is at least `distance`. The box alone mostly decides this: the
  /// largest motion is at most half its diagonal and at least half its longest side.
  bool moved_more(Particles<Real>& p, const Points<Real>& then, const MotionBox<Real>& box,
                  Real distance) {
    const Vec3T<Real> sides = box.most - box.least;
    if (norm(sides) * Real(0.5001) < distance) return false;
    if (greater(greater(sides.x, sides.y), sides.z) * Real(0.4999) >= distance) return true;
    return largest_motion2(p, then, box) >= distance * distance;
  }

  void find_close_at_rest(const Scene& scene) {
    const std::size_t n = scene.mesh.rest.size();
    Points<Real> rest(std::make_shared<const Layout>(Layout::packed(n)));
    for (std::size_t i = 0; i < n; ++i) rest.set(i, scene.mesh.rest[i].template cast<Real>());
    const std::vector<double> w = inverse_masses(scene);
    const Adjacency links(scene.links, static_cast<int>(n));
    grid_.pairs(rest, kNearby * diameter_, [&](std::size_t list, std::uint32_t a, std::uint32_t b) {
      const auto leads_to_b = [b](const Adjacency::End& end) { return to_index(end.vertex) == b; };
      const auto ends = links.of(static_cast<int>(a));
      const Real distance = (rest[b] - rest[a]).norm();
      if (w[a] + w[b] != 0 && distance > 0 && std::ranges::none_of(ends, leads_to_b))
        close_[list].push_back({a, b, std::min(distance, diameter_), 0});
    });
    grid_.ignore(rest, kNearby * diameter_);
  }

  static constexpr Real kNearby = Real(1.5);  ///< diameters within which a pair may touch in a step
  Real diameter_;                             ///< m
  std::size_t stride_ = 1;                    ///< of the particles' layout
  const Kernels<Real>& kernels_;
  Pass<Real>* solver_;      ///< null: no solver with a target
  std::vector<Push> kept_;  ///< pushes of the pairs before the last search
  double pushed_for_ = 0;   ///< s, substep of the pushes; 0: none
  ThreadPool& pool_;
  NeighbourGrid<Real> grid_;
  /// [lists of the grid at rest] pairs within kNearby diameters at rest that are not linked.
  std::vector<std::vector<Pair>> close_;
  bool placed_ = false;              ///< false: close_ has numbers of particles, not slots
  std::vector<Found> close_found_;   ///< [lists of close_]
  std::vector<Found> others_found_;  ///< [lists of the grid]
  std::vector<Motions> motions_;
  Real skin_ = 0;             ///< m
  Points<Real> searched_at_;  ///< m
  bool searched_ = false;
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_self_collision(const Scene& scene, Simd simd, Pass<Real>* solver,
                                                ThreadPool& pool) {
  return std::make_unique<SelfCollidePass<Real>>(scene, simd, solver, pool);
}
template std::unique_ptr<Pass<float>> make_self_collision(const Scene&, Simd, Pass<float>*,
                                                          ThreadPool&);
template std::unique_ptr<Pass<double>> make_self_collision(const Scene&, Simd, Pass<double>*,
                                                           ThreadPool&);

}  // namespace taut
