#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "core/solver/contact/responses.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/distance.hpp"
#include "core/solver/thread_pool.hpp"

/// The step that solvers of distance constraints share (core/solver/loop.cpp): Verlet, pins and
/// their motions, wind, damping, contact, self-collision, tethers, substeps, threads, float and
/// double. A new solver is one file that adds a pass that solves the links.
///
///     template <class Real>
///     class MyLinks final : public Pass<Real> {               // core/solver/layout/particles.hpp
///       void restart() override;                              // load() was called: forget
///       void accelerate(Particles<Real>&, double t, double h) override;
///       void begin(Particles<Real>&, double t, double h) override;
///       void apply(Particles<Real>&, double t, double h) override;
///       void end(Particles<Real>&, double t, double h) override;
///       std::vector<PassCost> cost() const override;
///     };
///     template <class Real>
///     loop::Links<Real> make_links(const loop::Setup& s) {
///       return {.layout = Layout::packed(s.w.size()), .pass = std::make_unique<MyLinks<Real>>(s)};
///     }
///     std::unique_ptr<Solver> make(const Scene& scene, const Params& params) {
///       return loop::make<double>(scene, params, make_links<double>);
///     }
///
/// A substep [t, t + h] of the loop, where p are its particles:
///
///  1. accelerate(), if Links::accelerates: p.x = x_t, and (p.x - p.previous) / h is the velocity
///     [m/s], as always between substeps. What is added to p.a [m/s^2] is integrated in 2.
///  2. Verlet: p.previous = x_t and p.x = y = x_t + exp(-damping h) (x_t - x_t-1) + h^2 (g + p.a);
///     pins move to their positions at t + h.
///  3. begin(): y and x_t can be saved; multipliers are reset, or kept.
///  4. `iterations` times: apply() moves p.x once towards the links' lengths, then contact with
///     friction pushes out what is inside colliders. apply() finds p.x as contact left it. With
///     Links::contacts, contact comes once, after the last iteration.
///     In between, the loop projects the scene's membrane and bending, unless Links::stretches and
///     Links::bends (make_membrane_pass, make_bending_pass).
///  5. end(): after the last iteration. To move p.x without changing its velocity, move p.previous
///     by the same amount.
///
/// Rules for a pass: p.w[i] = 0 [1/kg] marks a pin, whose p.x must not be written. A pass stores
/// everything else that it needs from earlier steps. Loops over particles read p.x[i] and write
/// p.x.set(i, ..), in any layout; with Layout::packed(n), x y z 0 of particle i are at
/// p.x.data() + 4 i. cost() is the cost of one apply(); set `projections` in an entry that solves
/// links one by one.
namespace taut::loop {

/// The inputs from which a solver makes its passes.
struct Setup {
  const Scene& scene;
  const Params& params;
  std::span<const double> w;  ///< [n] inverse masses [1/kg]; 0: pinned
  Simd simd;                  ///< for kernels<Real>()
  ThreadPool& pool;           ///< for passes that queue work
};

/// What a solver adds to the loop. Each iteration runs `coarse`, then tethers, then `pass`.
template <class Real>
struct Links {
  Layout layout;                                    ///< where the particles lie in memory
  std::unique_ptr<Pass<Real>> pass = nullptr;       ///< null: no link can move
  bool accelerates = false;                         ///< `pass` has accelerate(), which needs p.a
  bool bends = false;                               ///< `pass` includes the scene's bending
  bool stretches = false;                           ///< `pass` includes the scene's membrane
  bool contacts = false;                            ///< `pass` includes contact (Contacts)
  std::vector<std::unique_ptr<Pass<Real>>> coarse;  ///< accelerators of `pass`
  Projection tethers = Projection::exact;
};
template <class Real>
using MakeLinks = Links<Real> (*)(const Setup&);

/// Makes the solver. Throws InputError if this machine does not have the instruction set.
template <class Real>
std::unique_ptr<Solver> make(const Scene&, const Params&, MakeLinks<Real>);

/// Makes the solver in float or double, by the parameter `precision`.
inline std::unique_ptr<Solver> make(const Scene& scene, const Params& params,
                                    MakeLinks<float> in_float, MakeLinks<double> in_double) {
  if (params.is("precision", "float")) return make<float>(scene, params, in_float);
  return make<double>(scene, params, in_double);
}

/// Reasons why the loop itself would get the scene wrong (SolverEntry::unsupported).
std::vector<std::string> unsupported(const Scene&, const Params&);

/// Adds the reason why `solver` refuses contact of edges and faces: cloth whose edges touch a
/// collider does not come to rest with it.
void refuse_faces(const Scene&, const Params&, std::string_view solver,
                  std::vector<std::string>& reasons);

/// Adds the reason why `solver` refuses a membrane: `why`.
void refuse_membrane(const Scene&, std::string_view why, std::vector<std::string>& reasons);

/// How friction acts where contact is projected, and where it is part of the solve (Contacts).
inline constexpr std::string_view
    kProjectedFriction = "Coulomb: tangential correction at most mu times the depth",
    kSolvedFriction = "Coulomb: friction at most mu times the push, forces of the solve itself";

/// The loop's settings, with `own` after those of time integration
/// (SolverEntry::resolved_settings). bending: how the scene's bending is solved.
ResolvedSettings resolved_settings(
    const Scene&, const Params&, const ResolvedSettings& own,
    std::string_view bending = "projected after the links with compliance and multipliers (XPBD)",
    std::string_view friction = kProjectedFriction);

/// SolverEntry::declared_step of a solver of the loop that approximates implicit Euler of each
/// substep, with its links and contact of vertices.
DeclaredStep implicit_euler(const Scene&, const Params&);

/// The setting of the parameter `order`. of: the links that are ordered.
ResolvedSetting link_order(const Params&, const std::string& of = "");

// Parameters of the loop. A solver may leave out `iterations` (then one), `tethers` and `precision`
// (then double).
constexpr ParamSpec iterations(std::string_view default_value, std::string_view help) {
  return ParamSpec::integer("iterations", default_value, 0, 1e6, help);
}
constexpr ParamSpec substeps(std::string_view default_value, std::string_view help) {
  return ParamSpec::integer("substeps", default_value, 1, 1e6, help);
}
inline constexpr ParamSpec kContact = ParamSpec::choice(
    "contact", "continuous", "continuous|discrete|before|after|freeze|halt",
    "response to colliders: push vertices out in every sweep, with a test against passing through "
    "(continuous) or without (discrete); or as published, where cloth does not come to rest "
    "correctly: push them out once, before or after the sweeps, or put them on the surface for "
    "good (freeze) or for a step (halt)");
inline constexpr ParamSpec kFaces =
    ParamSpec::choice(
        "faces", "off", "off|edges|on",
        "keep edges of the cloth (edges), or faces and edges (on), not only vertices, "
        "out of balls, capsules, boxes and solid bodies of triangles; rigid links longer than the "
        "radius of what they run over catch on it until the load pulls them over; vbd, avbd and "
        "xpbd "
        "with primal=on refuse it, since cloth whose edges touch does not come to rest with them")
        .as(ParamSpec::Role::face_contact);
inline constexpr ParamSpec kSelf = ParamSpec::choice(
    "self", "grid", "grid|octree|off",
    "self-collision where the scene has it: grid, octree as published by Vasilovici, or none");
inline constexpr ParamSpec kTethers = ParamSpec::choice(
    "tethers", "off", "off|on",
    "long-range attachments: no vertex is farther from a pin than it is along the cloth at rest");
inline constexpr ParamSpec kPrecision =
    ParamSpec::choice("precision", "float", "float|double", "scalar type of the simulation")
        .as(ParamSpec::Role::precision);
inline constexpr ParamSpec kSimd =
    ParamSpec::choice("simd", "auto", "auto|scalar|sse2|avx2|avx512",
                      "instruction set; every one computes the same bits")
        .as(ParamSpec::Role::instructions);
inline constexpr ParamSpec kThreads = ParamSpec::integer(
    "threads", "1", 1, 64,
    "threads that share the sweeps of order=coloured; any number computes the same bits");

/// Parameters of effects that a scene may not need (SolverEntry::optional_effects).
inline constexpr OptionalEffect kOptionalEffects[] = {
    {"contact of faces", "faces", {"on", "edges", "off"}, true},
    {"continuous detection", "contact", {"continuous", "discrete"}, true}};

/// A solver's own parameters, followed by those that every solver of the loop has.
template <std::size_t n>
constexpr auto with_common(const ParamSpec (&own)[n]) {
  constexpr std::array common{kContact, kFaces, kSelf, kSimd, kThreads};
  std::array<ParamSpec, n + common.size()> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i < n ? own[i] : common[i - n];
  return all;
}

}  // namespace taut::loop
