// Macklin, Mueller, Chentanez, XPBD: Position-Based Simulation of Compliant Constrained Dynamics
// (MIG 2016), with the substeps of Macklin et al., Small Steps in Physics Simulation (SCA 2019).
//
// Algorithm 1 with C = |x2 - x1| - rest and n = delta/|delta| (equations 17 and 18):
//
//     dlambda = (-C - alpha/h^2 lambda) / (w1 + w2 + alpha/h^2),   lambda = 0 at every substep
//     x1 -= w1 dlambda n;   x2 += w2 dlambda n;   lambda += dlambda
//
// alpha [m/N] is the inverse of a spring constant. The arithmetic is in compliant_excess
// (core/solver/simd/distance.hpp), the step in core/solver/loop.cpp. With alpha = 0 every bit
// equals that of jakobsen:projection=exact. method=global solves all links at once instead
// (core/solver/xpbd_global.hpp). Damped links have another alpha, and another rest length in each
// substep (core/model/link_damping.hpp): equation 26 with gamma = b/h, and the change of length in
// place of its linearisation grad C (x - x_t).
#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"
#include "core/solver/constraints/relaxation.hpp"
#include "core/solver/damped_links.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/xpbd_global.hpp"

namespace taut::solver::xpbd {

namespace {

constexpr auto kParams = loop::with_common(
    {loop::substeps("8", "each step is this many steps of dt / substeps").but("method=global", "1"),
     loop::iterations(
         "1",
         "sweeps per substep (Small Steps finds one to be best), or solutions with method=global")
         .but("method=global", "3")
         .but("primal=on", "10"),
     ParamSpec::real("structural", "m/N", "0", 0, 1e12, "compliance of structural links")
         .compliance_of(Family::structural),
     ParamSpec::real("shear", "m/N", "0", 0, 1e12, "compliance of shear links")
         .compliance_of(Family::shear),
     ParamSpec::real("bend", "m/N", "0", 0, 1e12, "compliance of bend links")
         .compliance_of(Family::bend),
     loop::kPrecision, kMaterial,
     ParamSpec::choice("multipliers", "keep", "keep|reset",
                       "keep multipliers from sweep to sweep within a substep, as published, or "
                       "reset them to 0 before each sweep, which loses the compliance"),
     ParamSpec::choice("method", "sweeps", "sweeps|global",
                       "solve link after link, as published, or all at once by a sparse LDLT in "
                       "each iteration (fast projection)"),
     ParamSpec::choice("primal", "off", "off|on",
                       "with method=global: minimise implicit Euler's energy with a line search, "
                       "so that iterations converge to its step, with contact in the solve"),
     kOrderParam, ParamSpec::integer("seed", "1", 0, 2147483647, "of order=random"), kLayoutParam,
     loop::kTethers});

/// Compliances [m/N] by family.
std::array<double, kFamilies.size()> compliances(const Scene& scene, const Params& params) {
  std::array<double, kFamilies.size()> all;
  for (const Family family : kFamilies) {
    const auto f = static_cast<std::size_t>(family);
    all[f] =
        takes_stiffness(scene, params) ? 1 / scene.stiffness[f] : params.real(to_string(family));
  }
  return all;
}

template <class Real>
loop::Links<Real> make_links(const loop::Setup& setup) {
  const Params& params = setup.params;
  if (params.is("method", "global"))
    return make_global_links<Real>(setup, stiffness_of(setup.scene, params),
                                   params.is("primal", "on"));
  const double h = setup.scene.dt / params.integer("substeps");
  Compliances links{.over_h2 = compliances(setup.scene, params)};
  const LinkDamping damping = link_damping(setup);
  for (double& compliance : links.over_h2) compliance /= h * h * damping.stiffer();
  links.damped = damping.share();
  // In a single sweep every multiplier starts at 0, so none is needed.
  links.multipliers = params.is("multipliers", "keep") && params.integer("iterations") > 1 &&
                      std::ranges::any_of(links.over_h2, [](double a) { return a > 0; });
  const RelaxationSettings settings{.projection = Projection::exact,
                                    .order = params.one_of("order", kOrders),
                                    .seed = static_cast<std::uint32_t>(params.integer("seed")),
                                    .layout = params.one_of("layout", kLayouts),
                                    .compliances = links,
                                    .simd = setup.simd};
  Relaxation<Real> sweep = make_relaxation<Real>(setup.scene, setup.w, settings, setup.pool);
  return {.layout = std::move(sweep.layout), .pass = std::move(sweep.pass)};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, make_links<float>, make_links<double>);
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  const Stiffness k = stiffness_of(scene, params);
  if (std::ranges::all_of(k, [](double one) { return std::isinf(one); }))
    refuse_link_damping(scene, "its links are rigid", reasons);
  const bool primal = params.is("primal", "on");
  if (params.is("method", "sweeps")) {
    if (primal) reasons.emplace_back("primal=on needs method=global");
    if (params.is("layout", "interleaved"))
      refuse_link_damping(
          scene, "layout=interleaved has one rest length for all links of a direction", reasons);
    return reasons;
  }
  if (params.is("multipliers", "reset"))
    reasons.emplace_back("multipliers=reset needs method=sweeps");
  if (!primal) return reasons;
  const std::string own = "primal=on minimises an energy of links and contact, without ";
  if (scene.bending) reasons.push_back(own + "bending");
  if (scene.membrane) reasons.push_back(own + "membrane");
  if (params.is("tethers", "on")) reasons.push_back(own + "tethers");
  loop::refuse_faces(scene, params, "primal=on", reasons);
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const auto all = compliances(scene, params);
  const auto of_family = [&](Family family) {
    return std::string(to_string(family)) + " " + shortest(all[static_cast<std::size_t>(family)]);
  };
  const double structural = all[static_cast<std::size_t>(Family::structural)];
  const ResolvedSetting links(kLinksSetting,
                              "compliance in m/N: " + join(kFamilies, ", ", of_family), "",
                              structural > 0 ? 1 / structural : std::nan(""));
  if (params.is("method", "sweeps"))
    return loop::resolved_settings(
        scene, params,
        {{"projection", "exact, multipliers " + std::string(params.choice("multipliers"))},
         links,
         loop::link_order(params)});
  const bool primal = params.is("primal", "on");
  const ResolvedSettings own{
      links,
      {"links solved", std::string("all at once by a sparse LDLT, analysed once as set-up") +
                           (primal ? ", down implicit Euler's energy" : "")},
      {"work unit", "factorisations of the links' system, not projections"}};
  if (!primal) return loop::resolved_settings(scene, params, own);
  return loop::resolved_settings(scene, params, own, "refused", loop::kSolvedFriction);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"precision"}, {"float", "double"}},
                                                        {{"order"}, {"coloured", "mesh"}},
                                                        {{"tethers"}, {"on"}},
                                                        {{"method"}, {"global"}},
                                                        {{"primal"}, {"on"}}};

LinearModel linear_model(const Scene& scene, const Params& params) {
  if (params.is("method", "global")) return {};
  for (const double compliance : compliances(scene, params))
    if (compliance != 0) return {};
  if (!params.is("order", "mesh") || params.is("tethers", "on")) return {};
  return LinearSweeps{.sweeps = params.integer("iterations"),
                      .substeps = params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::xpbd

TAUT_SOLVER(xpbd) = {
    .name = "xpbd",
    .title = "XPBD",
    .summary = "Compliant position-based dynamics with substeps",
    .source = "Macklin, Mueller, Chentanez 2016; Macklin et al. 2019; Goldenthal et al. 2007",
    .params = taut::solver::xpbd::kParams,
    .make = taut::solver::xpbd::make,
    .unsupported = taut::solver::xpbd::unsupported,
    .resolved_settings = taut::solver::xpbd::resolved_settings,
    .declared_step = taut::loop::implicit_euler,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .link_order = "order",
                 .alternatives = taut::solver::xpbd::kAlternatives,
                 .labelled = {"substeps", "iterations", "method", "primal", "order", "tethers",
                              "precision"},
                 .accelerators = {"tethers", "threads"}},
    .optional_effects = taut::loop::kOptionalEffects,
    .linear_model = taut::solver::xpbd::linear_model};
