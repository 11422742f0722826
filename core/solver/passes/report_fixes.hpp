#pragma once

#include "core/solver/passes/collide.hpp"

namespace taut {

/// Finds the particles that have arrived inside a collider.
template <class Real>
class Arrivals {
 public:
  Arrivals(const Collider& collider, double thickness, Simd simd)
      : projector_(make_projector<Real>(collider, thickness, false, simd)) {}

  void begin(double t, double dt) { projector_->begin(t, dt); }

  /// Calls visit(i, where it belongs) for each of them that can move.
  template <class Visit>
  void find(const Particles<Real>& p, const Visit& visit) {
    outside_ = p.x;
    projector_->project(span_of(p, outside_));
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] != 0 && outside_[i] != p.x[i]) visit(i, outside_[i]);
  }

  std::size_t bytes() const { return outside_.bytes(); }

 private:
  std::unique_ptr<Projector<Real>> projector_;
  Points<Real> outside_;
};

/// The report's first quick fix for the box (section 4.2.3): a particle that arrives inside is put
/// on the surface and never moves again, whatever its links ask for, and even if the collider
/// leaves.
template <class Real>
class FreezePass final : public Pass<Real> {
 public:
  FreezePass(const Collider& collider, const Scene& scene, Simd simd)
      : arrivals_(collider, scene.thickness, simd),
        kind_(type_name(collider.shape)),
        frozen_(scene.start.x.size()) {}

  void restart() override {
    frozen_.assign(frozen_.size(), false);
    held_.clear();
  }
  void begin(Particles<Real>& p, double t, double dt) override {
    arrivals_.begin(t, dt);
    arrivals_.find(p, [&](std::size_t i, const Point& outside) {
      if (frozen_[i]) return;
      frozen_[i] = true;
      held_.push_back({i, outside});
    });
    for (const Held& h : held_) p.previous.set(h.particle, h.place);
    apply(p, t, dt);
  }
  void apply(Particles<Real>& p, double, double) override {
    for (const Held& h : held_) p.x.set(h.particle, h.place);
  }
  std::vector<PassCost> cost() const override {
    return {{.pass = "freeze " + kind_,
             .items = frozen_.size(),
             .bytes = sizeof(*this) + arrivals_.bytes() + frozen_.size() / 8 +
                      held_.capacity() * sizeof(Held)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Held {
    std::size_t particle;
    Point place;
  };
  Arrivals<Real> arrivals_;
  std::string kind_;
  std::vector<bool> frozen_;
  std::vector<Held> held_;
};

/// The report's second: a particle that arrives inside is put on the surface and its next
/// integration is left out. Its previous place grows old meanwhile while its links go on pulling,
/// so that the step after next takes the way of two steps for the velocity of one: the pops that
/// the report complains of.
template <class Real>
class HaltPass final : public Pass<Real> {
 public:
  HaltPass(const Collider& collider, const Scene& scene, Simd simd)
      : arrivals_(collider, scene.thickness, simd),
        kind_(type_name(collider.shape)),
        skip_(scene.start.x.size()) {}

  void restart() override { halted_.clear(); }
  void begin(Particles<Real>& p, double t, double dt) override {
    arrivals_.begin(t, dt);
    skip_.assign(skip_.size(), false);
    for (const Halted& h : halted_) {  // undo this step's integration
      p.x.set(h.particle, p.previous[h.particle]);
      p.previous.set(h.particle, h.previous);
      skip_[h.particle] = true;
    }
    halted_.clear();
  }
  void apply(Particles<Real>& p, double, double) override {
    arrivals_.find(p, [&](std::size_t i, const Point& outside) {
      if (skip_[i]) return;
      p.x.set(i, outside);
      halted_.push_back({i, p.previous[i]});
    });
  }
  std::vector<PassCost> cost() const override {
    return {{.pass = "halt " + kind_,
             .items = skip_.size(),
             .bytes = sizeof(*this) + arrivals_.bytes() + skip_.size() / 8 +
                      halted_.capacity() * sizeof(Halted)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Halted {
    std::size_t particle;
    Point previous;  ///< one step before the halt
  };
  Arrivals<Real> arrivals_;
  std::string kind_;
  std::vector<bool> skip_;
  std::vector<Halted> halted_;
};

}  // namespace taut
