// Section 3: released pins fall freely from the state that they had.
#include <numeric>

#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

constexpr int kHeld = 16, kFree = 48;  // steps

/// Displacement in n steps of Verlet, symplectic Euler or implicit Euler from the velocity v.
Vec3 fallen(const Scene& s, const Vec3& v, int n) {
  return n * s.dt * v + n * (n + 1) / 2.0 * s.dt * s.dt * s.gravity;
}

/// A setting of each solver with a single substep, in double.
std::vector<std::string> steppers() {
  return {jakobsen(4),
          bullet(4),
          xpbd(1),
          mass_spring("verlet", 2),
          mass_spring("symplectic-euler", 2),
          "implicit:substeps=1",
          "pd:substeps=1,precision=double",
          "admm:substeps=1,precision=double",
          "vbd:substeps=1,precision=double",
          "avbd:substeps=1,precision=double",
          "bullet-deformable:substeps=1"};
}

/// Whether a step of the solver leaves the centre of mass alone. Vertex descent and a step of
/// conjugate gradients end before forces inside the cloth have cancelled, which pulls the centre
/// along.
bool balances(const std::string& solver) {
  const std::string name = solver_name(solver);
  return name != "vbd" && name != "avbd" && name != "bullet-deformable";
}

Vec3 mean(const Scene& s, const std::vector<Vec3>& of) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < of.size(); ++i) sum += s.mesh.mass[i] * of[i];
  return sum / std::accumulate(s.mesh.mass.begin(), s.mesh.mass.end(), 0.0);
}

}  // namespace

TAUT_TRUTH(let_go, 3, 11, "a moved pin that lets go: x_n = x + n h v + n (n + 1)/2 g h^2",
           "sum of the Verlet recurrence from the state at the release") {
  Scene s = under_gravity(bare::scene({Vec3::Zero(), Vec3(1, 0, 0)}, {0.3, 2.0}, {}, {0, 1}));
  Motion motion;
  motion.velocity = Vec3(3, 4, -1);
  s.pin_motions = {{{0, 1}, motion}};
  s.start.v = {motion.velocity, motion.velocity};
  s.steps = kHeld + kFree;
  s.releases = {{kHeld, {0, 1}}};
  for (const std::string& solver : steppers()) {
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, kHeld);
    const Vec3 x = sim.x(0);
    findings.below(solver, "distance of the pin from its motion at the release", "m",
                   (x - kHeld * s.dt * motion.velocity).norm(), 1e-12);
    const double worst = sim.worst(
        kFree, [&](int n) { return (sim.x(0) - x - fallen(s, motion.velocity, n)).norm(); });
    findings.below(solver, "distance from the parabola over 0.75 s", "m", worst, 1e-11);
  }
}

TAUT_TRUTH(let_go_cloth, 3, 12,
           "a cloth that lets go: its centre of mass falls by n h v + n (n + 1)/2 g h^2",
           "forces between vertices cancel") {
  Scene s = under_gravity(bare::sheet(7, 7, {.structural = true, .shear = true}));
  s.pins = {0, 6};
  s.steps = kHeld + kFree;
  s.releases = {{kHeld, {0, 6}}};
  for (const std::string& solver : steppers()) {
    if (!balances(solver) || !can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, kHeld);
    const Vec3 x = mean(s, sim.state().x), v = mean(s, sim.state().v);
    const double worst = sim.worst(
        kFree, [&](int n) { return (mean(s, sim.state().x) - x - fallen(s, v, n)).norm(); });
    findings.below(solver, "distance of the centre of mass from the parabola over 0.75 s", "m",
                   worst, 1e-9);
  }
}

}  // namespace taut
