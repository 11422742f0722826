// Section 6, bending: strips clamped at one end, against the elastica.
#include <cmath>
#include <numbers>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "core/reference/elastica.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

// m, kg/m^2: far above the 1e-9 N at which Newton ends.
constexpr double kOverhang = 0.2, kAreaDensity = 2;
const double kWeight = kAreaDensity * kG;  // N/m^2

/// A level strip of two columns and square cells along -y, with gravity along -z. Rows 0 and 1 are
/// pinned: the clamp is midway between them, and the overhang ends at the last row.
Scene strip(int segments, double stiffness, double links) {
  const double l = kOverhang / (segments - 0.5);
  Scene s = bare::sheet(2, segments + 1, {.structural = true, .shear = true}, Lumping::area, l,
                        segments * l, kAreaDensity * segments * l * l);
  s.pins = {0, 1, 2, 3};
  s.gravity = {0, 0, -kG};
  s.bending = Bending{stiffness, stiffness};
  s.stiffness = {links, links, kRigid[2]};
  return s;
}

struct Tip {
  double reach = 0, drop = 0;  ///< over the overhang
};

Tip tip(const Scene& s, const std::vector<Vec3>& x) {
  const int last = s.mesh.grid->nv - 1;
  const auto row = [&](int j) { return Vec3((x[to_index(2 * j)] + x[to_index(2 * j + 1)]) / 2); };
  const Vec3 out = row(last) - (row(0) + row(1)) / 2;
  return {-out.y() / kOverhang, -out.z() / kOverhang};
}

/// The state at rest, by steps of implicit Euler so long that inertia does not matter.
State at_rest(Scene s) {
  s.dt = 1;
  s.damping = 0;
  Simulation sim(s, "implicit:iterations=2000");
  for (int n = 0; n < 100; ++n) {
    const std::vector<Vec3> before = sim.state().x;
    sim.step();
    if (max_distance(before, sim.state().x) < 1e-10) break;
  }
  return sim.state();
}

Tip rest_of(const Scene& s) { return tip(s, at_rest(s).x); }

Scene heavy(int segments, double gamma, double links = 1e6) {
  return strip(segments, kWeight * std::pow(kOverhang, 3) / gamma, links);
}

/// A weightless strip with a weight P = force B/L^2 per width at its free end.
Scene loaded(int segments, double force) {
  const double stiffness = 0.01, l = kOverhang / (segments - 0.5);
  Scene s = strip(segments, stiffness, 1e6);
  const double end = force * stiffness / (kOverhang * kOverhang) * l / kG;  // kg, of the last row
  for (double& mass : s.mesh.mass) mass = 1e-7 * end;
  for (int i = 0; i < 2; ++i) s.mesh.mass[to_index(2 * segments + i)] = end / 2;
  return s;
}

/// Refinement from coarse to fine: how the end's distance from its exact position shrinks, and the
/// finest end.
struct Refined {
  PowerLaw order;
  Tip finest;
};

template <class SceneOf>
Refined refined(const reference::Elastica& exact, const SceneOf& scene_of) {
  Refined r;
  std::vector<double> lengths, errors;
  for (const int n : {16, 32, 64}) {
    const Tip end = rest_of(scene_of(n));
    lengths.push_back(1 / (n - 0.5));
    errors.push_back(std::hypot(end.reach - exact.reach, end.drop - exact.drop));
  }
  r.order = fit_power_law(lengths, errors);
  r.finest = rest_of(scene_of(128));
  return r;
}

constexpr const char* kImplicit = "implicit:iterations=2000";

}  // namespace

TAUT_TRUTH(heavy_elastica, 6, 10,
           "a strip clamped level hangs as B theta'' = -w (L - s) cos(theta): H/W of its end",
           "heavy elastica; the curve measured by Romero et al. 2021 is within 0.1 %") {
  if (!can_run(findings, kImplicit, heavy(4, 1))) return;
  for (const double gamma : {0.1, 1.0, 10.0, 100.0}) {
    const reference::Elastica exact = reference::elastica(gamma);
    const double want = exact.drop / exact.reach;
    const Refined r = refined(exact, [&](int n) { return heavy(n, gamma); });
    const std::string at = " at Gamma = " + as_typed(gamma);
    findings.equal(kImplicit, "H/W" + at + ", 128 segments", "1", r.finest.drop / r.finest.reach,
                   want, 1e-3 * want);
    findings.slope(kImplicit, "order in l of the end's place" + at, r.order, 2, 0.1);
  }
}

TAUT_TRUTH(cantilever_test, 6, 11,
           "seen 41.5 degrees below its clamp, a strip has a bending length of half its overhang",
           "ISO 9073-7, ASTM D1388; Peirce 1930; heavy elastica at Gamma = 8.0042") {
  const double angle = 41.5 * std::numbers::pi / 180;
  findings.equal("closed form", "bending length over overhang, elastica", "1",
                 reference::bending_length(angle), 0.5, 2e-4);
  findings.deviates("closed form", "the same after Peirce", "1",
                    reference::peirce_bending_length(angle), 0.5, 0.50932, 1e-5,
                    "his formula makes the stiffness 5.7 % too high at this angle");
  if (!can_run(findings, kImplicit, heavy(4, 1))) return;
  const Tip end = rest_of(heavy(64, 8.0));
  findings.equal(kImplicit, "angle of a strip whose bending length is half its overhang", "rad",
                 std::atan2(end.drop, end.reach), angle, 1e-3);
}

TAUT_TRUTH(end_force, 6, 12, "a weight at the end of a clamped strip: B theta'' = -P cos(theta)",
           "elastica; Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004): within 0.1 %") {
  if (!can_run(findings, kImplicit, loaded(4, 1))) return;
  for (const double force : {1.0, 4.0, 10.0}) {
    const reference::Elastica exact = reference::elastica(0, force);
    const Refined r = refined(exact, [&](int n) { return loaded(n, force); });
    const std::string at = " at P L^2/B = " + as_typed(force);
    findings.equal(kImplicit, "drop over length" + at + ", 128 segments", "1", r.finest.drop,
                   exact.drop, 1e-3 * exact.drop);
    findings.slope(kImplicit, "order in l of the end's place" + at, r.order, 2, 0.1);
  }
}

TAUT_TRUTH(clamped_circle, 6, 13,
           "clamped at both ends along a circle, a weightless strip is a part of it",
           "the elastica without load: constant curvature") {
  const int segments = 32;
  Scene s = strip(segments, 0.01, 1e7);
  s.gravity.setZero();
  const double turn = std::numbers::pi / segments, l = s.links[1].rest;
  Vec3 at = Vec3::Zero();
  std::vector<Vec3> circle = s.start.x;
  for (int j = 0; j <= segments; ++j) {
    for (int i = 0; i < 2; ++i)
      circle[to_index(2 * j + i)] = Vec3(s.mesh.rest[to_index(i)].x(), at.y(), at.z());
    at += l * Vec3(0, -std::cos(j * turn), std::sin(j * turn));
  }
  s.start.x = circle;
  for (int j = 2; j + 1 < segments; ++j)
    for (int i = 0; i < 2; ++i) s.start.x[to_index(2 * j + i)].z() += 0.1 * l * std::sin(3.0 * j);
  for (int v = 2 * segments - 2; v < 2 * segments + 2; ++v) s.pins.push_back(v);
  if (!can_run(findings, kImplicit, s)) return;
  findings.below(kImplicit, "distance from half a circle", "m", max_distance(at_rest(s).x, circle),
                 1e-6);
}

TAUT_TRUTH(bent_alike, 6, 14,
           "solvers that take bending as projections, forces, a factor or a Hessian settle alike",
           "one quadratic energy") {
  Scene s = heavy(16, 5, 5e3);
  s.damping = 5;
  s.dt = 1.0 / 64;
  if (!can_run(findings, kImplicit, s)) return;
  const State exact = at_rest(s);
  for (const char* solver :
       {"xpbd:substeps=64,iterations=16,precision=double", "pd:substeps=128,iterations=5",
        "admm:links=elastic,substeps=64,iterations=10", "vbd:substeps=16,iterations=10",
        "mass-spring:substeps=256,precision=double"}) {
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver);
    settle(sim, 1e-7, 16, 640);
    findings.below(solver, "distance from where implicit Euler's energy is least, over length", "1",
                   max_distance(sim.state().x, exact.x) / kOverhang, 1e-3);
  }
}

TAUT_TRUTH(bend_link_cantilever, 6, 15,
           "bend links of k N/m are a cubic material: tip (3/8)(4w/(k l^5))^(1/3) L^(8/3)",
           "moment k l^2 phi^3/8 of a link over two segments; derived") {
  const int segments = 16;
  const double l = 1 / (segments - 0.5), k = 1e5, weight = 2.2e-4;  // m, N/m, N/m: overhang 1 m
  Scene s = bare::chain(segments, segments * l, weight * l / kG, -Vec3::UnitY());
  for (int i = 0; i + 2 <= segments; ++i) s.links.push_back({i, i + 2, 2 * l, Family::bend});
  s.mesh.mass.back() /= 2;
  s.pins = {0, 1};
  s.gravity = {0, 0, -kG};
  s.stiffness = {1e8, kRigid[1], k};
  if (!can_run(findings, kImplicit, s)) return;
  const double want = 3.0 / 8 * std::cbrt(4 * weight / (k * std::pow(l, 5)));
  findings.equal(kImplicit, "drop of the end", "m", -at_rest(s).x.back().z(), want, 0.02 * want);
}

}  // namespace taut
