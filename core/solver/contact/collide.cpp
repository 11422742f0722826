#include "core/solver/contact/collide.hpp"

#include <string>
#include <vector>

#include "core/model/index.hpp"
#include "core/solver/contact/projector.hpp"

namespace taut {

namespace {

/// Moves every particle that is inside a collider out of it (Vasilovici, Cloth Simulation Report,
/// sections 4.2.1 to 4.2.3). continuous: also particles that passed through it since the step
/// began. Particles do not affect each other; pins are put back afterwards.
template <class Real>
class CollidePass final : public Pass<Real> {
 public:
  CollidePass(const Collider& collider, const Scene& scene, const Layout& layout, bool continuous,
              Simd simd, ThreadPool& pool)
      : projector_(make_projector<Real>(collider, scene.thickness, continuous, simd)),
        pool_(pool),
        kind_(type_name(collider.shape)),
        particles_(scene.start.x.size()),
        pins_(pins_of(scene), layout) {}

  void begin(Particles<Real>&, double t, double dt) override { projector_->begin(t, dt); }

  void apply(Particles<Real>& p, double, double) override {
    for_pins(p, [](Particles<Real>& q, Pin& pin) { pin.place = q.x[to_index(pin.vertex)]; });
    projector_->project(span_of(p, p.x), p.layout->blocks(), pool_);
    for_pins(p,
             [](Particles<Real>& q, const Pin& pin) { q.x.set(to_index(pin.vertex), pin.place); });
  }
  bool queues() const override { return true; }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "collide " + kind_, .items = particles_, .bytes = sizeof(*this) + pins_.bytes()}};
  }

 private:
  struct Pin {
    int vertex;
    typename Points<Real>::Point place;  ///< m, the pin's position meanwhile
  };
  static std::vector<Pin> pins_of(const Scene& scene) {
    std::vector<Pin> pins;
    for (const int v : scene.pins) pins.push_back({v, Points<Real>::Point::Zero()});
    return pins;
  }
  /// Queues f(p, pin) for each pin.
  template <class F>
  void for_pins(Particles<Real>& p, const F& f) {
    if (pins_.empty()) return;
    pool_.queue(
        p.layout->blocks(),
        [this, &p, f](std::size_t begin, std::size_t end) {
          for (Pin& pin : pins_.of(begin, end)) f(p, pin);
        },
        p.size() >= ThreadPool::kWorthSharing);
  }

  std::unique_ptr<Projector<Real>> projector_;
  ThreadPool& pool_;
  std::string kind_;
  std::size_t particles_;
  ByBlock<Pin> pins_;
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_collide(const Collider& collider, const Scene& scene,
                                         const Layout& layout, bool continuous, Simd simd,
                                         ThreadPool& pool) {
  return std::make_unique<CollidePass<Real>>(collider, scene, layout, continuous, simd, pool);
}
template std::unique_ptr<Pass<float>> make_collide(const Collider&, const Scene&, const Layout&,
                                                   bool, Simd, ThreadPool&);
template std::unique_ptr<Pass<double>> make_collide(const Collider&, const Scene&, const Layout&,
                                                    bool, Simd, ThreadPool&);

}  // namespace taut
