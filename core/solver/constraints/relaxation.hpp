#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/model/params.hpp"
#include "core/model/scene.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// How a particle combines the corrections that all its links ask for at the same time.
enum class Jacobi {
  plain,        ///< their sum: diverges where many links meet (truths: 2.4 per step on a chain)
  averaged,     ///< their mean: stable, does not conserve momentum
  underrelaxed  ///< their sum / the largest number of links at any particle: stable (Gershgorin
                ///< bounds the sweep's eigenvalues by it), conserves momentum, slow
};

/// How the links of Order::coloured are laid out.
enum class LinkLayout {
  automatic,    ///< interleaved if the scene is a regular sheet, otherwise batches
  interleaved,  ///< make_relaxation throws InputError unless the scene is a regular sheet
  batches       ///< any mesh
};

// Parameters for the order and the layout of the links.
inline constexpr ParamSpec kOrderParam =
    ParamSpec::choice("order", "coloured", "mesh|coloured|reversed|random|jolt",
                      "in which Gauss-Seidel visits the links; mesh is the scene's own order, as "
                      "published; jolt is Jolt Physics' order");
inline constexpr std::pair<std::string_view, Order> kOrders[] = {{"mesh", Order::mesh},
                                                                 {"coloured", Order::coloured},
                                                                 {"reversed", Order::reversed},
                                                                 {"random", Order::random},
                                                                 {"jolt", Order::jolt}};
inline constexpr ParamSpec kLayoutParam =
    ParamSpec::choice("layout", "auto", "auto|interleaved|batches",
                      "memory layout of the links with order=coloured: interleaved (AoSoA) for a "
                      "regular sheet, or colour batches for any mesh");
inline constexpr std::pair<std::string_view, LinkLayout> kLayouts[] = {
    {"auto", LinkLayout::automatic},
    {"interleaved", LinkLayout::interleaved},
    {"batches", LinkLayout::batches}};

struct RelaxationSettings {
  Projection projection = Projection::sqrt_free;
  std::optional<Jacobi> jacobi;  ///< empty: Gauss-Seidel
  bool lines = false;            ///< structural links of a grid line by line (lines.hpp)
  Order order = Order::coloured;
  std::uint32_t seed = 1;  ///< for Order::random
  LinkLayout layout = LinkLayout::automatic;
  double omega = 1;         ///< relaxation factor: the share of a correction that is made
  int levels = 1;           ///< number of levels of the hierarchy; 1: the cloth alone
  Compliances compliances;  ///< of XPBD, whose links are projected exactly; not with `jacobi`
  Simd simd = Simd::scalar;
};

/// The sweep over all links, and the layout that it needs the particles in.
template <class Real>
struct Relaxation {
  Layout layout;
  std::unique_ptr<Pass<Real>> pass;  ///< null: no link can move
};

/// Makes the sweep for the settings' method, order and layout. w: inverse masses [1/kg].
template <class Real>
Relaxation<Real> make_relaxation(const Scene&, std::span<const double> w, const RelaxationSettings&,
                                 ThreadPool&);

/// The coarse levels to relax before each sweep; empty if levels is 1.
template <class Real>
std::vector<std::unique_ptr<Pass<Real>>> make_levels(const Scene&, std::span<const double> w,
                                                     const RelaxationSettings&);

}  // namespace taut
