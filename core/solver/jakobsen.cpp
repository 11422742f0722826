// Thomas Jakobsen, Advanced Character Physics (GDC 2001). TimeStep(), Verlet() and the loop over
// iterations are in core/solver/loop.cpp; this file has the relaxation of the links.
#include <cmath>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "core/solver/chebyshev.hpp"
#include "core/solver/constraints/lines.hpp"
#include "core/solver/constraints/relaxation.hpp"
#include "core/solver/loop.hpp"

namespace taut::solver::jakobsen {

namespace {

constexpr ParamSpec kParams[] = {
    loop::iterations("3",
                     "relaxation sweeps per substep; Vasilovici's report finds that 3 suffice"),
    loop::substeps("5", "each step is this many steps of dt / substeps; Jakobsen takes 1"),
    ParamSpec::choice("projection", "sqrt-free", "exact|sqrt-free",
                      "exact distance, or its first-order Taylor form without a square root"),
    ParamSpec::choice("method", "gauss-seidel",
                      "gauss-seidel|jacobi|jacobi-averaged|jacobi-underrelaxed|lines",
                      "solve links one after the other; all at once, with corrections summed, "
                      "averaged, or divided by the largest number of links at a vertex; or solve "
                      "each line of a grid's structural links at once"),
    kChebyshev,
    kOrderParam,
    ParamSpec::integer("seed", "1", 0, 2147483647, "of order=random"),
    ParamSpec::real("omega", "", "1", 0, 2,
                    "relaxation factor: below 1 under-, above 1 over-relaxed"),
    loop::kContact,
    loop::kFaces,
    loop::kSelf,
    loop::kTethers,
    ParamSpec::integer(
        "levels", "1", 1, 20,
        "levels of a hierarchy, each with half the vertices of the finer one; 1: the cloth alone"),
    loop::kPrecision,
    kLayoutParam,
    loop::kSimd,
    loop::kThreads,
};

template <class T>
using Choice = std::pair<std::string_view, T>;

constexpr Choice<Projection> kProjections[] = {{"exact", Projection::exact},
                                               {"sqrt-free", Projection::sqrt_free}};
constexpr Choice<std::optional<Jacobi>> kMethods[] = {{"gauss-seidel", {}},
                                                      {"jacobi", Jacobi::plain},
                                                      {"jacobi-averaged", Jacobi::averaged},
                                                      {"jacobi-underrelaxed", Jacobi::underrelaxed},
                                                      {"lines", {}}};

RelaxationSettings relaxation_settings(const loop::Setup& setup) {
  const Params& params = setup.params;
  return {.projection = params.one_of("projection", kProjections),
          .jacobi = params.one_of("method", kMethods),
          .lines = params.is("method", "lines"),
          .order = params.one_of("order", kOrders),
          .seed = static_cast<std::uint32_t>(params.integer("seed")),
          .layout = params.one_of("layout", kLayouts),
          .omega = params.real("omega"),
          .levels = params.integer("levels"),
          .simd = setup.simd};
}

/// The relaxation of SatisfyConstraints(); TimeStep() is in core/solver/loop.cpp.
template <class Real>
loop::Links<Real> make_links(const loop::Setup& setup) {
  const RelaxationSettings settings = relaxation_settings(setup);
  Relaxation<Real> links = make_relaxation<Real>(setup.scene, setup.w, settings, setup.pool);
  return {.layout = std::move(links.layout),
          .pass = with_chebyshev(std::move(links.pass), setup.params.real("chebyshev"),
                                 setup.w.size(), setup.pool),
          .coarse = make_levels<Real>(setup.scene, setup.w, settings),
          .tethers = settings.projection};
}

std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
  return loop::make(scene, params, make_links<float>, make_links<double>);
}

std::vector<std::string> unsolvable_lines(const Scene& scene, const Params& params) {
  if (!scene.mesh.grid) return {"method=lines needs a cloth that is a grid"};
  if (params.real("omega") != 1)
    return {"method=lines solves its links at once, without omega: leave it at 1"};
  const int substeps = params.integer("substeps");
  const double tension = line_tension(scene, scene.dt / substeps);
  if (tension <= kLargestLineTension) return {};
  return {"method=lines is unstable where h^2 T/(m l) is above 1/3, and here it is " +
          shortest(std::round(100 * tension) / 100) + ": substeps=" +
          shortest(std::ceil(substeps * std::sqrt(tension / kLargestLineTension))) + " is enough"};
}

std::vector<std::string> unsupported(const Scene& scene, const Params& params) {
  std::vector<std::string> reasons = loop::unsupported(scene, params);
  for (std::string& reason : elastic_links(scene)) reasons.push_back(std::move(reason));
  loop::refuse_membrane(scene, "rigid projections have no stiffness; xpbd gives them one", reasons);
  if (params.is("method", "lines"))
    for (std::string& reason : unsolvable_lines(scene, params))
      reasons.push_back(std::move(reason));
  return reasons;
}

ResolvedSettings resolved_settings(const Scene& scene, const Params& params) {
  const bool lines = params.is("method", "lines");
  const std::string of = lines ? ", of the links on no line" : "";
  ResolvedSettings own{
      {"projection", std::string(params.choice("projection")) + ", weighted by inverse mass" + of},
      loop::link_order(params, of)};
  if (lines)
    own.emplace_back("links solved",
                     "the structural ones of each row, then of each column, at once");
  if (params.real("chebyshev") > 0)
    own.emplace_back("acceleration", "Chebyshev, rho " + shortest(params.real("chebyshev")));
  return loop::resolved_settings(scene, params, own);
}

constexpr AccuracyParameters::Ladder kAlternatives[] = {{{"precision"}, {"float", "double"}},
                                                        {{"order"}, {"coloured", "mesh"}},
                                                        {{"omega"}, {"1.3", "1.6"}},
                                                        {{"levels"}, {"2", "3"}},
                                                        {{"tethers"}, {"on"}}};

constexpr OptionalEffect kOptionalEffects[] = {loop::kOptionalEffects[0],
                                               loop::kOptionalEffects[1],
                                               {"tethers", "tethers", {"on", "off"}},
                                               {"levels", "levels"}};

LinearModel linear_model(const Scene&, const Params& params) {
  const bool jacobi = params.is("method", "jacobi");
  if ((!jacobi && !params.is("method", "gauss-seidel")) || !params.is("order", "mesh") ||
      params.real("chebyshev") > 0 || params.integer("levels") > 1 || params.is("tethers", "on"))
    return {};
  return LinearSweeps{jacobi, params.real("omega"), params.integer("iterations"),
                      params.integer("substeps")};
}

}  // namespace
}  // namespace taut::solver::jakobsen

TAUT_SOLVER(jakobsen) = {
    .name = "jakobsen",
    .summary = "Verlet integration with relaxation of stiff distance constraints",
    .source = "Jakobsen, Advanced Character Physics, GDC 2001",
    .params = taut::solver::jakobsen::kParams,
    .make = taut::solver::jakobsen::make,
    .unsupported = taut::solver::jakobsen::unsupported,
    .resolved_settings = taut::solver::jakobsen::resolved_settings,
    .declared_step = taut::loop::implicit_euler,
    .accuracy = {.substeps = "substeps",
                 .sweeps = "iterations",
                 .link_order = "order",
                 .alternatives = taut::solver::jakobsen::kAlternatives,
                 .labelled = {"substeps", "iterations", "omega", "order", "tethers", "levels",
                              "precision"},
                 .accelerators = {"tethers", "levels", "omega", "threads"}},
    .optional_effects = taut::solver::jakobsen::kOptionalEffects,
    .linear_model = taut::solver::jakobsen::linear_model};
