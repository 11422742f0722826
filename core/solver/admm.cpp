// ADMM: Narain, Overby, Brown: ADMM >= Projective Dynamics (SCA 2016); Overby et al. (TVCG 2017).
// Each link has a target vector z and a scaled multiplier u. With d = x_b - x_a, an iteration is
//
//     p = d + u                             links:  z = r p/|p|                          (rigid)
//     u = p - z                                     z = (K r + k |p|)/(K + k) p/|p|      (spring K)
//     x from the factored system of weights k [N/m], whose target for each link is z - u
//
// The matrix is therefore that of Projective Dynamics (pd.cpp) with k in place of K. k is a
// parameter of the method alone: it decides how fast the iterations converge, not where to.
// Families that the scene leaves rigid stay rigid beside springs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/solver/damped_links.hpp"
#include "core/solver/global_system.hpp"
#include "core/solver/kept_slots.hpp"
#include "core/solver/loop.hpp"

namespace taut::solver::admm {

namespace {

constexpr ParamSpec kOwn[] = {
    loop::iterations("15", "solutions of the system per substep"),
    loop::substeps("1", "each step is this many steps of dt / substeps"),
    ParamSpec::choice("links", "rigid", "rigid|elastic",
                      "links keep their length, or are springs of the stiffness below")
        .rigid_with("rigid"),
    kStiffness[0],
    kStiffness[1],
    kStiffness[2],
    kMaterial,
    ParamSpec::real(
        "penalty", "N/m", "100", 1e-6, 1e12,
        "weight k of rigid links; the weight of springs is their stiffness times penalty-ratio; "
        "with 15 iterations, light curved cloth may gain energy above 2 m/h^2"),
    ParamSpec::real("penalty-ratio", "", "1", 1e-6, 1e6, "k / K of springs"),
    kGlobalPrecision,
    ParamSpec::choice("multipliers", "reset", "reset|keep", "at the beginning of a substep"),
};
constexpr auto kParams = loop::with_common(kOwn);

bool is_rigid(const Scene& scene, const Params& params) {
  return params.is("links", "rigid") && !takes_stiffness(scene, params);
}

template <class Real>
class AdmmPass final : public Pass<Real> {
 public:
  explicit AdmmPass(const loop::Setup& s)
      : keep_(s.params.is("multipliers", "keep")),
        forces_(kernels<Real>(s.simd).multiplier_forces),
        system_(s, weights(s, ratios_)),
        slots_(system_.template make_slots<MultiplierSlot<Real>>(
            [&](MultiplierSlot<Real>& slot, std::size_t lane, std::size_t link) {
              slot.share[lane] = static_cast<Real>(1 / (1 + ratios_[link]));
            })),
        damped_(link_damping(s), slots_) {
    forget();
  }

  const Layout& layout() const { return system_.layout(); }

  void restart() override {
    system_.restart();
    forget();
  }

  void take_over(const Pass<Real>& before) override {
    const auto& old = static_cast<const AdmmPass&>(before);
    system_.take_over(old.system_);
    using Slots = std::vector<MultiplierSlot<Real>>;
    const SlotsOfSprings<Slots> now{system_.groups(), system_.springs(), slots_};
    const SlotsOfSprings<const Slots> earlier{old.system_.groups(), old.system_.springs(),
                                              old.slots_};
    if (keep_)
      taut::take_over(now, earlier,
                      [](auto& slot, std::size_t lane, const auto& had, std::size_t at, int sign) {
                        for (int axis = 0; axis < 3; ++axis)
                          slot.multiplier[axis][lane] =
                              static_cast<Real>(sign) * had.multiplier[axis][at];
                      });
  }

  Points<Real>* target() override { return &system_.target(); }
  TouchingPieces* touching_pieces() override { return system_.touching_pieces(); }

  void begin(Particles<Real>& p, double t, double h) override {
    damped_.begin(system_.groups(), slots_, p.previous);
    system_.begin(p, t, h);
    if (!keep_) forget();
  }

  void apply(Particles<Real>& p, double, double) override {
    system_.solve(p, [this](const ForceSweep<Real>& sweep, std::size_t begin, std::size_t end) {
      forces_(sweep, slots_.data(), begin, end);
    });
  }

  std::vector<PassCost> cost() const override {
    return system_.cost("links", slots_.size() * sizeof slots_[0] + damped_.bytes() +
                                     ratios_.size() * sizeof(double));
  }

 private:
  void forget() {
    for (MultiplierSlot<Real>& slot : slots_)
      for (auto& coordinates : slot.multiplier) std::ranges::fill(coordinates, Real(0));
  }

  /// Springs of stiffness k, one for each link; appends k/K of each to `ratios` (0: rigid).
  static std::vector<Spring> weights(const loop::Setup& s, std::vector<double>& ratios) {
    constexpr double kHard = std::numeric_limits<double>::infinity();
    std::vector<Spring> springs =
        stiffened(make_springs(s.scene, s.w,
                               is_rigid(s.scene, s.params) ? std::array{kHard, kHard, kHard}
                                                           : stiffnesses(s.scene, s.params)),
                  link_damping(s));
    for (Spring& spring : springs) {
      const bool rigid = std::isinf(spring.stiffness);
      ratios.push_back(rigid ? 0 : s.params.real("penalty-ratio"));
      spring.stiffness =
          rigid ? s.params.real("penalty") : spring.stiffness * s.params.real("penalty-ratio");
    }
    return springs;
  }

  bool keep_;
  void (*forces_)(const ForceSweep<Real>&, MultiplierSlot<Real>*, std::size_t, std::size_t);
  std::vector<double> ratios_;
  GlobalSystem<Real> system_;
  std::vector<MultiplierSlot<Real>> slots_;
  DampedSlots<Real> damped_;
};

template <class Real>
loop::Links<Real> links(const loop::Setup& s) {
  auto pass = std::make_unique<AdmmPass<Real>>(s);
  Layout layout = pass->layout();
  return {.layout = std::move(layout), .pass = std::move(pass), .bends = true, .contacts = true};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, links<float>, links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  loop::refuse_membrane(scene, "its multipliers are of links; take pd, implicit, vbd or xpbd",
                        reasons);
  const Stiffness k = stiffness_of(scene, params);
  if (std::ranges::any_of(scene.links, [&](const Link& l) {
        return std::isinf(k[static_cast<std::size_t>(l.family)]);
      }))
    refuse_link_damping(scene, "it has none where links are rigid", reasons);
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const ResolvedSettings own{
      is_rigid(scene, params) ? ResolvedSetting(kLinksSetting, "rigid")
                              : describe_springs(scene, params),
      {"links solved",
       "all at once by a sparse LDLT, factored as set-up; other pins or links factor again"},
      {"work unit", "solutions of the whole system, not projections"}};
  return loop::resolved_settings(scene, params, own, "constant terms of the factored system",
                                 loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"penalty"}, {"30", "100", "300"}},
                                                        {{"multipliers"}, {"reset", "keep"}},
                                                        {{"precision"}, {"double", "float"}}};

}  // namespace
}  // namespace taut::solver::admm

TAUT_SOLVER(admm) = {
    .name = "admm",
    .title = "ADMM",
    .summary = "Alternating directions: rigid or elastic links on one factored system",
    .source = "Narain, Overby, Brown 2016; Overby et al. 2017",
    .params = taut::solver::admm::kParams,
    .make = taut::solver::admm::make,
    .unsupported = taut::solver::admm::unsupported,
    .resolved_settings = taut::solver::admm::resolved_settings,
    .declared_step = taut::loop::implicit_euler,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .all_at_once = true,
                 .alternatives = taut::solver::admm::kAlternatives,
                 .labelled = {"substeps", "iterations", "penalty", "multipliers", "precision"}},
    .optional_effects = taut::loop::kOptionalEffects};
