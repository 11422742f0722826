#include "core/solver/relaxation.hpp"

#include "core/model/input_error.hpp"
#include "core/solver/passes/coloured.hpp"
#include "core/solver/passes/jacobi.hpp"
#include "core/solver/passes/links.hpp"

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
  BatchPlan<Real> plan(colour(scene.links, scene.mesh), w, firm);
  auto costs = family_costs(scene.links, w, plan.bytes());
  return {Layout::packed(n), std::make_unique<BatchPass<Real>>(std::move(plan), std::move(costs),
                                                               projection, simd, team)};
}

template Relaxation<float> make_relaxation(const Scene&, std::span<const double>, const Params&,
                                           Team&);
template Relaxation<double> make_relaxation(const Scene&, std::span<const double>, const Params&,
                                            Team&);

}  // namespace taut
