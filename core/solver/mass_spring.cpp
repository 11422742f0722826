// Springs and dampers without constraints, F = -k x - c v, integrated explicitly: Vasilovici, Cloth
// Simulation Report, section 3. Contact then projects the moved particles (core/solver/loop.cpp).
//
//     explicit-euler     x' = x + v dt;   v' = v + a(x, v) dt              as printed there
//     symplectic-euler   v' = v + a dt;   x' = x + v' dt
//     verlet             x* = 2x - x' + a dt^2                             v = (x - x')/dt
//
// The last two give the same motion. Without drag they are stable while dt < 2/w, where w^2 is the
// largest eigenvalue of K/M; explicit Euler is never stable. Drag at the lagged velocity shrinks
// that limit to (2/w)(sqrt(1 + zeta^2) - zeta); Verlet's `drag-at=central` restores it. Damping of
// links sees the lagged velocity, too, and shrinks it likewise, with zeta = b w/2: K (n - r) +
// b K (n - n')/h for the length n' of a step ago is the force of another spring
// (core/model/link_damping.hpp). That of the membrane is alike.
#include <cmath>

#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/model/text.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"

namespace taut::solver::mass_spring {

namespace {

constexpr auto kParams = loop::with_common(
    {ParamSpec::choice("integrator", "verlet", "explicit-euler|symplectic-euler|verlet",
                       "how the particles move"),
     ParamSpec::real("structural", "N/m", "50", 0, 1e12,
                     "spring constant of structural links; 0: no spring")
         .stiffness_of(Family::structural),
     ParamSpec::real("shear", "N/m", "50", 0, 1e12, "spring constant of shear links; 0: no spring")
         .stiffness_of(Family::shear),
     ParamSpec::real("bend", "N/m", "5", 0, 1e12, "spring constant of bend links; 0: no spring")
         .stiffness_of(Family::bend),
     ParamSpec::real("drag", "N s/m", "0", 0, 1e9,
                     "c of F = -c v on every particle, beside the scene's own damping"),
     ParamSpec::choice(
         "drag-at", "lagged", "lagged|central",
         "velocity that drag sees: (x_n - x_n-1)/dt, or, verlet only, (x_n+1 - x_n-1)/2dt"),
     loop::substeps("32", "each step is this many steps of dt / substeps"),
     ParamSpec::choice(
         "precision", "double", "float|double",
         "scalar type of the simulation; in float, many substeps slow a fall by rounding")
         .as(ParamSpec::Role::precision),
     kMaterial});

template <class Real>
class Springs final : public Pass<Real> {
 public:
  using V = typename Points<Real>::Point;

  explicit Springs(const loop::Setup& setup)
      : accelerate_(kernels<Real>(setup.simd).accelerate),
        drag_(static_cast<Real>(setup.params.real("drag"))),
        central_(setup.params.is("drag-at", "central")),
        explicit_(setup.params.is("integrator", "explicit-euler")),
        damping_(setup.scene.damping),
        bending_(make_bending(setup.scene)),
        membrane_(make_membrane(setup.scene, setup.scene.dt / setup.params.integer("substeps"))),
        moved_(central_ || explicit_ ? setup.w.size() : 0),
        pool_(setup.pool) {
    const auto k = stiffnesses(setup.scene, setup.params);
    const LinkDamping damping = link_damping(setup);
    const std::vector<Spring> springs = stiffened(make_springs(setup.scene, setup.w, k), damping);
    for (const Link& l : setup.scene.links)
      if (const auto family = static_cast<std::size_t>(l.family); k[family] > 0)
        if (moves(l, setup.w)) ++count_[family];
    const Adjacency ends = ends_of(springs, setup.w.size());
    std::vector<int> moving;
    for (std::size_t i = 0; i < setup.w.size(); ++i)
      if (setup.w[i] > 0) moving.push_back(static_cast<int>(i));
    groups_ = VertexGroups(ends, moving, setup.w);
    slots_ = slots_of_springs<SpringSlot<Real>>(groups_, ends, springs, kNothingElse);
    damped_ = DampedSlots<Real>(damping, slots_);
    w_.assign(groups_.size() * kLanes, Real(0));
    for (std::size_t i = 0; i < moving.size(); ++i)
      w_[i] = static_cast<Real>(setup.w[to_index(moving[i])]);
  }

  const Layout& layout() const { return groups_.layout(); }

  /// Adds F/m to the accelerations, with F = -k x of every spring and F = -c v of every particle.
  void accelerate(Particles<Real>& p, double, double h) override {
    damped_.begin(groups_, slots_, p.previous);
    membrane_.begin([&](std::size_t v) { return p.previous[v]; });
    for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i] = p.x[i] - p.previous[i];
    const AccelerationSweep<Real> sweep{.groups = groups_.data(),
                                        .x = p.x.data(),
                                        .previous = p.previous.data(),
                                        .w = w_.data(),
                                        .a = p.a.data(),
                                        .drag = central_ ? Real(0) : drag_ / static_cast<Real>(h)};
    pool_.run(
        groups_.size(),
        [&](std::size_t begin, std::size_t end) { accelerate_(sweep, slots_.data(), begin, end); },
        groups_.size() * kLanes >= ThreadPool::kWorthSharing / 4);
    for (const BendingElement& e : bending_) {
      const V pull =
          static_cast<Real>(-e.stiffness) * e.value([&](std::size_t v) { return p.x[v]; });
      for (std::size_t i = 0; i < e.size; ++i)
        if (const std::size_t v = to_index(e.vertex[i]); p.w[v] > 0)
          p.a.add(v, p.w[v] * static_cast<Real>(e.weight[i]) * pull);
    }
    for (const MembraneElement& e : membrane_.elements)
      membrane_.add_forces(
          e, [&](std::size_t v) { return p.x[v]; },
          [&](std::size_t v, const Vec3& force) {
            if (p.w[v] > 0) p.a.add(v, p.w[v] * V(force.cast<Real>()));
          });
  }

  /// Corrects the loop's Verlet step, x* = x + v' h, for central drag or explicit Euler.
  void begin(Particles<Real>& p, double, double h) override {
    const Real keep = static_cast<Real>(std::exp(-damping_ * h));
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      if (p.w[i] == 0) continue;
      const V moves = p.x[i] - p.previous[i];
      if (central_) {  // v' = keep v + h (a - c/m (keep v + v')/2)
        const Real half = drag_ * p.w[i] * static_cast<Real>(h) / 2;
        p.x.set(i, p.previous[i] + (moves - half * keep * moved_[i]) / (1 + half));
      } else {  // x + v h instead, with the velocity v'
        p.x.add(i, moved_[i] - moves);
        p.previous.add(i, moved_[i] - moves);
      }
    }
  }

  void apply(Particles<Real>&, double, double) override {}

  std::vector<PassCost> cost() const override {
    std::vector<PassCost> costs;
    for (const Family family : kFamilies)
      if (const std::size_t n = count_[static_cast<std::size_t>(family)]; n > 0)
        costs.push_back({.pass = std::string(to_string(family)) + " springs", .items = n});
    if (!bending_.empty())
      costs.push_back({.pass = "bending forces",
                       .items = bending_.size(),
                       .bytes = bending_.size() * sizeof(BendingElement)});
    if (!membrane_.empty())
      costs.push_back({.pass = "membrane forces",
                       .items = membrane_.elements.size(),
                       .bytes = membrane_.bytes()});
    if (!costs.empty())
      costs.front().bytes += slots_.size() * sizeof slots_[0] + groups_.bytes() + damped_.bytes() +
                             w_.size() * sizeof w_[0] + moved_.size() * sizeof moved_[0];
    return costs;
  }

 private:
  void (*accelerate_)(const AccelerationSweep<Real>&, SpringSlot<Real>*, std::size_t, std::size_t);
  Real drag_;
  bool central_, explicit_;
  double damping_;
  std::vector<BendingElement> bending_;
  MembraneModel membrane_;
  std::array<std::size_t, kFamilies.size()> count_{};  ///< number of springs by family
  VertexGroups groups_;
  std::vector<SpringSlot<Real>> slots_;
  DampedSlots<Real> damped_;
  std::vector<Real> w_;   ///< [groups][kLanes] 1/kg
  std::vector<V> moved_;  ///< m, h v before the step; empty if not needed
  ThreadPool& pool_;
};

template <class Real>
loop::Links<Real> make_links(const loop::Setup& setup) {
  auto pass = std::make_unique<Springs<Real>>(setup);
  Layout layout = pass->layout();
  return {.layout = std::move(layout),
          .pass = std::move(pass),
          .accelerates = true,
          .bends = true,
          .stretches = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, make_links<float>, make_links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = unsupported_of_springs(scene, params);
  if (params.is("drag-at", "central") && !params.is("integrator", "verlet"))
    reasons.emplace_back("drag-at=central needs integrator=verlet");
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  return loop::resolved_settings(
      scene, params,
      {describe_springs(scene, params), {"work unit", "spring evaluations, not projections"}},
      "as forces");
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"precision"}, {"double", "float"}}};

LinearModel linear_model(const Scene& scene, const Params& params) {
  return LinearSprings{.stiffness = stiffnesses(scene, params),
                       .drag = params.real("drag"),
                       .central_drag = params.is("drag-at", "central"),
                       .explicit_euler = params.is("integrator", "explicit-euler"),
                       .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::mass_spring

TAUT_SOLVER(mass_spring) = {
    .name = "mass-spring",
    .summary = "Hooke springs with drag, integrated explicitly",
    .source = "Vasilovici, Cloth Simulation Report, section 3; Provot 1995; Lander 1999",
    .params = taut::solver::mass_spring::kParams,
    .make = taut::solver::mass_spring::make,
    .unsupported = taut::solver::mass_spring::unsupported,
    .resolved_settings = taut::solver::mass_spring::resolved_settings,
    .declared_step = [](const taut::Scene&, const taut::Params&) -> taut::DeclaredStep {
      return {.none = "it is explicit"};
    },
    .accuracy = {.substeps = "substeps",
                 .stiffness = {{"structural", "shear"},
                               {"50", "200", "800", "3200", "12800", "51200"}},
                 .alternatives = taut::solver::mass_spring::kAlternatives,
                 .labelled = {"substeps", "precision"}},
    .optional_effects = taut::loop::kOptionalEffects,
    .linear_model = taut::solver::mass_spring::linear_model};
