#include "core/solver/jakobsen_params.hpp"

#include <cmath>
#include <limits>

#include "core/model/input_error.hpp"
#include "core/model/shortest.hpp"
#include "core/solver/contact/responses.hpp"

namespace taut {

namespace {

using Kind = ParamSpec::Kind;
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr ParamSpec kSpecs[] = {
    {.name = "iterations",
     .kind = Kind::integer,
     .default_value = "3",
     .min = 0,
     .max = 1e6,
     .help = "relaxation sweeps per substep; the report finds that 3 suffice"},
    {.name = "substeps",
     .kind = Kind::integer,
     .default_value = "5",
     .min = 1,
     .max = 1e6,
     .help = "each step is this many steps of dt / substeps; the report takes 1"},
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
     .choices = "mesh|coloured|reversed|random",
     .help = "in which Gauss-Seidel visits the links; mesh is the scene's own order, as the report "
             "has it"},
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
    {.name = "structural_stiffness",
     .kind = Kind::real,
     .unit = "N/m",
     .default_value = "inf",
     .min = 0,
     .max = kInf,
     .help = "of a structural link, whatever the time step and the sweeps; inf: a stick"},
    {.name = "shear_stiffness",
     .kind = Kind::real,
     .unit = "N/m",
     .default_value = "inf",
     .min = 0,
     .max = kInf,
     .help = "of a shear link"},
    {.name = "bend_stiffness",
     .kind = Kind::real,
     .unit = "N/m",
     .default_value = "inf",
     .min = 0,
     .max = kInf,
     .help = "of a bend link"},
    {.name = "contact",
     .kind = Kind::choice,
     .default_value = "swept",
     .choices = "swept|sweep|before|after|freeze|halt",
     .help = "response to colliders: in every sweep, with or without the test against passing "
             "through; once, before or after the sweeps; or the report's quick fixes"},
    {.name = "faces",
     .kind = Kind::choice,
     .default_value = "off",
     .choices = "off|on",
     .help = "keep faces, not only vertices, out of balls and of the edges and corners of boxes"},
    {.name = "self",
     .kind = Kind::choice,
     .default_value = "grid",
     .choices = "grid|octree|off",
     .help = "self-collision where the scene has it: hash grid, the report's octree, or none"},
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
     .choices = "auto|strips|packed",
     .help = "of the particles under order=coloured: strips of a regular sheet, or packed for any "
             "mesh"},
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
     .help = "that share the sweeps of order=coloured; any number computes the same bits"},
};

}  // namespace

const std::span<const ParamSpec> kJakobsenParams = kSpecs;

Path path_of(const Params& params) {
  if (params.is("layout", "strips")) return Path::strips;
  if (params.is("layout", "packed")) return Path::packed;
  return Path::automatic;
}

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

Projection projection_of(const Params& params) {
  return params.is("projection", "exact") ? Projection::exact : Projection::sqrt_free;
}

Order order_of(const Params& params) {
  if (params.is("order", "coloured")) return Order::coloured;
  if (params.is("order", "reversed")) return Order::reversed;
  if (params.is("order", "random")) return Order::random;
  return Order::mesh;
}

std::optional<Jacobi> jacobi_of(const Params& params) {
  if (params.is("method", "jacobi")) return Jacobi::plain;
  if (params.is("method", "jacobi-averaged")) return Jacobi::averaged;
  if (params.is("method", "jacobi-underrelaxed")) return Jacobi::under;
  return {};
}

Firmness firmness(const Params& params, double substep, int iterations) {
  return {.stiffness = {params.real("structural_stiffness"), params.real("shear_stiffness"),
                        params.real("bend_stiffness")},
          .omega = params.real("omega"),
          .substep = substep,
          .iterations = iterations};
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
  for (auto& line : contact_settings(scene, params)) lines.push_back(std::move(line));
  return lines;
}

}  // namespace taut
