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

/// What a particle makes of the corrections that all its links ask for at the same time.
enum class Jacobi {
  plain,        ///< their sum: diverges where many links meet (truths: 2.4 per step on a chain)
  averaged,     ///< their mean: stable, does not conserve momentum
  underrelaxed  ///< their sum / the largest number of links at any particle: stable (Gershgorin
                ///< bounds the sweep's eigenvalues by it), conserves momentum, slow
};

/// How the links of Order::coloured are laid out.
enum class LinkLayout {
  automatic,    ///< interleaved if the scene is a regular sheet, else batches
  interleaved,  ///< for any other scene make_relaxation throws InputError
  batches       ///< any mesh
};

// How solvers let their links be ordered and laid out.
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
  std::uint32_t seed = 1;  ///< of Order::random
  LinkLayout layout = LinkLayout::automatic;
  double omega = 1;         ///< relaxation factor: the share of a correction that is made
  int levels = 1;           ///< of the hierarchy; 1: the cloth alone
  Compliances compliances;  ///< XPBD's: projected exactly; not with `jacobi`
  Simd simd = Simd::scalar;
};

/// The sweep over all links, and where it wants the particles to be.
template <class Real>
struct Relaxation {
  Layout layout;
  std::unique_ptr<Pass<Real>> pass;  ///< null: no link can move
};

/// Chooses by method, order and layout. w: inverse masses.
template <class Real>
Relaxation<Real> make_relaxation(const Scene&, std::span<const double> w, const RelaxationSettings&,
                                 ThreadPool&);

/// The coarse levels to relax before each sweep; none if there are none.
template <class Real>
std::vector<std::unique_ptr<Pass<Real>>> make_levels(const Scene&, std::span<const double> w,
                                                     const RelaxationSettings&);

}  // namespace taut
