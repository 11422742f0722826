// Augmented Vertex Block Descent (Giles, Diaz, Yuksel, SIGGRAPH 2025) for rigid links. Each link
// has a multiplier l [N] and a stiffness k [N/m] that grows while the link is violated. C is the
// stretch, C_0 the stretch at x_t, n the length of the link, and u is defined in vbd.cpp:
//
//     substep:  l *= alpha gamma;   k = clamp(gamma k, k_min, k_max)
//     sweep:    F = k (C - alpha C_0) + l,    f = -m/h^2 (x - y) + sum F u
//               H = m/h^2 I + sum k u u^T + diag |columns of F (I - u u^T)/n|,    x += H^-1 f
//     then:     l = k (C - alpha C_0) + l;    k = min(k + beta |C - alpha C_0|, k_max)
#include "core/solver/kept_slots.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/springs.hpp"
#include "core/solver/vertex_blocks.hpp"

namespace taut::solver::avbd {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("10", "sweeps over all vertices per substep"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    kVertexOrder,
    kAdaptiveStart,
    kVertexPrecision,
    ParamSpec::real("alpha", "", "0.95", 0, 1,
                    "share of the violation at a substep's start that is left for later"),
    ParamSpec::real("beta", "N/m^2", "10", 0, 1e12, "growth of k per violation and sweep"),
    ParamSpec::real("gamma", "", "0.99", 0, 1, "share of l and k kept from substep to substep"),
    ParamSpec::real("k-min", "N/m", "1", 1e-9, 1e12, "least stiffness of a link"),
    ParamSpec::real("k-max", "N/m", "1e9", 1e-9, 1e15, "largest stiffness of a link"),
};
constexpr auto kParams = loop::with_common(kOwn);

template <class Real>
class AugmentedPass final : public Pass<Real> {
 public:
  explicit AugmentedPass(const loop::Setup& s)
      : kernels_(kernels<Real>(s.simd)),
        springs_(make_springs(s.scene, s.w, {1, 1, 1})),
        blocks_(s, springs_, kernels_.sweep_augmented),
        alpha_(s.params.real("alpha")),
        beta_(s.params.real("beta")),
        gamma_(s.params.real("gamma")),
        k_min_(s.params.real("k-min")),
        k_max_(std::max(s.params.real("k-max"), k_min_)) {
    restart();
  }

  const Layout& layout() const { return blocks_.groups().layout(); }
  Points<Real>* target() override { return &blocks_.target(); }

  void restart() override {
    blocks_.restart();
    for (AugmentedSlot<Real>& slot : blocks_.slots()) {
      std::ranges::fill(slot.stiffness, static_cast<Real>(k_min_));
      std::ranges::fill(slot.multiplier, Real(0));
    }
  }

  void take_over(const Pass<Real>& before) override {
    const auto& old = static_cast<const AugmentedPass&>(before);
    blocks_.take_over(old.blocks_);
    using Slots = std::vector<AugmentedSlot<Real>>;
    const SlotsOfSprings<Slots> now{blocks_.groups(), springs_, blocks_.slots()};
    const SlotsOfSprings<const Slots> earlier{old.blocks_.groups(), old.springs_,
                                              old.blocks_.slots()};
    taut::take_over(now, earlier,
                    [](auto& slot, std::size_t lane, const auto& had, std::size_t at, int) {
                      slot.stiffness[lane] = had.stiffness[at];
                      slot.multiplier[lane] = had.multiplier[at];
                    });
  }

  void begin(Particles<Real>& p, double t, double h) override {
    update(p, kernels_.begin_augmented);
    blocks_.begin(p, t, h);
  }

  void apply(Particles<Real>& p, double, double h) override {
    constexpr double no_damping = 0;
    blocks_.sweep(p, no_damping, h);
    update(p, kernels_.augment);
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "vertices", .items = blocks_.groups().vertices(), .bytes = 0},
            {.pass = "links, each from both ends and there again for its multiplier",
             .items = 4 * springs_.size(),
             .bytes = blocks_.bytes()}};
  }

 private:
  /// Runs the kernel on the multipliers and stiffnesses of all links.
  void update(const Particles<Real>& p,
              void (*kernel)(const AugmentedStep<Real>&, std::size_t, std::size_t)) {
    const AugmentedStep<Real> step{.groups = blocks_.groups().data(),
                                   .slots = blocks_.slots().data(),
                                   .x = p.x.data(),
                                   .previous = p.previous.data(),
                                   .alpha = static_cast<Real>(alpha_),
                                   .beta = static_cast<Real>(beta_),
                                   .gamma = static_cast<Real>(gamma_),
                                   .k_min = static_cast<Real>(k_min_),
                                   .k_max = static_cast<Real>(k_max_)};
    blocks_.share(blocks_.groups().size(),
                  [&](std::size_t begin, std::size_t end) { kernel(step, begin, end); });
  }

  const Kernels<Real>& kernels_;
  std::vector<Spring> springs_;
  VertexBlocks<Real, AugmentedSlot<Real>> blocks_;
  double alpha_, beta_, gamma_, k_min_, k_max_;
};

template <class Real>
loop::Links<Real> links(const loop::Setup& s) {
  auto pass = std::make_unique<AugmentedPass<Real>>(s);
  Layout layout = pass->layout();
  return {.layout = std::move(layout), .pass = std::move(pass), .bends = true, .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, links<float>, links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  loop::refuse_faces(scene, params, "avbd", reasons);
  for (std::string& reason : elastic_links(scene)) reasons.push_back(std::move(reason));
  loop::refuse_membrane(scene, "its multipliers are of rigid links; take vbd", reasons);
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  return loop::resolved_settings(scene, params,
                                 {{kLinksSetting, "rigid"},
                                  {"vertex order", std::string(params.choice("order"))},
                                  {"work unit", "vertices, not projections"}},
                                 "in each vertex' force and Hessian", loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"beta"}, {"10", "100", "1000"}},
                                                        {{"k-min"}, {"1", "10", "100"}},
                                                        {{"order"}, {"coloured", "mesh"}},
                                                        {{"precision"}, {"double", "float"}}};

}  // namespace
}  // namespace taut::solver::avbd

TAUT_SOLVER(avbd) = {
    .name = "avbd",
    .title = "AVBD",
    .summary = "Augmented Vertex Block Descent of rigid links",
    .source = "Giles, Diaz, Yuksel 2025",
    .params = taut::solver::avbd::kParams,
    .make = taut::solver::avbd::make,
    .unsupported = taut::solver::avbd::unsupported,
    .resolved_settings = taut::solver::avbd::resolved_settings,
    .declared_step = taut::loop::implicit_euler,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .alternatives = taut::solver::avbd::kAlternatives,
                 .labelled = {"substeps", "iterations", "beta", "k-min", "order", "precision"}},
    .optional_effects = taut::loop::kOptionalEffects};
