#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/solver/global_system.hpp"
#include "core/solver/loop.hpp"

namespace taut {

/// Friction for passes whose every sweep pulls vertices towards y anew, with m/h^2 against links
/// that are stiffer along the cloth than across it. Contact after a sweep would bound the slip
/// that it takes back by the depth of that sweep: equal ways, but other forces. Here all that
/// contact moved a vertex by in a substep is an impulse c m/h that y keeps,
///
///     sweep towards y + c;   x -= c;   contact puts x out, by c
///
/// so contact decides about the whole of it in every sweep, its part across the surface is the
/// normal force times h^2/m, and Coulomb's cone binds the sums: the sequential impulses of
/// Guendelman, Bridson, Fedkiw: Nonconvex Rigid Bodies with Stacking (SIGGRAPH 2003), accumulated
/// as in Catto: Iterative Dynamics with Temporal Coherence (GDC 2005).
class ContactImpulses final : public Pass<double> {
 public:
  /// y: [n] m, of the pass, set in its begin().
  ContactImpulses(std::unique_ptr<Pass<double>> pass, std::vector<Vec3>& y)
      : pass_(std::move(pass)), y_(y) {}

  void restart() override { pass_->restart(); }
  void begin(Particles<double>& p, double t, double h) override {
    pass_->begin(p, t, h);
    without_ = positions(p);
    impulse_.assign(p.size(), Vec3::Zero());
  }
  void apply(Particles<double>& p, double t, double h) override {
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3 c = p.x[i] - without_[i];
      y_[i] += c - std::exchange(impulse_[i], c);
    }
    pass_->apply(p, t, h);
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] > 0) p.x.add(i, -impulse_[i]), without_[i] = p.x[i];
  }
  void end(Particles<double>& p, double t, double h) override { pass_->end(p, t, h); }

  std::vector<PassCost> cost() const override {
    std::vector<PassCost> costs = pass_->cost();
    costs.push_back(
        {.pass = "impulses of contact", .items = y_.size(), .bytes = 2 * y_.size() * sizeof(Vec3)});
    return costs;
  }

 private:
  std::unique_ptr<Pass<double>> pass_;
  std::vector<Vec3>& y_;
  std::vector<Vec3> without_, impulse_;  ///< m, x before contact, and c
};

/// The pass as it is where no collider has friction, or contact does not follow every sweep.
inline std::unique_ptr<Pass<double>> with_contact_impulses(std::unique_ptr<Pass<double>> pass,
                                                           std::vector<Vec3>& y,
                                                           const loop::Setup& s) {
  const bool rubs =
      std::ranges::any_of(s.scene.colliders, [](const Collider& c) { return c.friction > 0; });
  if (!rubs || !(s.params.is("contact", "continuous") || s.params.is("contact", "discrete")))
    return pass;
  return std::make_unique<ContactImpulses>(std::move(pass), y);
}

}  // namespace taut
