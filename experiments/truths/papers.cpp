// Section 8, second part: claims of papers about the solvers of this tree.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/model/text.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/first_step.hpp"
#include "experiments/truths/quoted.hpp"

namespace taut {

namespace {

/// Section 6.1 of Small Steps: 20 particles of 1 kg including the fixed one, g = 10 m/s^2. The
/// paper prints no frame time: 0.03 s reproduces both of its numbers to their last digits.
Scene small_steps_chain(double last_mass) {
  Scene s = bare::chain(19, 19, 1);
  s.gravity = {0, -10, 0};
  s.mesh.mass.back() = last_mass;
  s.dt = 0.03;
  s.steps = 1000;
  return s;
}

/// Root of the sum of squares of |x_b - x_a| - r [m].
double constraint_error(const Scene& s, const State& state) {
  double sum = 0;
  for (const double e : strains(s, state)) sum += e * e;
  return std::sqrt(sum);
}

/// Kinetic and potential energy [J].
double energy(const Scene& s, const State& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i)
    sum += s.mesh.mass[i] * (kG * state.x[i].y() + state.v[i].squaredNorm() / 2);
  return sum;
}

}  // namespace

TAUT_TRUTH(small_steps_metres, 8, 17,
           "mass ratio 1:1e5, 30 ms a frame: the chain stretches by 322.1 m with 100 iterations "
           "and by 3.2 m with 100 substeps",
           "Macklin et al., Small Steps in Physics Simulation, SCA 2019, section 6.1") {
  const Scene s = small_steps_chain(1e5);
  for (const auto& [solver, printed] :
       {std::pair(std::string("xpbd:order=mesh,iterations=100,substeps=1,precision=double"), 322.1),
        {xpbd(100), 3.2},
        {jakobsen(100), 322.1},
        {jakobsen(1, "exact", "substeps=100"), 3.2}}) {
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver);
    findings.equal(solver, "largest stretch in 1000 frames", "m",
                   sim.worst(s.steps, [&](int) { return -sim.x(19).y() - 19; }), printed, 0.05);
  }
}

TAUT_TRUTH(small_steps_residual, 8, 18,
           "k iterations leave 18.6, 41.6, 69.1 and 92.6 times the constraint error of k substeps, "
           "k = 20, 50, 100, 200",
           "Macklin et al., Small Steps in Physics Simulation, SCA 2019, figure 4") {
  const Scene s = small_steps_chain(1);
  for (const auto& [k, ratio] : std::map<int, double>{{200, 92.64}, {20, 18.60}, {50, 41.63}}) {
    const std::string iterations =
        "xpbd:order=mesh,iterations=" + std::to_string(k) + ",substeps=1,precision=double";
    if (!can_run(findings, iterations, s)) continue;
    findings.equal(xpbd(k),
                   "error of " + std::to_string(k) +
                       " iterations over that of as many substeps "
                       "after 1000 frames",
                   "1",
                   constraint_error(s, Simulation(s, iterations, s.steps).state()) /
                       constraint_error(s, Simulation(s, xpbd(k), s.steps).state()),
                   ratio, 0.01 * ratio);
  }
}

TAUT_TRUTH(xpbd_residual, 8, 19,
           "the logarithm of XPBD's residual falls linearly with the iterations, from 200 on",
           "Macklin, Mueller, Chentanez, XPBD, MIG 2016, figure 3b") {
  const Scene s = elastic(small_steps_chain(1), 1e8);
  const std::string solver = "xpbd:order=mesh,substeps=1,precision=double";
  if (!can_run(findings, solver, s)) return;
  const FirstStep step(s);
  const auto fall = [&](int from, int to) {
    return std::log(step.residual(solver, from) / step.residual(solver, to)) / (to - from);
  };
  findings.equal(solver, "fall of the log of the residual, 500 to 800 over 200 to 500 iterations",
                 "1", fall(500, 800) / fall(200, 500), 1, 0.01);
  findings.equal(solver, "the same of 10 to 20 over 200 to 500", "1", fall(10, 20) / fall(200, 500),
                 7.3, 0.2);
}

TAUT_TRUTH(vbd_bounded, 8, 20,
           "one iteration of one substep stays bounded at any stiffness, and may gain energy",
           "Chen, Liu, Yang, Yuksel, Vertex Block Descent, SIGGRAPH 2024, figure 16") {
  for (const double k : {1e4, 1e6, 1e8}) {
    const Scene s = elastic(swinging_sheet(16), k);
    const std::string solver = "vbd:iterations=1,substeps=1,order=coloured";
    if (!can_run(findings, solver, s)) return;
    // Far from convergence, the result depends on last digits: so eight runs have masses that
    // differ in the tenth digit. At 1e8 N/m about one start in twenty throws a vertex up to 30 m
    // away, however the vertex' system is solved. There the median is bounded; below, all are.
    double gained = 0;
    std::vector<double> farthest;
    for (int start = 0; start < 8; ++start) {
      Scene other = s;
      for (double& m : other.mesh.mass) m *= 1 + 1e-10 * start;
      Simulation sim(other, solver);
      farthest.push_back(sim.worst(64 * 20, [&](int) {
        gained = std::max(gained, energy(s, sim.state()) - energy(s, s.start));
        double far = 0;
        for (const Vec3& x : sim.state().x) far = std::max(far, x.norm());
        return far;
      }));
    }
    const std::string at = ", K " + shortest(k) + " N/m";
    std::ranges::sort(farthest);
    const bool all = k < 1e8;
    findings.below(solver,
                   "farthest vertex from the pins' middle in 20 s, side 1 m" +
                       std::string(all ? "" : ", median of eight starts") + at,
                   "m", all ? farthest.back() : farthest[farthest.size() / 2], 2.5);
    if (k > 1e5)
      findings.holds(solver, "gains more than 5 % of m g L" + at, gained > 0.05 * 0.2 * kG);
  }
}

TAUT_TRUTH(vbd_mass_ratio, 8, 21,
           "a strand with 1:1000 in mass keeps its length where XPBD with as many iterations "
           "stretches by its own length",
           "Chen, Liu, Yang, Yuksel, Vertex Block Descent, SIGGRAPH 2024, figure 21") {
  Scene s = under_gravity(bare::chain(20, 1, 0.01, Vec3::UnitX()));
  s.mesh.mass.back() = 10;
  s.dt = 1.0 / 60;
  s = elastic(s, 1e8);
  const auto most = [&](const std::string& solver) {
    Simulation sim(s, solver);
    return sim.worst(600, [&](int) { return max_strain(s, sim.state()); });
  };
  const std::string vbd = "vbd:iterations=100,substeps=1,order=mesh",
                    theirs = "xpbd:iterations=100,substeps=1,order=mesh,precision=double";
  if (!can_run(findings, vbd, s) || !can_run(findings, theirs, s)) return;
  findings.below(vbd, "largest strain in 10 s", "1", most(vbd), 0.02);
  findings.holds(theirs, "largest strain in 10 s above 1", most(theirs) > 1);
  const auto fall = [&](const std::string& solver) { return Simulation(s, solver, 30).x(20).y(); };
  findings.equal(vbd, "fall of the heavy end in 0.5 s over that of the exact step", "1",
                 fall(vbd) / fall("implicit"), 1, 0.02);
}

TAUT_TRUTH(vbd_stiffness_ratio, 8, 22,
           "links of 1:10 000 in stiffness by turns: 100 iterations leave the whole error",
           "Chen, Liu, Yang, Yuksel, Vertex Block Descent, SIGGRAPH 2024, figure 24") {
  const std::string solver = "vbd:substeps=1,order=mesh";
  struct Left {
    const char* quantity;
    double ratio, share;
  };
  for (const auto& [quantity, ratio, left] :
       {Left{"share of the first step's error left by 100 iterations, 1:1", 1, 0.002},
        Left{quoted::kErrorLeftByVbd, 1e4, 0.994}}) {
    Scene s = under_gravity(bare::chain(20, 1, 0.01));
    for (std::size_t j = 0; j < s.links.size(); j += 2) s.links[j].family = Family::bend;
    s.stiffness = {1e3 * ratio, 1e3 * ratio, 1e3};
    if (!can_run(findings, solver, s)) return;
    const FirstStep step(s);
    findings.equal(solver, quantity, "1", step.distance(solver, 100) / step.way(), left, 0.002);
  }
}

TAUT_TRUTH(avbd_defaults, 8, 23,
           "alpha 0.95, beta 10 and gamma 0.99 keep sheets within 3 % of their lengths",
           "Giles, Diaz, Yuksel, Augmented Vertex Block Descent, SIGGRAPH 2025") {
  const std::string solver = "avbd:iterations=15,alpha=0.95,beta=10,gamma=0.99";
  for (const auto& [name, s] :
       {std::pair("hung by two corners", hung_sheet(16)), {"swinging", swinging_sheet(16)}})
    if (can_run(findings, solver, s))
      findings.below(solver, std::string("RMS strain of a 16 x 16 sheet after 5 s, ") + name, "1",
                     rms_strain(s, Simulation(s, solver, 320).state()), 0.03);
}

TAUT_TRUTH(liu_newton, 8, 24, "Projective Dynamics converges to Newton's step",
           "Liu et al., Fast Simulation of Mass-Spring Systems, 2013, abstract") {
  Scene s = elastic(hung_sheet(12), 1e4);
  if (!can_run(findings, "pd", s)) return;
  s.start = Simulation(s, "implicit", 16).state();
  findings.below("pd", "distance from it after 1000 iterations", "m",
                 FirstStep(s).distance("pd", 1000), 1e-9);
}

TAUT_TRUTH(wang_chebyshev, 8, 25,
           "Chebyshev's semi-iteration saves more, the slower the plain iteration is: 3 times on a "
           "hung sheet, 10 times and more on one that swings",
           "Wang, A Chebyshev Semi-Iterative Approach, SIGGRAPH Asia 2015, abstract") {
  Scene hung = elastic(hung_sheet(16), 1e4);
  if (!can_run(findings, "pd", hung)) return;
  hung.start = Simulation(hung, "implicit", 16).state();
  const auto saved = [&](const Scene& s, const char* rho, double share, int most) {
    const FirstStep step(s);
    const auto needed = [&](const std::string& solver) {  // to this share of the first distance
      int low = 0, high = most;
      while (high - low > 1) {
        const int middle = (low + high) / 2;
        (step.distance(solver, middle) > share * step.way() ? low : high) = middle;
      }
      return high;
    };
    return 1.0 * needed("pd") / needed(std::string("pd:chebyshev=") + rho);
  };
  findings.equal("pd", "hung: iterations to 1e-6 of the step over those with rho 0.9", "1",
                 saved(hung, "0.9", 1e-6, 300), 3, 0.5);
  findings.equal("pd", quoted::kIterationsSavedSwinging, "1",
                 saved(elastic(swinging_sheet(12), 1e4), "0.9999", 0.03, 20000), 13, 2);
}

}  // namespace taut
