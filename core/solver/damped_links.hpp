#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/link_damping.hpp"
#include "core/solver/springs.hpp"

namespace taut {

// Damped links (core/model/link_damping.hpp) in solvers of springs, which take the stiffness when
// they are made, and the rest lengths at the start of every substep. XPBD's own form (Macklin,
// Mueller, Chentanez 2016, equation 26, where q is gamma) has n - n_t linearised.

/// Of the solver's substeps.
inline LinkDamping link_damping(const loop::Setup& s) {
  return {s.scene, s.scene.dt / s.params.integer("substeps")};
}

/// The springs as stiff as their damping makes them.
inline std::vector<Spring> stiffened(std::vector<Spring> springs, const LinkDamping& damping) {
  if (damping.on())
    for (Spring& spring : springs) spring.stiffness *= damping.stiffer();
  return springs;
}

/// Rest lengths of damped springs.
class DampedSprings {
 public:
  DampedSprings(const LinkDamping& damping, const std::vector<Spring>& springs)
      : damping_(damping) {
    if (!damping.on()) return;
    for (const Spring& spring : springs) rest_.push_back(spring.rest);
  }

  /// Sets the springs' rest lengths by their lengths at `previous`, x_t.
  template <class Real>
  void begin(std::vector<Spring>& springs, const Points<Real>& previous) const {
    for (std::size_t j = 0; j < rest_.size(); ++j) {
      Spring& spring = springs[j];
      if (std::isinf(spring.stiffness)) continue;
      const Vec3 way = (previous[spring.b] - previous[spring.a]).template cast<double>();
      spring.rest = damping_.rest(rest_[j], way.norm());
    }
  }
  std::size_t bytes() const { return rest_.size() * sizeof(double); }

 private:
  LinkDamping damping_;
  std::vector<double> rest_;  ///< [springs] m; empty: no damping
};

/// Rest lengths of damped links in the slots of groups of vertices. Both ends of a link compute the
/// same bits.
template <class Real>
class DampedSlots {
 public:
  DampedSlots() = default;  ///< no damping
  /// The slots are those of stiffened() springs.
  template <class Slot>
  DampedSlots(const LinkDamping& damping, const std::vector<Slot>& slots)
      : share_(static_cast<Real>(damping.share())) {
    if (!damping.on()) return;
    for (const Slot& slot : slots) rest_.insert(rest_.end(), slot.rest, slot.rest + kLanes);
  }

  /// Sets the slots' rest lengths by the links' lengths at `previous`, x_t.
  template <class Slot>
  void begin(const VertexGroups& groups, std::vector<Slot>& slots,
             const Points<Real>& previous) const {
    if (rest_.empty()) return;
    const Real* const x = previous.data();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const VertexGroup& group = groups.data()[g];
      for (std::size_t s = group.first_slot; s < group.end_slot; ++s)
        for (std::size_t l = 0; l < kLanes; ++l) {
          const Real* const a = x + group.particle[l].number;
          const Real* const b = x + slots[s].other[l].number;
          slots[s].rest[l] = damped_rest(rest_[s * kLanes + l], a, b, share_);
        }
    }
  }
  std::size_t bytes() const { return rest_.size() * sizeof(Real); }

 private:
  Real share_ = 0;
  std::vector<Real> rest_;  ///< [slots][kLanes] m; empty: no damping
};

/// Adds the reason why a solver refuses damped links: `why`.
inline void refuse_link_damping(const Scene& scene, std::string_view why,
                                std::vector<std::string>& reasons) {
  if (scene.link_damping > 0) reasons.push_back("damping of links: " + std::string(why));
}

}  // namespace taut
