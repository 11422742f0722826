// Section 8: numbers that papers print, and how closely the same set-up reproduces them here.
#include <cmath>

#include "core/reference/fit.hpp"
#include "core/reference/textbook.hpp"
#include "experiments/truths/quoted.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Largest stretch [m] over 30 s of a chain of 20 free particles, 1 cm apart and released
/// unstrained, whose last one is 1e5 times as heavy as the others.
double peak_stretch(const Scene& s, const std::string& solver) {
  Simulation sim(s, solver);
  const int n = static_cast<int>(s.links.size());
  return sim.worst(s.steps, [&](int) { return -sim.x(n).y() - n * 0.01; });
}

}  // namespace

TAUT_TRUTH(small_steps, 8, 1,
           "mass ratio 1:1e5: 100 iterations stretch a chain 100.7 times (322.1 m over 3.2 m) what "
           "100 substeps do; reproduced here: 99.6",
           "Macklin et al., Small Steps in Physics Simulation, SCA 2019, section 6.1") {
  Scene s = under_gravity(bare::chain(20, 0.2, 1));
  s.mesh.mass.back() = 1e5;
  s.dt = 1.0 / 64;
  s.steps = 64 * 30;
  // The paper prints 322.1 m and 3.2 m, hence a ratio of 99.1 to 102.3 by the rounding of its
  // digits, and no frame time: 1/64 s here.
  constexpr double kPrinted = 322.1 / 3.2, kDigits = 322.15 / 3.15 - kPrinted;
  constexpr double kHere = 99.6;  // what Jakobsen's exact projection and XPBD both give here
  const auto ratio = [&](const std::string& iterations, const std::string& substeps) {
    if (!can_run(findings, iterations, s) || !can_run(findings, substeps, s)) return;
    const double measured = peak_stretch(s, iterations) / peak_stretch(s, substeps);
    findings.equal(substeps, "stretch of 100 iterations over that of 100 substeps, as printed", "1",
                   measured, kPrinted, kDigits);
    findings.equal(substeps, "the same, as reproduced here", "1", measured, kHere, 0.15);
  };
  ratio(jakobsen(100), jakobsen(1, "exact", "substeps=100"));
  ratio("xpbd:order=mesh,iterations=100,substeps=1,precision=double", xpbd(100));
  const std::string theirs = bullet(100);
  if (can_run(findings, theirs, s)) {
    const double measured =
        peak_stretch(s, theirs) / peak_stretch(s, with(bullet(1), "substeps=100"));
    findings.deviates(theirs, "stretch of 100 iterations over that of 100 substeps", "1", measured,
                      kHere,
                      peak_stretch(s, jakobsen(100, "sqrt-free")) /
                          peak_stretch(s, jakobsen(1, "sqrt-free", "substeps=100")),
                      0.5, "the square-root-free form at stretches of thousands of per cent");
  }
}

TAUT_TRUTH(xpbd_spring, 8, 2, "a compliant spring moves the same for any number of iterations",
           "Macklin, Mueller, Chentanez, XPBD, MIG 2016, figure 2") {
  // alpha = 0.001 m/N, 1 kg, released at x0 = 1.5 from a rest length of 1 (figure 2 of the paper).
  const double alpha = 0.001, dt = 1.0 / 64, w2 = 1 / alpha;
  for (const int k : {1, 5, 50}) {
    const std::string solver =
        "xpbd:iterations=" + std::to_string(k) + ",substeps=1,structural=0.001,precision=double";
    Scene s = bare::chain(1, 1, 1);
    s.start.x[1].y() = -1.5;
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver);
    std::vector<double> y{0.5};
    for (int n = 0; n < 12; ++n) {
      sim.step();
      y.push_back(-sim.x(1).y() - 1);
    }
    const auto [p, q] = two_term_recurrence(y);
    findings.equal(solver, "implicit Euler whatever the sweeps: 2/(1 + w^2 dt^2)", "1", p,
                   2 / (1 + w2 * dt * dt), 1e-10);
    findings.equal(solver, "and -1/(1 + w^2 dt^2)", "1", q, -1 / (1 + w2 * dt * dt), 1e-10);
  }
}

TAUT_TRUTH(xpbd_chain_force, 8, 3,
           "constraint forces of a hanging chain come out of the multipliers",
           "Macklin, Mueller, Chentanez, XPBD, MIG 2016, figure 3") {
  findings.not_applicable(
      "xpbd",
      "force error of 6 / 2 / 0.5 % at 50 / 100 / 1000 iterations (figure 3a): the "
      "chain's link length, start and time of comparison are not in the paper");
  // This can be checked: at rest the corrections carry the exact weight, for any number of sweeps.
  for (const int k : {1, 50}) {
    const std::string solver =
        "xpbd:order=mesh,iterations=" + std::to_string(k) + ",substeps=1,precision=double";
    Scene s = under_gravity(bare::chain(20, 20, 1));
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, 12000 / k);
    Textbook<double> textbook(s, k);
    textbook.load(sim.state());
    textbook.step();
    findings.equal(solver, quoted::kForceOfTopLink, "1",
                   textbook.lambda()[0] / s.dt / s.dt / (20 * kG), 1, 1e-6);
  }
}

TAUT_TRUTH(tetrahedron, 8, 4, "three to four passes are enough for a tetrahedron",
           "Jakobsen 2001, section 5") {
  // "3 or 4 iterations should be enough": six links, with a vertex pushed out by a fifth. The paper
  // gives no number; here a tenth of the strain is enough.
  const std::vector<Vec3> x{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Link> links;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) links.push_back({i, j, std::sqrt(8.0)});
  Scene s = bare::scene(x, std::vector<double>(4, 1.0), links);
  s.start.x[0] *= 1.2;
  const double start = max_strain(s, s.start);
  for (const auto& [few, four] :
       {std::pair(jakobsen(1, "sqrt-free"), jakobsen(4, "sqrt-free")),
        std::pair(jakobsen(1), jakobsen(4)), std::pair(bullet(1), bullet(4))}) {
    if (!can_run(findings, few, s)) continue;
    Simulation sim(s, four);
    sim.step();
    findings.below(four, "share of the strain that four passes leave", "1",
                   max_strain(s, sim.state()) / start, 0.1);
  }
}

TAUT_TRUTH(three_sweeps, 8, 5, "three sweeps suffice for a good result",
           "Vasilovici, Cloth Simulation Report, section 4.1") {
  // "3 iterations suffice": to what accuracy, on the sheet that Vasilovici shows.
  for (const std::string& solver : {jakobsen(3, "sqrt-free"), bullet(3)}) {
    Scene s = under_gravity(bare::sheet(16, 16, {.shear = true}));
    s.pins = {0, 15};
    s.damping = 1;
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, 640);
    const double rms = rms_strain(s, sim.state());
    findings.deviates(solver, "RMS strain of a 16x16 sheet on two corners, 1/64 s", "1", rms, 0,
                      0.06, 0.03,
                      "three sweeps suffice to look right, not to hold lengths; 6 % is what they "
                      "leave here");
  }
}

}  // namespace taut
