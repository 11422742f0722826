#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "core/model/vec3.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/vectors.hpp"

namespace taut {

/// Where an array holds the coordinates of each particle: x at slot(i), y and z each stride()
/// further. A sweep chooses the layout that suits it; all other code uses Points and need not know.
class Layout {
 public:
  /// Packed layout, x y z 0 | x y z 0 | ...: particle i is at position rank[i], or at i without
  /// ranks. At the end there are at least two spare points that belong to no particle, and as many
  /// as fill the lanes.
  static Layout packed(std::size_t n, std::vector<std::uint32_t> rank = {}) {
    for (std::uint32_t& r : rank) r *= 4;
    return Layout(n, 1, 4 * (n + kLanes), std::move(rank));
  }
  /// Interleaved layout (AoSoA): vectors of coordinates x, y, z, x, ...; slots[i] is where x of
  /// particle i is.
  static Layout interleaved(std::vector<std::uint32_t> slots, const SheetRows& sheet) {
    const std::size_t n = slots.size();
    Layout layout(n, static_cast<std::size_t>(sheet.lanes),
                  static_cast<std::size_t>(sheet.rows) * sheet.stride, std::move(slots));
    layout.sheet_ = sheet;
    return layout;
  }
  Layout() = default;

  std::size_t size() const { return size_; }      ///< particles
  std::size_t length() const { return length_; }  ///< numbers in the array
  std::size_t stride() const { return stride_; }
  const SheetRows& sheet() const { return sheet_; }  ///< one lane if packed
  [[gnu::always_inline]] std::size_t slot(std::size_t i) const {
    return slots_.empty() ? 4 * i : slots_[i];
  }
  /// The slot of each particle; null: slot(i) is 4 i.
  const std::uint32_t* slots() const { return slots_.empty() ? nullptr : slots_.data(); }
  /// Coordinate of the number at `place`: 0 x, 1 y, 2 z, 3 none. Repeats every kGrain numbers.
  int axis(std::size_t place) const {
    return static_cast<int>(stride_ == 1 ? place % 4 : place / stride_ % 3);
  }
  std::size_t bytes() const { return slots_.size() * sizeof slots_[0]; }

  /// Number of blocks, at least 1. A block is a run of neighbouring particles for one thread.
  std::size_t blocks() const {
    const std::size_t used = stride_ == 1 ? 4 * size_ : to_index(sheet_.rows) * sheet_.stride;
    return std::max<std::size_t>(1, (used + block_length() - 1) / block_length());
  }
  /// Where a block begins in the array; place_of_block(blocks()) is the end of the array.
  std::size_t place_of_block(std::size_t block) const {
    return block < blocks() ? block * block_length() : length_;
  }
  std::size_t block_of(std::size_t i) const { return slot(i) / block_length(); }

 private:
  std::size_t block_length() const {
    return stride_ == 1 ? 4 * kLanes * kBlockBatches : kBlockRows * sheet_.stride;
  }
  Layout(std::size_t size, std::size_t stride, std::size_t length, std::vector<std::uint32_t> slots)
      : size_(size),
        stride_(stride),
        length_((length + kGrain - 1) / kGrain * kGrain),
        slots_(std::move(slots)) {}
  std::size_t size_ = 0, stride_ = 1, length_ = 0;
  SheetRows sheet_;
  std::vector<std::uint32_t> slots_;  ///< empty: 4 i
};

/// Allocates at cache-line boundaries, which the widest lanes need.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlign{64};
  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlign)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlign); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};

/// One point or vector per particle. Members that the innermost loops call are force-inlined: g++
/// otherwise stops inlining in a large translation unit, and contact costs twice as much.
template <class Real>
class Points {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;

  Points() = default;  ///< empty: the effect that would need it is absent
  explicit Points(std::shared_ptr<const Layout> layout)
      : layout_(std::move(layout)), values_(layout_->length(), Real(0)) {}

  bool empty() const { return values_.empty(); }
  [[gnu::always_inline]] Point operator[](std::size_t i) const {
    const Real* r = values_.data() + layout_->slot(i);
    const std::size_t s = layout_->stride();
    return {r[0], r[s], r[2 * s]};
  }
  [[gnu::always_inline]] void set(std::size_t i, const Point& p) {
    Real* r = values_.data() + layout_->slot(i);
    const std::size_t s = layout_->stride();
    r[0] = p.x();
    r[s] = p.y();
    r[2 * s] = p.z();
  }
  [[gnu::always_inline]] void add(std::size_t i, const Point& p) { set(i, (*this)[i] + p); }

  /// Calls f(at), where at(points, i) loads particle i of any points with this layout. The slots
  /// are looked up once, outside f's loop.
  template <class F>
  void read(const F& f) const {
    const std::uint32_t* const slots = layout_->slots();
    const std::size_t stride = layout_->stride();
    if (slots)
      f([ slots, stride ](const Points& points, std::size_t i) __attribute__((always_inline)) {
        return load_vec4<false>(points.data() + slots[i], stride);
      });
    else
      f([](const Points& points, std::size_t i)
            __attribute__((always_inline)) { return load_vec4<true>(points.data() + 4 * i, 1); });
  }

  /// Sets every coordinate, padding included.
  void fill(Real value) { std::ranges::fill(values_, value); }

  Real* data() { return values_.data(); }
  const Real* data() const { return values_.data(); }
  std::size_t bytes() const { return values_.size() * sizeof(Real); }

 private:
  std::shared_ptr<const Layout> layout_;
  std::vector<Real, CacheLineAllocator<Real>> values_;
};

/// The cloth as Jakobsen stores it: no velocities, only present and previous positions.
template <class Real>
struct Particles {
  using Point = typename Points<Real>::Point;

  explicit Particles(Layout how = {}) : layout(std::make_shared<const Layout>(std::move(how))) {}

  std::shared_ptr<const Layout> layout;
  Points<Real> x;         ///< positions [m]
  Points<Real> previous;  ///< positions one step ago [m]
  Points<Real> a;         ///< accelerations besides gravity [m/s^2]; empty if no force acts
  std::vector<Real> w;    ///< [n] inverse masses [1/kg]; 0: pinned
  std::size_t size() const { return layout->size(); }
};

/// Items that each belong to a vertex, sorted by the block of that vertex.
template <class Item>
class ByBlock {
 public:
  ByBlock() = default;  ///< empty
  ByBlock(std::vector<Item> items, const Layout& layout) : items_(std::move(items)) {
    if (items_.empty()) return;
    const auto block_of = [&](const Item& item) { return layout.block_of(to_index(item.vertex)); };
    std::ranges::stable_sort(items_, {}, block_of);
    for (std::size_t block = 0; block <= layout.blocks(); ++block)
      first_.push_back(static_cast<std::size_t>(
          std::ranges::lower_bound(items_, block, {}, block_of) - items_.begin()));
  }
  bool empty() const { return items_.empty(); }
  std::size_t size() const { return items_.size(); }
  std::size_t bytes() const { return size() * sizeof(Item) + first_.size() * sizeof first_[0]; }
  /// The items of blocks [begin, end).
  std::span<Item> of(std::size_t begin, std::size_t end) {
    if (empty()) return {};
    return std::span(items_).subspan(first_[begin], first_[end] - first_[begin]);
  }

 private:
  std::vector<Item> items_;
  std::vector<std::size_t> first_;  ///< first item of each block, and the end
};

struct TouchingPieces;  // contact/augmented_contacts.hpp

/// One effect of a scene with the data it needs. It exists only if the scene has the effect: the
/// loop tests no flag, and an absent effect takes no memory.
template <class Real>
class Pass {
 public:
  virtual ~Pass() = default;
  /// The solver starts anew from another state: forgets everything that was kept.
  virtual void restart() {}
  /// Pins have been released, and `before`, a pass of the same class, has done this pass's work
  /// until now. Takes over what is kept from step to step; the rest is lost.
  virtual void take_over(const Pass& /*before*/) {}
  /// Called once for the step [t, t + dt], before integration, and only if the pass asks for it.
  virtual void accelerate(Particles<Real>&, double /*t*/, double /*dt*/) {}
  /// Called once for the step [t, t + dt], after integration and before the first sweep.
  virtual void begin(Particles<Real>&, double /*t*/, double /*dt*/) {}
  /// Applies the effect in the step [t, t + dt].
  virtual void apply(Particles<Real>&, double t, double dt) = 0;
  /// Called once for the step, after the last sweep and contact, and only for passes that solve
  /// links.
  virtual void end(Particles<Real>&, double /*t*/, double /*dt*/) {}
  /// Whether this pass accesses particles only in queued work (ThreadPool::queue). The queue must
  /// be finished before any other pass runs.
  virtual bool queues() const { return false; }
  /// The goal y [m] of a pass that solves towards y, the positions without links and contact; null
  /// for any other pass. Contact that is projected after the pass moves y along with the particles,
  /// so that the links feel its force from the next iteration on.
  virtual Points<Real>* target() { return nullptr; }
  /// Whether the criterion held by which the iterations of this substep end early; empty: there is
  /// none, their number is fixed.
  virtual std::optional<bool> converged() const { return {}; }
  /// Whether the pass moves vertices out of the colliders itself when a substep ends; otherwise,
  /// where it has a target, they are projected then.
  virtual bool leaves_colliders() const { return false; }
  /// The contact of faces and edges, for a pass that includes it in its solve; null for any other.
  virtual TouchingPieces* touching_pieces() { return nullptr; }
  /// Costs of one application, an entry for each thing it does; the solver sets `repeats`.
  virtual std::vector<PassCost> cost() const = 0;
};

}  // namespace taut
