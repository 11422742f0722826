#include "core/solver/jakobsen_params.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

constexpr ParamSpec kSpecs[] = {
    ParamSpec::integer("iterations", "3", 0, 1e6,
                       "relaxation sweeps per substep; Vasilovici's report finds that 3 suffice"),
    ParamSpec::integer("substeps", "5", 1, 1e6,
                       "each step is this many steps of dt / substeps; Jakobsen takes 1"),
    ParamSpec::choice("projection", "sqrt-free", "exact|sqrt-free",
                      "exact distance, or its first-order Taylor form without a square root"),
    ParamSpec::choice("method", "gauss-seidel",
                      "gauss-seidel|jacobi|jacobi-averaged|jacobi-underrelaxed",
                      "links one after the other, or all at once: summed, averaged, or divided by "
                      "the largest number of links at a vertex"),
    ParamSpec::choice("order", "coloured", "mesh|coloured|reversed|random|jolt",
                      "in which Gauss-Seidel visits the links; mesh is the scene's own order, as "
                      "published; jolt is Jolt Physics' order"),
    ParamSpec::integer("seed", "1", 0, 2147483647, "of order=random"),
    ParamSpec::real("omega", "", "1", 0, 2,
                    "relaxation factor: below 1 under-, above 1 over-relaxed"),
    ParamSpec::choice("contact", "continuous", "continuous|discrete|before|after|freeze|halt",
                      "response to colliders: out in every sweep, with a test against passing "
                      "through (continuous) or without (discrete); once, before or after the "
                      "sweeps; or put on the surface for good (freeze) or for a step (halt)"),
    ParamSpec::choice(
        "faces", "off", "off|on",
        "keep faces, not only vertices, out of balls and of the edges and corners of boxes"),
    ParamSpec::choice(
        "self", "grid", "grid|octree|off",
        "self-collision where the scene has it: grid, octree as published by Vasilovici, or none"),
    ParamSpec::choice(
        "tethers", "off", "off|on",
        "long-range attachments: no vertex farther from a pin than along the cloth at rest"),
    ParamSpec::integer(
        "levels", "1", 1, 20,
        "of a hierarchy, each with half the vertices of the finer one; 1: the cloth alone"),
    ParamSpec::choice("precision", "float", "float|double", "scalar type of the simulation"),
    ParamSpec::choice("layout", "auto", "auto|interleaved|batches",
                      "of the links under order=coloured: interleaved (AoSoA) for a regular sheet, "
                      "or colour batches for any mesh"),
    ParamSpec::choice("simd", "auto", "auto|scalar|sse2|avx2|avx512",
                      "instruction set; every one computes the same bits"),
    ParamSpec::integer(
        "threads", "1", 1, 64,
        "that divide the sweeps of order=coloured; any number computes the same bits"),
};

template <class T>
using Choice = std::pair<std::string_view, T>;

/// The value that the parameter's choice stands for.
template <class T, std::size_t n>
T value_of(const Params& params, std::string_view name, const Choice<T> (&choices)[n]) {
  const auto* const found = std::ranges::find(choices, params.choice(name), &Choice<T>::first);
  return found->second;  // Params accepts no other
}

constexpr Choice<Projection> kProjections[] = {{"exact", Projection::exact},
                                               {"sqrt-free", Projection::sqrt_free}};
constexpr Choice<std::optional<Jacobi>> kMethods[] = {
    {"gauss-seidel", {}},
    {"jacobi", Jacobi::plain},
    {"jacobi-averaged", Jacobi::averaged},
    {"jacobi-underrelaxed", Jacobi::underrelaxed}};
constexpr Choice<Order> kOrders[] = {{"mesh", Order::mesh},
                                     {"coloured", Order::coloured},
                                     {"reversed", Order::reversed},
                                     {"random", Order::random},
                                     {"jolt", Order::jolt}};
constexpr Choice<LinkLayout> kLayouts[] = {{"auto", LinkLayout::automatic},
                                           {"interleaved", LinkLayout::interleaved},
                                           {"batches", LinkLayout::batches}};
constexpr Choice<Response> kResponses[] = {
    {"continuous", Response::continuous}, {"discrete", Response::discrete},
    {"before", Response::before},         {"after", Response::after},
    {"freeze", Response::freeze},         {"halt", Response::halt}};
constexpr Choice<SelfCollisionMethod> kSelfCollision[] = {{"grid", SelfCollisionMethod::grid},
                                                          {"octree", SelfCollisionMethod::octree},
                                                          {"off", SelfCollisionMethod::off}};

}  // namespace

const std::span<const ParamSpec> kJakobsenParams = kSpecs;

Simd simd_of(const Params& params) {
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512})
    if (params.is("simd", to_string(simd))) {
      if (available(simd)) return simd;
      throw InputError("jakobsen: simd=" + std::string(to_string(simd)) +
                       ": this machine does not have it; its widest is " +
                       std::string(to_string(widest())));
    }
  return widest();
}

RelaxationSettings relaxation_settings(const Params& params) {
  return {.projection = value_of(params, "projection", kProjections),
          .jacobi = value_of(params, "method", kMethods),
          .order = value_of(params, "order", kOrders),
          .seed = static_cast<std::uint32_t>(params.integer("seed")),
          .layout = value_of(params, "layout", kLayouts),
          .omega = params.real("omega"),
          .levels = params.integer("levels"),
          .tethers = params.is("tethers", "on"),
          .simd = simd_of(params)};
}

ContactSettings contact_settings(const Params& params) {
  return {.response = value_of(params, "contact", kResponses),
          .faces = params.is("faces", "on"),
          .self = value_of(params, "self", kSelfCollision),
          .simd = simd_of(params)};
}

ResolvedSettings jakobsen_settings(const Scene& scene, const Params& params) {
  const double h = scene.dt / params.integer("substeps");
  ResolvedSettings lines{
      {"time step", shortest(h) + " s x " + std::string(params.value("substeps"))},
      {"integration", "Verlet"},
      {"projection", std::string(params.choice("projection")) + ", weighted by inverse mass"},
      {"gravity", "the scene's"},
      {"precision", std::string(params.choice("precision"))},
      {"link order",
       params.is("order", "mesh") ? "the scene's" : std::string(params.choice("order"))}};
  if (scene.damping > 0)
    lines.emplace_back("damping",
                       "velocity x " + shortest(std::exp(-scene.damping * h)) + " per substep");
  if (!scene.colliders.empty()) {
    lines.emplace_back("contact response", std::string(params.choice("contact")));
    lines.emplace_back("friction", "Coulomb: tangential correction at most mu times the depth");
    lines.emplace_back("contact distance", "the scene's thickness");
    lines.emplace_back("contact of faces", std::string(params.choice("faces")));
  }
  if (scene.self_collision)
    lines.emplace_back("self-collision", std::string(params.choice("self")));
  return lines;
}

}  // namespace taut
