#include "core/solver/contact/responses.hpp"

#include <set>
#include <utility>

#include "core/model/index.hpp"
#include "core/solver/contact/face_contact.hpp"
#include "core/solver/contact/octree.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/contact/self_collision.hpp"

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

template <class Real>
void add_response(const Collider& collider, const Scene& scene, const Layout& layout,
                  const ContactSettings& settings, bool solved, ThreadPool& pool,
                  ContactPasses<Real>& passes) {
  const auto project = [&](bool continuous) {
    return std::make_unique<CollidePass<Real>>(collider, scene, layout, continuous, settings.simd,
                                               pool);
  };
  auto& swept = solved ? passes.after : passes.sweep;
  switch (settings.response) {
    case Response::continuous:
      swept.push_back(project(true));
      break;
    case Response::discrete:
      swept.push_back(project(false));
      break;
    case Response::before:
      passes.before.push_back(project(false));
      break;
    case Response::after:
      passes.after.push_back(project(false));
      break;
    case Response::freeze:
      passes.sweep.push_back(
          std::make_unique<FreezePass<Real>>(collider, scene, settings.simd, pool));
      break;
    case Response::halt:
      passes.before.push_back(
          std::make_unique<HaltPass<Real>>(collider, scene, settings.simd, pool));
      break;
  }
}

/// Faces and edges to be kept out of the collider. A face keeps its own sides out of the closed
/// forms; at a body of triangles it leaves them to the edges.
std::vector<Triangle> pieces_of(const Scene& scene, const Collider& collider,
                                const ContactSettings& settings) {
  if (!settings.edges || std::holds_alternative<Plane>(collider.shape)) return {};
  std::set<std::pair<int, int>> edges;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && link.rest > kSeamRest)
      edges.insert(std::minmax(link.a, link.b));
  const bool faces_have_sides = settings.faces && !std::holds_alternative<MeshBody>(collider.shape);
  for (const Triangle& face : scene.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto side = std::minmax(face[k], face[(k + 1) % 3]);
      if (faces_have_sides)
        edges.erase(side);
      else
        edges.insert(side);
    }
  std::vector<Triangle> pieces;
  if (settings.faces) pieces = scene.mesh.triangles;
  for (const auto& [a, b] : edges) pieces.push_back({a, b, b});
  return pieces;
}

}  // namespace

template <class Real>
ContactPasses<Real> make_contact(const Scene& scene, const Layout& layout,
                                 const ContactSettings& settings, Pass<Real>* solver,
                                 ThreadPool& pool) {
  ContactPasses<Real> passes;
  if (scene.self_collision && settings.self == SelfCollisionMethod::grid)
    passes.sweep.push_back(
        std::make_unique<SelfCollidePass<Real>>(scene, settings.simd, solver, pool));
  if (scene.self_collision && settings.self == SelfCollisionMethod::octree)
    passes.sweep.push_back(std::make_unique<OctreePass<Real>>(scene));
  for (const Collider& collider : scene.colliders)
    if (auto pieces = pieces_of(scene, collider, settings); !pieces.empty())
      passes.sweep.push_back(std::make_unique<FaceContactPass<Real>>(
          collider, scene.thickness, settings.response == Response::continuous, std::move(pieces),
          solver));
  for (const Collider& collider : scene.colliders)
    add_response(collider, scene, layout, settings, solver != nullptr, pool, passes);
  return passes;
}

template ContactPasses<float> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                           Pass<float>*, ThreadPool&);
template ContactPasses<double> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                            Pass<double>*, ThreadPool&);

}  // namespace taut
