#include "core/solver/contact/quick_fixes.hpp"

#include <string>
#include <vector>

#include "core/solver/contact/projector.hpp"

namespace taut {

namespace {

/// Finds the particles that have entered a collider.
template <class Real>
class EnteringParticles {
 public:
  EnteringParticles(const Collider& collider, double thickness, Simd simd, ThreadPool& pool)
      : projector_(make_projector<Real>(collider, thickness, false, simd)), pool_(pool) {}

  void begin(double t, double dt) { projector_->begin(t, dt); }

  /// Calls visit(i, position outside) for each of them that can move.
  template <class Visit>
  void find(const Particles<Real>& p, const Visit& visit) {
    outside_ = p.x;
    projector_->project(span_of(p, outside_), p.layout->blocks(), pool_);
    pool_.finish();
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.w[i] != 0 && outside_[i] != p.x[i]) visit(i, outside_[i]);
  }

  std::size_t bytes() const { return outside_.bytes(); }

 private:
  std::unique_ptr<Projector<Real>> projector_;
  ThreadPool& pool_;
  Points<Real> outside_;
};

/// The first quick fix for the box in Vasilovici, Cloth Simulation Report, section 4.2.3: a
/// particle that enters is put on the surface and never moves again, whatever its links require,
/// and even if the collider leaves.
template <class Real>
class FreezePass final : public Pass<Real> {
 public:
  FreezePass(const Collider& collider, const Scene& scene, Simd simd, ThreadPool& pool)
      : entering_(collider, scene.thickness, simd, pool),
        kind_(type_name(collider.shape)),
        frozen_(scene.start.x.size()) {}

  void restart() override {
    frozen_.assign(frozen_.size(), false);
    held_.clear();
  }
  void take_over(const Pass<Real>& before) override {
    const auto& old = static_cast<const FreezePass&>(before);
    frozen_ = old.frozen_;
    held_ = old.held_;
  }
  void begin(Particles<Real>& p, double t, double dt) override {
    entering_.begin(t, dt);
    entering_.find(p, [&](std::size_t i, const Point& outside) {
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
             .bytes = sizeof(*this) + entering_.bytes() + frozen_.size() / 8 +
                      held_.capacity() * sizeof(Held)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Held {
    std::size_t particle;
    Point place;
  };
  EnteringParticles<Real> entering_;
  std::string kind_;
  std::vector<bool> frozen_;
  std::vector<Held> held_;
};

/// The second quick fix: a particle that enters is put on the surface, and its next integration is
/// left out. Its previous position stays that of an earlier step while its links go on pulling, so
/// the step after next takes the displacement of two steps for the velocity of one: the pops
/// described in the report.
template <class Real>
class HaltPass final : public Pass<Real> {
 public:
  HaltPass(const Collider& collider, const Scene& scene, Simd simd, ThreadPool& pool)
      : entering_(collider, scene.thickness, simd, pool),
        kind_(type_name(collider.shape)),
        skip_(scene.start.x.size()) {}

  void restart() override { halted_.clear(); }
  void take_over(const Pass<Real>& before) override {
    halted_ = static_cast<const HaltPass&>(before).halted_;
  }
  void begin(Particles<Real>& p, double t, double dt) override {
    entering_.begin(t, dt);
    skip_.assign(skip_.size(), false);
    for (const Halted& h : halted_) {  // undo the integration of this step
      p.x.set(h.particle, p.previous[h.particle]);
      p.previous.set(h.particle, h.previous);
      skip_[h.particle] = true;
    }
    halted_.clear();
  }
  void apply(Particles<Real>& p, double, double) override {
    entering_.find(p, [&](std::size_t i, const Point& outside) {
      if (skip_[i]) return;
      p.x.set(i, outside);
      halted_.push_back({i, p.previous[i]});
    });
  }
  std::vector<PassCost> cost() const override {
    return {{.pass = "halt " + kind_,
             .items = skip_.size(),
             .bytes = sizeof(*this) + entering_.bytes() + skip_.size() / 8 +
                      halted_.capacity() * sizeof(Halted)}};
  }

 private:
  using Point = typename Points<Real>::Point;
  struct Halted {
    std::size_t particle;
    Point previous;  ///< one step before the halt
  };
  EnteringParticles<Real> entering_;
  std::string kind_;
  std::vector<bool> skip_;
  std::vector<Halted> halted_;
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_freeze(const Collider& collider, const Scene& scene, Simd simd,
                                        ThreadPool& pool) {
  return std::make_unique<FreezePass<Real>>(collider, scene, simd, pool);
}
template std::unique_ptr<Pass<float>> make_freeze(const Collider&, const Scene&, Simd, ThreadPool&);
template std::unique_ptr<Pass<double>> make_freeze(const Collider&, const Scene&, Simd,
                                                   ThreadPool&);

template <class Real>
std::unique_ptr<Pass<Real>> make_halt(const Collider& collider, const Scene& scene, Simd simd,
                                      ThreadPool& pool) {
  return std::make_unique<HaltPass<Real>>(collider, scene, simd, pool);
}
template std::unique_ptr<Pass<float>> make_halt(const Collider&, const Scene&, Simd, ThreadPool&);
template std::unique_ptr<Pass<double>> make_halt(const Collider&, const Scene&, Simd, ThreadPool&);

}  // namespace taut
