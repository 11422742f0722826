#pragma once

#include "core/model/scene.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// All particles at once, with x as the caller keeps it.
template <class Real>
CollideSpan<Real> span_of(const Particles<Real>& p, Points<Real>& x) {
  const std::size_t lanes = p.layout->stride();
  return {x.data(), p.previous.data(), lanes,
          lanes > 1 ? p.layout->length() / (3 * lanes) : p.size()};
}

/// Moves every particle that is inside a collider out of it (report, sections 4.2.1 to 4.2.3).
/// `swept` also catches those that passed through it since the step began. No particle sees
/// another; pins are put back afterwards.
template <class Real>
class CollidePass final : public Pass<Real> {
 public:
  CollidePass(const Collider& collider, const Scene& scene, bool swept, Simd simd)
      : projector_(make_projector<Real>(collider, scene.thickness, swept, simd)),
        kind_(type_name(collider.shape)),
        particles_(scene.start.x.size()),
        pins_(scene.pins.begin(), scene.pins.end()),
        pinned_(pins_.size()) {}

  void begin(Particles<Real>&, double t, double dt) override { projector_->begin(t, dt); }

  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t k = 0; k < pins_.size(); ++k) pinned_[k] = p.x[pins_[k]];
    projector_->project(span_of(p, p.x));
    for (std::size_t k = 0; k < pins_.size(); ++k) p.x.set(pins_[k], pinned_[k]);
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "collide " + kind_,
             .items = particles_,
             .bytes = sizeof(*this) + pins_.size() * (sizeof pins_[0] + sizeof pinned_[0])}};
  }

 private:
  std::unique_ptr<Projector<Real>> projector_;
  std::string kind_;
  std::size_t particles_;
  std::vector<std::size_t> pins_;
  std::vector<typename Points<Real>::Point> pinned_;  ///< where they are meanwhile [m]
};

}  // namespace taut
