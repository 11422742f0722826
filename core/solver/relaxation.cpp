#include "core/solver/relaxation.hpp"

#include "core/model/input_error.hpp"
#include "core/solver/passes/coloured.hpp"
#include "core/solver/passes/hierarchy.hpp"
#include "core/solver/passes/jacobi.hpp"
#include "core/solver/passes/links.hpp"
#include "core/solver/passes/tethers.hpp"

namespace taut {

namespace {

/// The regular links of the scene if the strips are to hold them.
std::optional<RegularLinks> regular(const Scene& scene, Path path) {
  if (path == Path::packed) return {};
  auto links = regular_links(scene.mesh, scene.links);
  if (!links && path == Path::strips)
    throw InputError(
        "jakobsen: layout=strips needs a regular sheet of at least 17 columns with all links of a "
        "direction present and of one length; layout=packed takes any mesh");
  return links;
}

template <class Real, Projection kind>
std::unique_ptr<Pass<Real>> make_sequential(const Scene& scene, std::span<const double> w,
                                            const Params& params, const Firmness& firm) {
  const std::vector<Link> links = ordered(scene.links, scene.mesh, order_of(params),
                                          static_cast<std::uint32_t>(params.integer("seed")));
  std::vector<Stick<Real>> sticks = make_sticks<Real>(links, w, firm);
  auto costs = family_costs(links, w, sticks.size() * sizeof sticks[0]);
  if (const auto jacobi = jacobi_of(params))
    return std::make_unique<JacobiPass<Real, kind>>(*jacobi, std::move(sticks), std::move(costs),
                                                    scene.start.x.size());
  return std::make_unique<LinkPass<Real, kind>>(std::move(sticks), std::move(costs));
}

}  // namespace

template <class Real>
Relaxation<Real> make_relaxation(const Scene& scene, std::span<const double> w,
                                 const Params& params, Team& team) {
  const std::size_t n = scene.start.x.size();
  const Firmness firm =
      firmness(params, scene.dt / params.integer("substeps"), params.integer("iterations"));
  if (family_costs(scene.links, w, 0).empty()) return {Layout::packed(n), nullptr};
  const Projection projection = projection_of(params);
  if (order_of(params) != Order::coloured || jacobi_of(params)) {
    auto pass = projection == Projection::exact
                    ? make_sequential<Real, Projection::exact>(scene, w, params, firm)
                    : make_sequential<Real, Projection::sqrt_free>(scene, w, params, firm);
    return {Layout::packed(n), std::move(pass)};
  }
  const Simd simd = simd_of(params);
  if (const auto links = regular(scene, path_of(params))) {
    StripPlan<Real> plan(*links, w, firm);
    auto costs = family_costs(scene.links, w, plan.bytes());
    return {strip_layout(links->grid),
            std::make_unique<StripPass<Real>>(std::move(plan), std::move(costs), projection, simd,
                                              team)};
  }
  Layout layout = Layout::packed(n, tile_ranks(scene.links, scene.mesh));
  BatchPlan<Real> plan(colour(scene.links, scene.mesh), w, firm, layout);
  auto costs = family_costs(scene.links, w, plan.bytes());
  return {std::move(layout), std::make_unique<BatchPass<Real>>(std::move(plan), std::move(costs),
                                                               projection, simd, team)};
}

namespace {

template <class Real, Projection kind>
std::vector<std::unique_ptr<Pass<Real>>> accelerators(const Scene& scene, std::span<const double> w,
                                                      const Params& params) {
  std::vector<std::unique_ptr<Pass<Real>>> passes;
  if (const int coarse = params.integer("levels") - 1; coarse > 0)
    if (auto levels = make_hierarchy(scene, w, coarse); !levels.empty())
      passes.push_back(std::make_unique<HierarchyPass<Real, kind>>(std::move(levels), w.size()));
  if (params.is("tethers", "on"))
    if (auto tethers = make_tethers(scene); !tethers.empty())
      passes.push_back(std::make_unique<TetherPass<Real, kind>>(std::move(tethers)));
  return passes;
}

}  // namespace

template <class Real>
std::vector<std::unique_ptr<Pass<Real>>> make_accelerators(const Scene& scene,
                                                           std::span<const double> w,
                                                           const Params& params) {
  return projection_of(params) == Projection::exact
             ? accelerators<Real, Projection::exact>(scene, w, params)
             : accelerators<Real, Projection::sqrt_free>(scene, w, params);
}

template std::vector<std::unique_ptr<Pass<float>>> make_accelerators(const Scene&,
                                                                     std::span<const double>,
                                                                     const Params&);
template std::vector<std::unique_ptr<Pass<double>>> make_accelerators(const Scene&,
                                                                      std::span<const double>,
                                                                      const Params&);

template Relaxation<float> make_relaxation(const Scene&, std::span<const double>, const Params&,
                                           Team&);
template Relaxation<double> make_relaxation(const Scene&, std::span<const double>, const Params&,
                                            Team&);

}  // namespace taut
