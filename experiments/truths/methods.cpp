// Section 8, third part: claims of papers about methods for a single step, and about integrators.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/model/text.hpp"
#include "experiments/truths/first_step.hpp"
#include "experiments/truths/quoted.hpp"

namespace taut {

TAUT_TRUTH(xpbd_fixed_point, 8, 26,
           "the sweeps of XPBD come to rest beside implicit Euler's step, not on it",
           "Chen et al., Primal residual reduction with XPBD and hyperelasticity, Computers and "
           "Graphics 2024, abstract") {
  Scene s = elastic(swinging_sheet(12), 1e4);
  const std::string solver = "xpbd:substeps=1,order=mesh,precision=double";
  if (!can_run(findings, solver, s)) return;
  s.start = Simulation(s, "implicit", 32).state();
  const FirstStep step(s);
  const double end = step.distance(solver, 16384);
  findings.holds(solver, "16384 sweeps end more than a micrometre from it", end > 1e-6);
  findings.equal(solver, quoted::kRestOfXpbdSweeps, "1", end / step.distance(solver, 8192), 1,
                 0.02);
  findings.below("implicit", "distance of Newton's method from it", "m",
                 step.distance("implicit", 100), 1e-9);
}

TAUT_TRUTH(primal_residual, 8, 28,
           "links solved all at once rest beside implicit Euler's step, too, from five solutions "
           "on; with the primal residual they go to it",
           "Chen et al., Primal residual reduction with XPBD and hyperelasticity, Computers and "
           "Graphics 2024, abstract") {
  Scene s = elastic(swinging_sheet(32), 1e4);
  const std::string solver = "xpbd:method=global,substeps=1,precision=double";
  if (!can_run(findings, solver, s)) return;
  s.start = Simulation(s, "implicit", 32).state();
  const FirstStep step(s);
  findings.equal(solver, quoted::kRestOfXpbdSolutions, "m", step.farthest(solver, 64), 1.2e-3,
                 0.2e-3);
  findings.equal(solver, "distance after 5 over 64 solutions", "1",
                 step.distance(solver, 5) / step.distance(solver, 64), 1, 0.02);
  findings.below(solver + ",primal=on", quoted::kRestWithPrimalResidual, "m",
                 step.distance(solver + ",primal=on", 64), 1e-8);
}

TAUT_TRUTH(lbfgs_factor, 8, 27,
           "Projective Dynamics is L-BFGS without pairs, and with them it is faster",
           "Liu, Bouaziz, Kavan, Quasi-Newton Methods for Real-Time Simulation, TOG 2017, "
           "abstract") {
  Scene s = elastic(swinging_sheet(12), 1e3);
  if (!can_run(findings, "pd:method=lbfgs", s)) return;
  s.start = Simulation(s, "implicit", 32).state();
  const FirstStep step(s);
  const double plain = step.distance("pd", 10);
  findings.equal("pd:method=lbfgs,history=0", quoted::kLbfgsWithoutPairs, "1",
                 step.distance("pd:method=lbfgs,history=0", 10) / plain, 1, 1e-9);
  findings.below("pd:method=lbfgs", quoted::kLbfgsWithPairs, "1",
                 step.distance("pd:method=lbfgs", 60) / step.distance("pd", 60), 0.5);
}

TAUT_TRUTH(fast_projection, 8, 29, "a sheet whose links are projected all at once hardly stretches",
           "Goldenthal et al., Efficient Simulation of Inextensible Cloth, SIGGRAPH 2007, "
           "abstract") {
  Scene s = swinging_sheet(16);
  std::erase_if(s.links, [](const Link& l) { return l.family != Family::structural; });
  const std::string solver = "xpbd:method=global,substeps=1,iterations=3,precision=double";
  if (!can_run(findings, solver, s)) return;
  Simulation swings(s, solver);
  findings.below(solver, "largest strain along warp and weft in 2 s of swinging", "1",
                 swings.worst(128, [&](int) { return max_strain(s, swings.state()); }), 0.01);
  Scene slack = elastic(hung_sheet(32), 1e4);
  std::erase_if(slack.links, [](const Link& l) { return l.family != Family::structural; });
  slack.damping = 0.5;
  for (std::size_t i = 1; i < slack.start.x.size(); ++i)
    slack.start.x[i].z() += 1e-3 * std::sin(static_cast<double>(i * i));
  slack.start.x[0].x() += 0.15;
  slack.start.x[31].x() -= 0.15;
  findings.holds(solver, "the RMS strain of a slack sheet is above a tenth after 1 s",
                 rms_strain(slack, Simulation(slack, solver, 64).state()) > 0.1);
}

namespace {

/// Number of iterations of the first step until the strain is a ten-thousandth of that without any.
double needed(const Scene& s, const std::string& solver) {
  const auto left = [&](int iterations) {
    const State end =
        Simulation(s, with(solver, "iterations=" + std::to_string(iterations)), 1).state();
    double sum = 0;
    for (const double e : strains(s, end)) sum += e * e;
    return std::sqrt(sum);
  };
  const double enough = 1e-4 * left(0);
  int low = 0, high = 1;
  while (left(high) > enough) high *= 2;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (left(middle) > enough ? low : high) = middle;
  }
  return high;
}

/// A metre of rigid links at 45 degrees, held by its upper end. In the first step it turns there by
/// h^2 g/l, and the pull of all N links acts across this angle: steps with equal h^4 N^3 are alike.
Scene chain_let_go(int links, double dt) {
  Scene s = under_gravity(bare::chain(links, 1, 1.0 / links, Vec3(0, -1, -1).normalized()));
  s.dt = dt;
  return s;
}

}  // namespace

TAUT_TRUTH(solutions_and_sweeps, 8, 30,
           "to a ten-thousandth of the strain a sheet needs as many solutions of all links the "
           "finer it is, and sweeps as the square of its links",
           "Li et al., MGPBD, SIGGRAPH 2025, abstract") {
  const std::string global = "xpbd:method=global,substeps=1,precision=double",
                    sweeps = "xpbd:substeps=1,order=mesh,precision=double";
  std::vector<double> of_global, of_sweeps;
  const std::vector<double> sides{8, 16, 32};
  for (const double side : sides) {
    Scene s = elastic(swinging_sheet(static_cast<int>(side) + 1), 1e6);
    std::erase_if(s.links, [](const Link& l) { return l.family != Family::structural; });
    if (!can_run(findings, global, s)) return;
    s.start = Simulation(s, "implicit:multipliers=keep,iterations=6", 32).state();
    s.stiffness = kRigid;
    of_global.push_back(needed(s, global));
    of_sweeps.push_back(needed(s, sweeps));
  }
  findings.equal(global, "most over fewest solutions, 8, 16 and 32 links a side", "1",
                 std::ranges::max(of_global) / std::ranges::min(of_global), 1, 0.5);
  findings.slope(sweeps, "sweeps over links a side", fit_power_law(sides, of_sweeps), 2, 0.2);
  for (const int links : {16, 32, 64}) {
    const Scene s = chain_let_go(links, std::pow(16.0 / links, 0.75) / 64);
    findings.equal(global, "solutions of a chain of " + std::to_string(links), "1",
                   needed(s, global), 2, 0);
  }
  findings.equal(global, "solutions of a chain of 64 in a step of 1/64 s", "1",
                 needed(chain_let_go(64, 1.0 / 64), global), 7, 0);
}

namespace {

/// A mass on a spring along its axis; a step advances its swing by `angle` [rad].
struct Oscillator {
  Oscillator(double angle, double stiffness = 10) : scene(bare::pair(1.05, 1, 1, 1)), k(stiffness) {
    scene.pins = {0};
    scene.stiffness = {k, k, k};
    scene.dt = angle / std::sqrt(k);
  }
  State after(const std::string& integrator, int steps) const {
    return Simulation(scene, "implicit:integrator=" + integrator, steps).state();
  }
  double stretch(const State& s) const { return (s.x[1] - s.x[0]).norm() - 1; }
  double energy(const State& s) const {
    return s.v[1].squaredNorm() / 2 + k / 2 * stretch(s) * stretch(s);
  }
  Scene scene;
  double k;  ///< N/m
};

}  // namespace

TAUT_TRUTH(integrator_damping, 8, 31,
           "a small swing is damped by w h/2 with implicit Euler, (w h)^3/4 with BDF2 and by "
           "nothing with the midpoint rule",
           "Volino, Magnenat-Thalmann, Implicit Midpoint Integration and Adaptive Damping for "
           "Efficient Cloth Simulation") {
  if (!can_run(findings, "implicit", Oscillator(0.2).scene)) return;
  const auto ratio = [](const std::string& integrator, double angle) {
    const Oscillator swing(angle);
    return std::log(swing.energy(swing.after(integrator, 100)) /
                    swing.energy(swing.after(integrator, 200))) /
           (2 * 100 * angle);
  };
  for (const auto& [angle, of_bdf2] :
       {std::pair(0.1, quoted::kDampingOfBdf2), {0.2, "damping ratio over (w h)^3/4, w h = 0.2"}}) {
    const std::string of = ", w h = " + shortest(angle);
    findings.equal("implicit", "damping ratio over w h/2" + of, "1",
                   ratio("euler", angle) / (angle / 2), 1, 0.03);
    findings.equal("implicit:integrator=bdf2", of_bdf2, "1",
                   ratio("bdf2", angle) / (std::pow(angle, 3) / 4), 1, 0.1);
    findings.below("implicit:integrator=midpoint", "damping ratio" + of, "1",
                   std::abs(ratio("midpoint", angle)), 1e-9);
  }
}

TAUT_TRUTH(integrator_orders, 8, 32,
           "the error of implicit Euler falls as the step, that of BDF2 and the midpoint rule as "
           "its square; the midpoint rule's is the least",
           "Volino, Magnenat-Thalmann, Implicit Midpoint Integration and Adaptive Damping for "
           "Efficient Cloth Simulation, abstract") {
  if (!can_run(findings, "implicit", Oscillator(0.2).scene)) return;
  const auto error = [](const std::string& integrator, int steps) {  // at an angle of 1 rad
    const Oscillator swing(1.0 / steps);
    return std::abs(swing.stretch(swing.after(integrator, steps)) - 0.05 * std::cos(1.0));
  };
  for (const auto& [integrator, order] :
       {std::pair<std::string, double>{"euler", 1}, {"bdf2", 2}, {"midpoint", 2}})
    findings.equal("implicit:integrator=" + integrator, "order of the error, 128 and 256 steps",
                   "1", std::log2(error(integrator, 128) / error(integrator, 256)), order, 0.1);
  findings.below("implicit:integrator=midpoint", quoted::kErrorOfMidpointRule, "1",
                 error("midpoint", 64) / error("euler", 64), 0.1);
}

TAUT_TRUTH(midpoint_stability, 8, 33,
           "a sheet that swings flies apart with the midpoint rule, and keeps its lengths with "
           "implicit Euler and BDF2",
           "Volino, Magnenat-Thalmann, Implicit Midpoint Integration and Adaptive Damping for "
           "Efficient Cloth Simulation, abstract") {
  const Scene s = elastic(swinging_sheet(12), 1e4);
  const std::string midpoint = "implicit:integrator=midpoint";
  if (!can_run(findings, midpoint, s)) return;
  const auto strain = [&](const std::string& solver) {
    return rms_strain(s, Simulation(s, solver, 256).state());
  };
  findings.holds(midpoint, quoted::kMidpointRuleFliesApart, strain(midpoint) > 1);
  for (const char* other : {"implicit", "implicit:integrator=bdf2"})
    findings.below(other, "RMS strain after 4 s", "1", strain(other), 1e-3);
}

}  // namespace taut
