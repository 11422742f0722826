#include "core/solver/jakobsen_params.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

using Kind = ParamSpec::Kind;

constexpr ParamSpec kSpecs[] = {
    {.name = "iterations",
     .kind = Kind::integer,
     .default_value = "3",
     .min = 0,
     .max = 1e6,
     .help = "relaxation sweeps per substep; Vasilovici's report finds that 3 suffice"},
    {.name = "substeps",
     .kind = Kind::integer,
     .default_value = "5",
     .min = 1,
     .max = 1e6,
     .help = "each step is this many steps of dt / substeps; Jakobsen takes 1"},
    {.name = "projection",
     .kind = Kind::choice,
     .default_value = "sqrt-free",
     .choices = "exact|sqrt-free",
     .help = "exact distance, or its first-order Taylor form without a square root"},
    {.name = "method",
     .kind = Kind::choice,
     .default_value = "gauss-seidel",
     .choices = "gauss-seidel|jacobi|jacobi-averaged|jacobi-underrelaxed",
     .help = "links one after the other, or all at once: summed, averaged, or divided by the "
             "largest number of links at a vertex"},
    {.name = "order",
     .kind = Kind::choice,
     .default_value = "coloured",
     .choices = "mesh|coloured|reversed|random|jolt",
     .help = "in which Gauss-Seidel visits the links; mesh is the scene's own order, as "
             "published; jolt is Jolt Physics' order"},
    {.name = "seed",
     .kind = Kind::integer,
     .default_value = "1",
     .min = 0,
     .max = 2147483647,
     .help = "of order=random"},
    {.name = "omega",
     .kind = Kind::real,
     .default_value = "1",
     .min = 0,
     .max = 2,
     .help = "relaxation factor: below 1 under-, above 1 over-relaxed"},
    {.name = "contact",
     .kind = Kind::choice,
     .default_value = "continuous",
     .choices = "continuous|discrete|before|after|freeze|halt",
     .help = "response to colliders: out in every sweep, with a test against passing through "
             "(continuous) or without (discrete); once, before or after the sweeps; or put on the "
             "surface for good (freeze) or for a step (halt)"},
    {.name = "faces",
     .kind = Kind::choice,
     .default_value = "off",
     .choices = "off|on",
     .help = "keep faces, not only vertices, out of balls and of the edges and corners of boxes"},
    {.name = "self",
     .kind = Kind::choice,
     .default_value = "grid",
     .choices = "grid|octree|off",
     .help =
         "self-collision where the scene has it: grid, octree as published by Vasilovici, or none"},
    {.name = "tethers",
     .kind = Kind::choice,
     .default_value = "off",
     .choices = "off|on",
     .help = "long-range attachments: no vertex farther from a pin than along the cloth at rest"},
    {.name = "levels",
     .kind = Kind::integer,
     .default_value = "1",
     .min = 1,
     .max = 20,
     .help = "of a hierarchy, each with half the vertices of the finer one; 1: the cloth alone"},
    {.name = "precision",
     .kind = Kind::choice,
     .default_value = "float",
     .choices = "float|double",
     .help = "scalar type of the simulation"},
    {.name = "layout",
     .kind = Kind::choice,
     .default_value = "auto",
     .choices = "auto|interleaved|batches",
     .help =
         "of the links under order=coloured: interleaved (AoSoA) for a regular sheet, or colour "
         "batches for any mesh"},
    {.name = "simd",
     .kind = Kind::choice,
     .default_value = "auto",
     .choices = "auto|scalar|sse2|avx2|avx512",
     .help = "instruction set; every one computes the same bits"},
    {.name = "threads",
     .kind = Kind::integer,
     .default_value = "1",
     .min = 1,
     .max = 64,
     .help = "that divide the sweeps of order=coloured; any number computes the same bits"},
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
