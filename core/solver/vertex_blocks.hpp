#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/model/adjacency.hpp"
#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/layout/vertex_groups.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/simd/vertex_model.hpp"
#include "core/solver/springs.hpp"

namespace taut {

/// Start of a substep's iterations (VBD, section 3.7): y without the part of gravity that did not
/// act in the last substep, because something held the vertex and it fell short of its y.
template <class Real>
class AdaptiveStart {
 public:
  AdaptiveStart(const Scene& scene, bool on)
      : gravity_(scene.gravity), on_(on && gravity_.norm() > 0) {}

  /// Moves p.x from y to the start. p.previous is x_t. y is that of the last substep, empty
  /// before the first one, and becomes this one's.
  void begin(Particles<Real>& p, Points<Real>& y, double h) const {
    if (!on_ || y.empty()) {
      y = p.x;
      return;
    }
    using Point = typename Points<Real>::Point;
    const double g = gravity_.norm();
    const Point down = (gravity_ / g).template cast<Real>();
    const Real most = static_cast<Real>(g * h * h);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Real held = (p.previous[i] - y[i]).dot(down);
      y.set(i, p.x[i]);
      if (p.w[i] > 0) p.x.add(i, std::clamp(held, -most, Real(0)) * down);
    }
  }

 private:
  Vec3 gravity_;
  bool on_;
};

/// Sweeps of solvers that move one vertex at a time to the minimum of a quadratic model in its own
/// three coordinates, with all others held. Colours come one after another; lanes and threads
/// divide a colour, and any number of them computes the same bits. Links are computed in lanes.
/// Bending, membrane and contact are computed vertex by vertex, and only if the scene has them: the
/// lanes move a vertex with the forces by which colliders hold it, and then those at its new place
/// are settled by the same Hessian.
template <class Real, class Slot>
class VertexBlocks {
 public:
  using Sweep = void (*)(const VertexSweep<Real>&, const Slot*, std::size_t, std::size_t);

  /// Visits vertices by the parameter `order`: in colours, or one after another in the scene's
  /// order.
  VertexBlocks(const loop::Setup& s, const std::vector<Spring>& springs, Sweep kernel)
      : VertexBlocks(s, springs, kernel, ends_of(springs, s.w.size())) {}

  const VertexGroups& groups() const { return groups_; }
  std::vector<Slot>& slots() { return slots_; }
  const std::vector<Slot>& slots() const { return slots_; }
  Points<Real>& target() { return y_; }  ///< Pass::target
  const MembraneModel& membrane() const { return membrane_; }

  void restart() {
    y_ = {};
    if (contacts_) contacts_->restart();
  }

  void take_over(const VertexBlocks& before) {
    if (!before.y_.empty()) {
      y_ = Points<Real>(std::make_shared<const Layout>(groups_.layout()));
      for (std::size_t i = 0; i < groups_.layout().size(); ++i) y_.set(i, before.y_[i]);
    }
    if (contacts_) contacts_->take_over(*before.contacts_);
  }

  /// Moves p.x to where the sweeps start. Vertices that touch a collider start where contact alone
  /// would leave them (Contacts::predict): sweeps would get them there slowly, against stiff links.
  void begin(Particles<Real>& p, double t, double h) {
    start_.begin(p, y_, h);
    membrane_.begin([&](std::size_t v) { return p.previous[v]; });
    if (h != inertia_of_) set_inertia(p, h);
    if (!contacts_) return;
    held_.assign(groups_.size() * 3 * kLanes, Real(0));
    hessians_.resize(groups_.size() * 6 * kLanes);
    contacts_->begin(t, h);
    contacts_->predict(p, h);
  }

  /// Makes one sweep over all vertices. damping: k_d [s] of the springs.
  void sweep(Particles<Real>& p, double damping, double h) {
    const VertexSweep<Real> v{.groups = groups_.data(),
                              .x = p.x.data(),
                              .y = y_.data(),
                              .previous = p.previous.data(),
                              .inertia = inertia_.data(),
                              .bending = bending_.empty() ? nullptr : bending_forces_.data(),
                              .membrane = membrane_.empty() ? nullptr : membrane_rows_.data(),
                              .held = contacts_ ? held_.data() : nullptr,
                              .hessian = contacts_ ? hessians_.data() : nullptr,
                              .damping = static_cast<Real>(damping / h)};
    for (std::size_t colour = 0; colour < groups_.colours(); ++colour) {
      const std::size_t first = groups_.first_group(colour);
      share(groups_.first_group(colour + 1) - first, [&](std::size_t begin, std::size_t end) {
        sweep_groups(p, v, first + begin, first + end);
      });
    }
  }

  /// Calls work(begin, end) on parts of `groups` independent groups.
  template <class Work>
  void share(std::size_t groups, const Work& work) {
    pool_.run(groups, work, groups * kLanes >= kWorthSharing);
  }

  std::size_t bytes() const {
    return bending_.size() * sizeof(BendingElement) + membrane_.bytes() +
           (contacts_ ? contacts_->bytes() : 0) + slots_.size() * sizeof(Slot) + groups_.bytes() +
           y_.bytes() +
           (inertia_.size() + bending_forces_.size() + membrane_rows_.size() + held_.size() +
            hessians_.size()) *
               sizeof(Real);
  }

 private:
  /// An element of bending or of the membrane at a vertex.
  struct At {
    std::size_t element, place;  ///< index of the vertex within the element
  };
  static constexpr std::size_t kRows = 9;  ///< of VertexSweep::membrane
  /// Fewest vertices for which threads share a sweep, which takes as long as one of
  /// ThreadPool::kWorthSharing particles over links.
  static constexpr std::size_t kWorthSharing = ThreadPool::kWorthSharing / 4;

  VertexBlocks(const loop::Setup& s, const std::vector<Spring>& springs, Sweep kernel,
               const Adjacency& ends)
      : sweep_(kernel),
        bending_(make_bending(s.scene)),
        membrane_(make_membrane(s.scene, s.scene.dt / s.params.integer("substeps"))),
        groups_(ends, bending_, membrane_.elements, s.w, s.params.is("order", "coloured")),
        slots_(slots_of_springs<Slot>(groups_, ends, springs, kNothingElse)),
        start_(s.scene, s.params.is("start", "adaptive")),
        contacts_(make_contacts(s.scene, s.params)),
        bent_(bending_.empty() ? 0 : s.w.size()),
        stretched_(membrane_.empty() ? 0 : s.w.size()),
        pool_(s.pool) {
    for (std::size_t k = 0; k < bending_.size(); ++k)
      for (std::size_t i = 0; i < bending_[k].size; ++i)
        bent_[to_index(bending_[k].vertex[i])].push_back({k, i});
    set_bending_stiffness();
    for (std::size_t k = 0; k < membrane_.elements.size(); ++k)
      for (std::size_t a = 0; a < 3; ++a)
        stretched_[to_index(membrane_.elements[k].vertex[a])].push_back({k, a});
    if (!membrane_.empty()) membrane_rows_.assign(groups_.size() * kRows * kLanes, Real(0));
  }

  /// Calls f(vertex, group, lane) for the vertices of groups [begin, end).
  template <class F>
  void visit(std::size_t begin, std::size_t end, const F& f) const {
    for (std::size_t g = begin; g < end; ++g)
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        if (const int i = groups_.vertex(g, lane); i >= 0) f(to_index(i), g, lane);
  }

  void set_inertia(const Particles<Real>& p, double h) {
    inertia_.assign(groups_.size() * kLanes, Real(1));
    visit(0, groups_.size(), [&](std::size_t i, std::size_t g, std::size_t lane) {
      inertia_[g * kLanes + lane] = static_cast<Real>(1 / (static_cast<double>(p.w[i]) * h * h));
    });
    inertia_of_ = h;
  }

  double bending_stiffness(const At& b) const {
    return bending_[b.element].stiffness * bending_[b.element].weight[b.place];
  }
  Real& bending_force(std::size_t g, std::size_t row, std::size_t lane) {
    return bending_forces_[(4 * g + row) * kLanes + lane];
  }
  /// Sets the bending part of each vertex' Hessian, which is a number times the identity.
  void set_bending_stiffness() {
    if (bending_.empty()) return;
    bending_forces_.assign(groups_.size() * 4 * kLanes, Real(0));
    visit(0, groups_.size(), [&](std::size_t i, std::size_t g, std::size_t lane) {
      double sum = 0;
      for (const At& b : bent_[i])
        sum += bending_stiffness(b) * bending_[b.element].weight[b.place];
      bending_force(g, 3, lane) = static_cast<Real>(sum);
    });
  }
  void set_bending_forces(const Particles<Real>& p, std::size_t begin, std::size_t end) {
    visit(begin, end, [&](std::size_t i, std::size_t g, std::size_t lane) {
      typename Points<Real>::Point force = Points<Real>::Point::Zero();
      for (const At& b : bent_[i])
        force -= static_cast<Real>(bending_stiffness(b)) *
                 bending_[b.element].value([&](std::size_t v) { return p.x[v]; });
      for (std::size_t axis = 0; axis < 3; ++axis)
        bending_force(g, axis, lane) = force[static_cast<int>(axis)];
    });
  }

  /// Sets the membrane's force on each vertex and its Hessian there, without its negative part.
  void set_membrane_rows(const Particles<Real>& p, std::size_t begin, std::size_t end) {
    visit(begin, end, [&](std::size_t i, std::size_t g, std::size_t lane) {
      Vec3 force = Vec3::Zero();
      Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
      for (const At& b : stretched_[i]) {
        const MembraneElement& e = membrane_.elements[b.element];
        const Deformation f = e.deformation([&](std::size_t v) { return p.x[v]; });
        const Eigen::Vector2d& own = e.gradient[b.place];
        const Vec3 rest = membrane_.rest(e);
        force -= e.area * (membrane_.law.stress(f, rest) * own);
        hessian += e.area * membrane_.law.second(f, true, rest).between(own, own);
      }
      const double rows[kRows]{force.x(),     force.y(),     force.z(),
                               hessian(0, 0), hessian(1, 1), hessian(2, 2),
                               hessian(0, 1), hessian(0, 2), hessian(1, 2)};
      for (std::size_t r = 0; r < kRows; ++r)
        membrane_rows_[(kRows * g + r) * kLanes + lane] = static_cast<Real>(rows[r]);
    });
  }

  void sweep_groups(Particles<Real>& p, const VertexSweep<Real>& v, std::size_t begin,
                    std::size_t end) {
    if (!bending_.empty()) set_bending_forces(p, begin, end);
    if (!membrane_.empty()) set_membrane_rows(p, begin, end);
    if (!contacts_) return sweep_(v, slots_.data(), begin, end);
    visit(begin, end, [&](std::size_t i, std::size_t g, std::size_t lane) {
      const Vec3 force = contacts_->force_at(i, p.x[i].template cast<double>(),
                                             p.previous[i].template cast<double>());
      for (std::size_t axis = 0; axis < 3; ++axis)
        held_[(3 * g + axis) * kLanes + lane] = static_cast<Real>(force[static_cast<int>(axis)]);
    });
    sweep_(v, slots_.data(), begin, end);
    visit(begin, end, [&](std::size_t i, std::size_t g, std::size_t lane) {
      const Vec3 x = p.x[i].template cast<double>();
      Vec3 to = x;
      contacts_->settle_vertex(
          i, [&] { return hessian(g, lane); }, p.previous[i].template cast<double>(), to);
      if (to != x) p.x.set(i, to.cast<Real>());
    });
  }

  /// That of the sweep's model of a vertex.
  Eigen::Matrix3d hessian(std::size_t g, std::size_t lane) const {
    const auto at = [&](std::size_t entry) {
      return static_cast<double>(hessians_[(6 * g + entry) * kLanes + lane]);
    };
    const double xy = at(3), xz = at(4), yz = at(5);
    return Eigen::Matrix3d{{at(0), xy, xz}, {xy, at(1), yz}, {xz, yz, at(2)}};
  }

  Sweep sweep_;
  std::vector<BendingElement> bending_;
  MembraneModel membrane_;
  VertexGroups groups_;
  std::vector<Slot> slots_;
  AdaptiveStart<Real> start_;
  std::unique_ptr<Contacts> contacts_;      ///< null: no contact
  std::vector<std::vector<At>> bent_;       ///< [n] elements of each vertex; empty: no bending
  std::vector<std::vector<At>> stretched_;  ///< [n] the same of the membrane; empty: none
  std::vector<Real> inertia_;               ///< [groups][kLanes] N/m
  double inertia_of_ = 0;                   ///< s, substep of inertia_; 0: none yet
  std::vector<Real> bending_forces_;        ///< VertexSweep::bending; empty: no bending
  std::vector<Real> membrane_rows_;         ///< VertexSweep::membrane; empty: no membrane
  Points<Real> y_;                          ///< m, positions without links
  std::vector<Real> held_;                  ///< VertexSweep::held; empty: no contact
  std::vector<Real> hessians_;              ///< VertexSweep::hessian; empty: no contact
  ThreadPool& pool_;
};

inline constexpr ParamSpec kVertexOrder = ParamSpec::choice(
    "order", "coloured", "coloured|mesh",
    "visit vertices colour after colour, which threads can share, or in the scene's order");
inline constexpr ParamSpec kAdaptiveStart =
    ParamSpec::choice("start", "adaptive", "adaptive|inertia",
                      "where iterations start: as published, without the part of gravity that did "
                      "not act in the last substep, so that a fall slowed by too few sweeps stays "
                      "slow; or where the vertices would go without links");
inline constexpr ParamSpec kVertexPrecision =
    ParamSpec::choice("precision", "double", "float|double",
                      "scalar type of the simulation; in float a sweep costs about 0.8 times as "
                      "much, and the error falls no lower than rounding")
        .as(ParamSpec::Role::precision);

}  // namespace taut
