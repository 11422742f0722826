// Section 8, what Vasilovici's report says of springs, steps, sweeps and the sides of a box.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/truths/simulation.hpp"

namespace taut {

namespace {

constexpr const char* kClosed = "closed form";

Scene particle_at_box(const Vec3& x, const Vec3& velocity) {
  Scene s = bare::scene({x, x + Vec3(0, 0, 50)}, {1, 1}, {});
  s.start.v = {velocity, Vec3::Zero()};
  s.colliders.push_back(
      {Box{Vec3::Zero(), {0.5, 0.5, 0.5}, Eigen::Quaterniond::Identity()}, {}, 0});
  return s;
}

}  // namespace

/// x* = 2x - x' + a dt^2 in steps of h and h/2 by turns.
TAUT_TRUTH(verlet_fixed_step, 8, 11,
           "2x - x' is a velocity only while the step is fixed: by turns h and h/2 it is 4/3",
           "Vasilovici, Cloth Simulation Report, section 3") {
  constexpr int kSteps = 100;
  constexpr double kStep = 0.01;  // s
  double x = 0, before = -kStep, t = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double now = x;
    x = 2 * x - before;
    before = now, t += n % 2 == 0 ? kStep : kStep / 2;
  }
  findings.equal(kClosed, "way of a free particle over speed times time, steps of h and h/2", "1",
                 x / t, 4.0 / 3, 1e-12);
}

/// A square hung by two corners on its structural links alone, and with the others.
TAUT_TRUTH(spring_families, 8, 12,
           "without shear links a square hung by two corners sags; bend links do little",
           "Vasilovici, Cloth Simulation Report, section 3") {
  const std::string solver = jakobsen(16);
  const auto loss = [&](bool shear, bool bend) {
    Scene s = bare::sheet(9, 9, {true, shear, bend});
    s.gravity = {0, -kG, 0}, s.damping = 1;
    s.pins = {0, 8};
    Simulation sim(s, solver);
    sim.step(640);
    return s.start.x[8 * 9 + 4].y() - sim.x(8 * 9 + 4).y();
  };
  if (!can_run(findings, solver, bare::sheet(2, 2))) return;
  const double all = loss(true, true), no_bend = loss(true, false), no_shear = loss(false, false);
  findings.equal(solver, "sag of the lower edge without shear links, over that with all", "1",
                 no_shear / all, 60, 30);
  findings.equal(solver, "the same without bend links, which a flat sheet hardly needs", "1",
                 no_bend / all, 2, 1);
}

/// Divisions of one frame, one in each projection.
TAUT_TRUTH(divisions, 8, 13, "without the root a sweep takes N divisions, k sweeps k N",
           "Vasilovici, Cloth Simulation Report, section 4") {
  for (const int sweeps : {1, 3}) {
    const std::string solver = jakobsen(sweeps, "sqrt-free");
    const Scene s = bare::sheet(9, 9);
    if (!can_run(findings, solver, s)) return;
    const SolverChoice choice = parse_solver(solver);
    findings.equal(
        solver, "divisions in a frame over the number of links", "1",
        static_cast<double>(projections_per_step(*choice.entry->make(s, choice.params))) /
            static_cast<double>(s.links.size()),
        sweeps, 0);
  }
}

TAUT_TRUTH(box_sides, 8, 14, "a box has six sides, not four",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string solver = jakobsen(3, "exact", "contact=discrete");
  int kept_out = 0;
  for (int side = 0; side < 6; ++side) {
    const Vec3 normal = (side % 2 == 0 ? 1 : -1) * Vec3::Unit(side / 2);
    const Scene s = particle_at_box(0.6 * normal, -2 * normal);
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    sim.step(32);
    kept_out += sim.x(0).dot(normal) > 0.5 - 1e-9;
  }
  findings.equal(solver, "sides of a box that keep a particle out", "1", kept_out, 6, 0);
}

TAUT_TRUTH(box_nearest_side, 8, 15,
           "a test of where a particle is finds the nearest side, not the one it came in by",
           "Vasilovici, Cloth Simulation Report, section 4.2.3") {
  const std::string discrete = jakobsen(3, "exact", "contact=discrete"),
                    continuous = jakobsen(3, "exact", "contact=continuous");
  // Falls 0.1 m deep through the top, 0.02 m beside the edge.
  const Scene s = particle_at_box({0.48, 0.55, 0}, {0, -0.15 * 64, 0});
  if (!can_run(findings, discrete, s)) return;
  Simulation wrong(s, discrete), right(s, continuous);
  wrong.step(), right.step();
  findings.equal(discrete, "distance from the side, for it is put out there, not where it came in",
                 "m", 0.5 - wrong.x(0).x(), 0, 1e-9);
  findings.equal(discrete, "its depth below the top", "m", 0.5 - wrong.x(0).y(), 0.1, 1e-6);
  findings.below(continuous, "the same where its way is tested", "m",
                 std::max(0.0, 0.5 - right.x(0).y()), 1e-9);
}

}  // namespace taut
