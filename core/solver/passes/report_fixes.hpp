#pragma once

#include "core/model/scene.hpp"
#include "core/solver/contact/place.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// The report's first quick fix for the box (section 4.2.3): a particle that arrives inside is put
/// on the surface and never moves again, whatever its links ask for, and even if the collider
/// leaves.
template <class Real, template <class> class SurfaceOf>
class FreezePass final : public Pass<Real> {
 public:
  FreezePass(const Collider& collider, double thickness, std::size_t particles)
      : collider_(collider, thickness),
        kind_(type_name(collider.shape)),
        particles_(particles),
        frozen_(particles) {}

  void restart() override {
    frozen_.assign(particles_, false);
    held_.clear();
  }
  void begin(Particles<Real>& p, double t, double dt) override {
    const Contact<Real, SurfaceOf> contact = collider_.at(t, dt);
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (frozen_[i] || p.w[i] == 0) continue;
      Triple<Real> x = triple<Real>(p.x[i]);
      if (!contact.project(x, triple<Real>(p.previous[i]))) continue;
      frozen_[i] = true;
      held_.push_back({i, point(x)});
    }
    for (const Held& h : held_) p.previous.set(h.particle, h.place);
    apply(p, t, dt);
  }
  void apply(Particles<Real>& p, double, double) override {
    for (const Held& h : held_) p.x.set(h.particle, h.place);
  }
  std::vector<PassCost> cost() const override {
    return {{.pass = "freeze " + kind_,
             .items = particles_,
             .bytes = sizeof(*this) + particles_ / 8 + held_.capacity() * sizeof(Held)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Held {
    std::size_t particle;
    Point place;
  };
  ColliderInMotion<Real, SurfaceOf> collider_;
  std::string kind_;
  std::size_t particles_;
  std::vector<bool> frozen_;
  std::vector<Held> held_;
};

/// The report's second: a particle that arrives inside is put on the surface and its next
/// integration is left out. Its previous place grows old meanwhile while its links go on pulling,
/// so that the step after next takes the way of two steps for the velocity of one: the pops that
/// the report complains of.
template <class Real, template <class> class SurfaceOf>
class HaltPass final : public Pass<Real> {
 public:
  HaltPass(const Collider& collider, double thickness, std::size_t particles)
      : collider_(collider, thickness), kind_(type_name(collider.shape)), particles_(particles) {}

  void restart() override { halted_.clear(); }
  void begin(Particles<Real>& p, double t, double dt) override {
    contact_ = collider_.at(t, dt);
    skip_.assign(particles_, false);
    for (const Halted& h : halted_) {  // undo this step's integration
      p.x.set(h.particle, p.previous[h.particle]);
      p.previous.set(h.particle, h.previous);
      skip_[h.particle] = true;
    }
    halted_.clear();
  }
  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (skip_[i] || p.w[i] == 0) continue;
      Triple<Real> x = triple<Real>(p.x[i]);
      if (!contact_.project(x, triple<Real>(p.previous[i]))) continue;
      p.x.set(i, point(x));
      halted_.push_back({i, p.previous[i]});
    }
  }
  std::vector<PassCost> cost() const override {
    return {{.pass = "halt " + kind_,
             .items = particles_,
             .bytes = sizeof(*this) + particles_ / 8 + halted_.capacity() * sizeof(Halted)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Halted {
    std::size_t particle;
    Point previous;  ///< one step before the halt
  };
  ColliderInMotion<Real, SurfaceOf> collider_;
  Contact<Real, SurfaceOf> contact_{};
  std::string kind_;
  std::size_t particles_;
  std::vector<bool> skip_;
  std::vector<Halted> halted_;
};

}  // namespace taut
