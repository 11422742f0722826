// Section 9: order and floor of the reference solvers themselves.
#include <cmath>

#include "core/model/angle.hpp"
#include "core/model/index.hpp"
#include "core/reference/fit.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Steps to fit an order in dt [s].
const std::vector<double> kOrderSteps{1.0 / 256, 1.0 / 512, 1.0 / 1024};

/// Steps to fit an order, below the periods of springs [s].
const std::vector<double> kElasticSteps{1.0 / 4096, 1.0 / 8192, 1.0 / 16384};

/// A draped sheet at its equilibrium, turned about its pin line and released.
Scene swung(int n, double degrees) {
  Scene s = under_gravity(bare::sheet(n, n));
  s.pins = {0, n - 1};
  s.start.x[to_index(n - 1)].x() = 0.8;
  const auto e = reference::static_equilibrium(s);
  const Eigen::AngleAxisd turn(degrees * kDegree, Vec3::UnitX());
  for (std::size_t i = 0; i < e.x.size(); ++i) s.start.x[i] = turn * e.x[i];
  return s;
}

/// A flat sheet with shear links, hung by its top row and released: its rows stay straight.
Scene let_go(int n, double degrees) {
  Scene s = under_gravity(bare::sheet(n, n, {.shear = true}));
  for (int i = 0; i < n; ++i) s.pins.push_back(i);
  const Eigen::AngleAxisd turn(degrees * kDegree, Vec3::UnitX());
  for (Vec3& x : s.start.x) x = turn * x;
  return s;
}

/// Order in dt of the distance after 0.25 s between a solver and the converged motion; NaN if there
/// is no order.
PowerLaw order_from(const reference::Trajectory& converged, const std::vector<double>& steps,
                    const Scene& s, const std::string& solver) {
  return fit_over(steps, [&](double dt) {
    Scene finer = s;
    finer.dt = dt;
    Simulation sim(finer, solver, static_cast<int>(0.25 / dt));
    return converged.unique ? max_distance(sim.state().x, converged.states[0].x) : std::nan("");
  });
}

}  // namespace

TAUT_TRUTH(static_floor, 9, 1, "the static reference is at rounding, by self-convergence",
           "augmented Lagrangian, then KKT Newton") {
  if (!findings.wants(kStatic)) return;
  Scene s = under_gravity(bare::sheet(12, 12));
  s.pins = {0, 11};
  s.start.x[11].x() = 0.7;
  const auto e = reference::static_equilibrium(s);
  findings.holds(kStatic, "has one answer", e.unique);
  findings.below(kStatic, "distance between two starts and penalties: the floor", "m", e.floor,
                 1e-13);
  findings.below(kStatic, "largest violation of a length", "m", e.violation, 1e-15);
  findings.below(kStatic, "largest unbalanced force, of 2 N in all", "N", e.unbalanced, 1e-13);
}

TAUT_TRUTH(shake_order, 9, 2, "the dynamic reference has order 2.00 and knows its floor",
           "Ryckaert, Ciccotti, Berendsen 1977") {
  if (!findings.wants(kShake)) return;
  const Scene s = swung(6, 60);
  const auto converged = reference::converged_motion(s, {0.25}, 1.0 / 1024);
  findings.holds(kShake, "has one answer", converged.unique);
  if (!converged.unique) return;
  const PowerLaw order = fit_over(kOrderSteps, [&](double dt) {
    reference::Shake shake(s, dt);
    for (int n = 0; n < 0.25 / dt; ++n) shake.step();
    return max_distance(shake.state().x, converged.states[0].x);
  });
  findings.slope(kShake, "order in dt, 6x6 swung from 60 deg", order, 2, 0.05);
  findings.below(kShake, "its floor after extrapolation", "m", converged.floor[0], 1e-7);
}

TAUT_TRUTH(projection_tends_to_shake, 9, 3,
           "converged projection tends to the dynamic reference in first order",
           "both have the same limit dt -> 0") {
  // Fully converged sweeps follow the same motion in first order.
  const auto check = [&](const Scene& s, int sweeps, const char* quantity) {
    const auto converged = reference::converged_motion(s, {0.25}, 1.0 / 1024);
    for (const std::string& solver : {jakobsen(sweeps), bullet(sweeps)}) {
      if (!can_run(findings, solver, s)) continue;
      findings.slope(solver, quantity, order_from(converged, kOrderSteps, s, solver), 1, 0.15);
    }
  };
  check(swung(5, 45), 150, "order in dt of the distance from SHAKE, 5x5 swung from 45 deg");
  check(
      let_go(5, 45), 600,
      "order in dt of the distance from SHAKE of its rows, 5x5 with shear links let go at 45 deg");
}

TAUT_TRUTH(springs_tend_to_reference, 9, 4,
           "solvers of elastic links tend to the dynamic reference in first order",
           "the limit dt -> 0 is the undamped motion, whatever the integrator") {
  Scene s = let_go(5, 45);
  s.stiffness.fill(20);
  const auto converged = reference::converged_motion(s, {0.25}, 1.0 / 1024);
  for (const char* solver : {"implicit", "mass-spring:substeps=1,precision=double"}) {
    if (!can_run(findings, solver, s)) continue;
    findings.slope(solver, "order in dt of the distance from it, 5x5 of 20 N/m let go at 45 deg",
                   order_from(converged, kElasticSteps, s, solver), 1, 0.1);
  }
}

}  // namespace taut
