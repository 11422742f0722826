// Properties that every solver must have, whatever its method, checked for the solvers that `taut
// verify --solver` names, or for all solvers of this program. Tolerances allow for float32.
#include <cmath>

#include "core/model/index.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// A free sheet whose links are all a fiftieth too long.
Scene stretched() {
  Scene s = bare::sheet(6, 5, {.shear = true});
  for (Vec3& x : s.start.x) x *= 1.02;
  return s;
}

void momentum(Findings& findings, const std::string& solver) {
  Scene s = stretched();
  s.gravity = Vec3(0, -kG, 0);
  if (!can_run(findings, solver, s)) return;
  const Vec3 throw_(1, 2, -0.5);
  for (Vec3& v : s.start.v) v = throw_;
  Simulation sim(s, solver, 64);
  const Vec3 way = mean(s.mesh.mass, sim.state().x) - mean(s.mesh.mass, s.start.x) - throw_;
  // g t^2/2 (1 + c/n), where the integrator decides -1 <= c <= 1
  findings.equal(solver, "fall of the centre of mass of a strained sheet over g t^2/2 at 1 s", "1",
                 -way.y() / (kG / 2), 1, 1.05 / 64);
  findings.below(solver, "its way across gravity, beyond v0 t", "m", std::hypot(way.x(), way.z()),
                 1e-4);
}

void rest(Findings& findings, const std::string& solver) {
  const Scene s = bare::sheet(6, 5, {.shear = true});
  if (!can_run(findings, solver, s)) return;
  Simulation sim(s, solver, 64);
  findings.below(solver, "way of a sheet at rest that nothing moves, in 1 s", "m",
                 max_distance(sim.state().x, s.start.x), 1e-5);
}

void pins(Findings& findings, const std::string& solver) {
  Scene s = stretched();
  s.gravity = Vec3(0, -kG, 0);
  s.pins = {0, 5};
  if (!can_run(findings, solver, s)) return;
  Simulation sim(s, solver, 64);
  double way = 0;
  for (const int pin : s.pins) way = std::max(way, (sim.x(pin) - s.start.x[to_index(pin)]).norm());
  findings.below(solver, "way of two pinned vertices in 1 s", "m", way, 1e-6);
}

void moving_pins(Findings& findings, const std::string& solver) {
  Scene s = stretched();
  s.pins = {0, 5};
  s.pin_motions = {{{0}, {.velocity = {0.1, 0, 0.2}}},
                   {{5}, {.spin = {0, 1, 0.5}, .pivot = {0.5, 0, 0}}}};
  if (!can_run(findings, solver, s)) return;
  Simulation sim(s, solver);
  const double off = sim.worst(64, [&](int n) {
    double most = 0;
    for (const int pin : s.pins)
      most = std::max(most, (sim.x(pin) - pin_position(s, pin, n * s.dt)).norm());
    return most;
  });
  findings.below(solver, "distance of two moving pins from their places, within 1 s", "m", off,
                 1e-6);
}

/// A solver given by name alone, in double and with enough sweeps: a descent that has not converged
/// keeps no momentum, and float32 has a rounding that substeps multiply. A solver given with
/// parameters is left as it is.
std::string converged(const std::string& solver) {
  const SolverEntry* const entry = parse_solver(solver).entry;
  if (solver.find(':') != solver.npos || entry->foreign()) return solver;
  std::string text = solver;
  for (const ParamSpec& spec : entry->params) {
    if (spec.role == ParamSpec::Role::precision)
      text = with(text, std::string(spec.name) + "=double");
    if (!spec.name.empty() && spec.name == entry->accuracy.sweeps)
      text = with(text, std::string(spec.name) + "=1000");
  }
  return text;
}

}  // namespace

TAUT_TRUTH(any_solver, 3, 10,
           "Links move no centre of mass, pins are where the scene has them, a sheet at rest rests",
           "Newton's laws") {
  std::vector<std::string> all = findings.asked();
  if (all.empty())
    for (const SolverEntry* entry : solvers()) all.emplace_back(entry->name);
  std::erase(all, "reference");
  for (const std::string& asked : all) {
    const std::string solver = converged(asked);
    for (const auto& check : {momentum, rest, pins, moving_pins}) try {
        check(findings, solver);
      } catch (const SolverFailure& failure) {
        findings.below(solver, std::string(to_string(failure.status)) + ": " + failure.what(), "1",
                       std::nan(""), 0);
      }
  }
}

}  // namespace taut
