// Section 9: the reference solvers' own order and floor.
#include <cmath>

#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/truths/fit.hpp"
#include "experiments/truths/probe.hpp"

namespace taut {

namespace {

/// A draped sheet at its equilibrium, turned about its pin line and let go.
Scene swung(int n, double degrees) {
  Scene s = bare::sheet(n, n);
  s.pins = {0, n - 1};
  s.start.x[static_cast<std::size_t>(n - 1)].x() = 0.8;
  s.gravity = {0, -kG, 0};
  const auto e = reference::static_equilibrium(s);
  const Eigen::AngleAxisd turn(degrees * 3.14159265358979 / 180, Vec3::UnitX());
  for (std::size_t i = 0; i < e.x.size(); ++i) s.start.x[i] = turn * e.x[i];
  return s;
}

void static_floor(Findings& findings) {
  if (!findings.wants(kStatic)) return;
  Scene s = bare::sheet(12, 12);
  s.pins = {0, 11};
  s.start.x[11].x() = 0.7;
  s.gravity = {0, -kG, 0};
  const auto e = reference::static_equilibrium(s);
  findings.equal(kStatic, "has one answer", "1", e.unique, 1, 0);
  findings.below(kStatic, "distance between two starts and penalties: the floor", "m", e.floor,
                 1e-13);
  findings.below(kStatic, "largest violation of a length", "m", e.violation, 1e-15);
  findings.below(kStatic, "largest unbalanced force, of 2 N in all", "N", e.unbalanced, 1e-13);
}

void shake_order(Findings& findings) {
  if (!findings.wants(kShake)) return;
  const Scene s = swung(6, 60);
  const auto converged = reference::converged_motion(s, {0.25}, 1.0 / 1024);
  findings.equal(kShake, "has one answer", "1", converged.unique, 1, 0);
  if (!converged.unique) return;
  std::vector<double> dt, error;
  for (const int rate : {256, 512, 1024}) {
    reference::Shake shake(s, 1.0 / rate);
    for (int n = 0; n < rate / 4; ++n) shake.step();
    dt.push_back(1.0 / rate);
    error.push_back(max_distance(shake.state().x, converged.states[0].x));
  }
  const Slope order = log_slope(dt, error);
  findings.slope(kShake, "order in dt, 6x6 swung from 60 deg", order.value, order.error, 2, 0.05);
  findings.below(kShake, "its floor after extrapolation", "m", converged.floor[0], 1e-7);
}

void projection_tends_to_shake(Findings& findings) {
  // Fully converged sweeps follow the same motion in first order.
  const Scene s = swung(5, 45);
  const auto converged = reference::converged_motion(s, {0.25}, 1.0 / 1024);
  for (const std::string& solver : {jakobsen(150), bullet(150)}) {
    if (!claims(findings, solver, s)) continue;
    std::vector<double> dt, error;
    for (const int rate : {256, 512, 1024}) {
      Scene finer = s;
      finer.dt = 1.0 / rate;
      Probe probe(finer, solver);
      probe.step(rate / 4);
      dt.push_back(finer.dt);
      error.push_back(converged.unique ? max_distance(probe.state().x, converged.states[0].x)
                                       : std::nan(""));
    }
    const Slope order = log_slope(dt, error);
    findings.slope(solver, "order in dt of the distance from SHAKE, 5x5 swung from 45 deg",
                   order.value, order.error, 1, 0.15);
  }
}

}  // namespace
}  // namespace taut

TAUT_TRUTH(static_floor) = {.name = "static-floor",
                            .section = 9,
                            .row = 1,
                            .statement = "the static reference is at rounding, by self-convergence",
                            .source = "augmented Lagrangian, then KKT Newton",
                            .check = taut::static_floor};

TAUT_TRUTH(shake_order) = {.name = "shake-order",
                           .section = 9,
                           .row = 2,
                           .statement = "the dynamic reference has order 2.00 and knows its floor",
                           .source = "Ryckaert, Ciccotti, Berendsen 1977",
                           .check = taut::shake_order};

TAUT_TRUTH(projection_tends_to_shake) = {
    .name = "projection-tends-to-shake",
    .section = 9,
    .row = 3,
    .statement = "converged projection tends to the dynamic reference in first order",
    .source = "both have the same limit dt -> 0",
    .check = taut::projection_tends_to_shake};
