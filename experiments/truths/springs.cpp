// Section 3, springs: the oscillator in discrete time, and where explicit integration blows up;
// section 4: a stiffness in N/m is the spring constant, for coupled links and any time step.
#include <cmath>

#include "core/model/text.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

constexpr double kStiffness = 40, kSpringMass = 0.1, kOmega = 20;  // N/m, kg, rad/s

/// One mass on a spring from a pin, displaced along it by `out` [m].
Scene oscillator(double dt, double out) {
  Scene s = bare::chain(1, 1, kSpringMass);
  s.start.x[1].y() -= out;
  s.dt = dt;
  return s;
}

double displacement(const Simulation& sim) { return -sim.x(1).y() - 1; }

/// Dominant multiplier per step of small displacements; negative if they alternate.
double multiplier(const std::string& solver, double dt) {
  Simulation sim(oscillator(dt, 1e-6), solver, 24);
  const double before = displacement(sim);
  sim.step();
  return displacement(sim) / before;
}

/// Largest displacement of a perturbed flat grid after 600 steps, relative to the initial one.
double growth(const std::string& solver, double dt, const LinkChoice& links) {
  Scene s = bare::sheet(20, 20, links, Lumping::equal, 19, 19, 400);  // 1 kg, 1 m
  for (std::size_t i = 0; i < s.start.x.size(); ++i)
    s.start.x[i] += 1e-9 * Vec3(std::sin(1.0 + 7.0 * static_cast<double>(i)),
                                std::cos(2.0 + 3.0 * static_cast<double>(i)), 0);
  s.dt = dt;
  Simulation sim(s, solver, 600);
  return max_distance(sim.state().x, s.mesh.rest) / 1e-9;
}

constexpr int kLinks = 8;            // from the pinned row to the last
constexpr double kVertexMass = 0.1;  // kg, of every vertex
constexpr double kHeight = 1;        // m

/// Columns of 8 links that hang from their first vertices; links along the rows carry nothing.
Scene hung(int columns) {
  Scene s = under_gravity(bare::sheet(columns, kLinks + 1, {.structural = true}, Lumping::equal,
                                      kHeight, kHeight, kVertexMass * columns * (kLinks + 1)));
  for (int i = 0; i < columns; ++i) s.pins.push_back(i);
  s.damping = 8;
  return s;
}

/// Largest error in the extension of a column's link, relative to the least extension.
double worst_extension(const Scene& s, const State& state, double stiffness) {
  const std::vector<double> extension = strains(s, state);
  double most = 0;
  for (std::size_t l = 0; l < s.links.size(); ++l) {
    const int nu = s.mesh.grid->nu, upper = s.links[l].a / nu, lower = s.links[l].b / nu;
    const double expected = (lower - upper) * (kLinks - upper) * kVertexMass * kG / stiffness;
    most = larger(most, std::abs(extension[l] - expected));
  }
  return most / (kVertexMass * kG / stiffness);
}

}  // namespace

TAUT_TRUTH(hooke_oscillator, 3, 3,
           "Verlet on -kx: sin(W dt/2) = w dt/2, a conserved energy, order 2 in dt",
           "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1") {
  for (const char* integrator : {"verlet", "symplectic-euler"}) {
    const std::string solver = mass_spring(integrator, kStiffness);
    const double dt = 1.0 / 64, x0 = 0.1;
    Scene s = oscillator(dt, x0);
    if (!can_run(findings, solver, s)) continue;
    // Start on the branch x_n = x0 cos(n W dt): v0 = (x_0 - x_-1)/dt.
    const double phase = 2 * std::asin(kOmega * dt / 2);
    s.start.v[1].y() = -(x0 - x0 * std::cos(phase)) / dt;
    Simulation sim(s, solver);
    double worst = 0, least = 1e300, most = 0, before = x0;
    for (int n = 1; n <= 1000; ++n) {
      sim.step();
      const double x = displacement(sim);
      worst = std::max(worst, std::abs(x - x0 * std::cos(n * phase)));
      const double energy = std::pow((x - before) / dt, 2) / 2 + kOmega * kOmega * x * before / 2;
      least = std::min(least, energy);
      most = std::max(most, energy);
      before = x;
    }
    findings.below(solver, "distance from x0 cos(n W dt), sin(W dt/2) = w dt/2, 1000 steps", "m",
                   worst, 1e-11);
    findings.below(solver, "drift of ((x'-x)/dt)^2/2 + w^2 x x'/2 over 1000 steps, relative", "1",
                   (most - least) / most, 1e-11);
    std::vector<double> steps, errors;
    for (int r = 5; r <= 9; ++r) {
      const double h = std::ldexp(1, -r);
      Simulation mass(oscillator(h, x0), solver);
      const auto y = mass.record(100, [&] { return displacement(mass); });
      const double frequency = std::acos(two_term_recurrence(y)[0] / 2) / h;
      steps.push_back(h);
      errors.push_back(std::abs(frequency - kOmega) / kOmega);
    }
    const PowerLaw order =
        fit_power_law({steps.begin() + 1, steps.end()}, {errors.begin() + 1, errors.end()});
    findings.slope(solver, "order in dt of the frequency", order, 2, 0.02);
  }
}

TAUT_TRUTH(spring_step_limit, 3, 4,
           "dt_max = 2/w; with lagged drag (2/w)(sqrt(1 + zeta^2) - zeta); central: 2/w",
           "roots of z^2 - (2 - w^2 dt^2 - gamma dt) z + 1 - gamma dt") {
  // Without drag the limit is where the roots leave the unit circle, at trace = -2.
  const auto undamped = [&](const std::string& solver) {
    const double limit = sign_change(1.9 / kOmega, 2.1 / kOmega, 1e-9, [&](double dt) {
      Simulation sim(oscillator(dt, 1e-6), solver);
      std::vector<double> y{1e-6};
      for (int n = 0; n < 8; ++n) {
        sim.step();
        y.push_back(displacement(sim));
      }
      return two_term_recurrence(y)[0] + 2;
    });
    findings.equal(solver, "largest stable dt w/2", "1", limit * kOmega / 2, 1, 1e-6);
  };
  for (const char* integrator : {"verlet", "symplectic-euler"})
    if (const std::string solver = mass_spring(integrator, kStiffness);
        can_run(findings, solver, oscillator(1.0 / 64, 0)))
      undamped(solver);
  // With drag one root reaches -1 alone.
  const double zeta = 0.5, drag = 2 * zeta * kOmega * kSpringMass;
  const double shrunk = std::sqrt(1 + zeta * zeta) - zeta;
  const auto damped = [&](const std::string& solver, double expected) {
    if (!can_run(findings, solver, oscillator(1.0 / 64, 0))) return;
    const double limit = sign_change(0.9 * expected * 2 / kOmega, 1.1 * expected * 2 / kOmega,
                                     1e-10, [&](double dt) { return multiplier(solver, dt) + 1; });
    findings.equal(solver, "largest stable dt w/2 with damping ratio 0.5", "1", limit * kOmega / 2,
                   expected, 1e-6);
  };
  damped(mass_spring("symplectic-euler", kStiffness, drag), shrunk);
  damped(mass_spring("verlet", kStiffness, drag), shrunk);
  damped(with(mass_spring("verlet", kStiffness, drag), "drag-at=central"), 1);
  // Explicit Euler grows by sqrt(1 + w^2 dt^2) at every dt.
  const std::string euler = mass_spring("explicit-euler", kStiffness);
  if (!can_run(findings, euler, oscillator(1.0 / 64, 0))) return;
  const double dt = 1.0 / 1024;
  Simulation sim(oscillator(dt, 1e-6), euler);
  const auto y = sim.record(200, [&] { return displacement(sim); });
  findings.equal(euler, "growth per step at w dt = 0.02: never stable", "1",
                 std::sqrt(-two_term_recurrence(y)[1]), std::sqrt(1 + std::pow(kOmega * dt, 2)),
                 1e-9);
}

TAUT_TRUTH(spring_grid_limit, 3, 5,
           "a 20x20 grid of springs is stable below 1.003, 0.710, 0.633 sqrt(m/k)",
           "largest eigenvalue of the flat grid, edges free") {
  struct Case {
    LinkChoice links;
    const char* name;
    double eigenvalue;
  };
  const std::string solver = mass_spring("verlet", 1);
  for (const Case& c : {Case{{}, "structural", 3.975}, Case{{.shear = true}, "+ shear", 7.927},
                        Case{{.shear = true, .bend = true}, "+ bend", 9.987}}) {
    const double value = reference::spring_grid_eigenvalue(20, c.links.shear, c.links.bend);
    const std::string name = c.name;
    findings.equal("closed form", "largest eigenvalue times m/k, 20x20 " + name, "1", value,
                   c.eigenvalue, 5e-4);
    if (!can_run(findings, solver, bare::sheet(2, 2))) continue;
    const double limit = 2 / std::sqrt(value);
    const double below = growth(solver, 0.998 * limit, c.links),
                 above = growth(solver, 1.002 * limit, c.links);
    findings.holds(solver, "stays bounded at 0.998 of dt_max, " + name, below < 100);
    findings.holds(solver, "blows up at 1.002 of dt_max, " + name, !(above < 1e4));
  }
}

TAUT_TRUTH(stiffness, 4, 14,
           "K [N/m] is K in coupled links too, at any time step: chains and sheets of 8 "
           "links at 500, 5000, 50000",
           "statics") {
  for (const double k : {500.0, 5000.0, 50000.0}) {
    for (const std::string solver :
         {"mass-spring:substeps=64,precision=double", "mass-spring:substeps=100,precision=double",
          "xpbd:order=mesh,iterations=1000,substeps=1,precision=double",
          "xpbd:order=mesh,iterations=100,substeps=16,precision=double",
          "bullet-deformable:substeps=1,precision=double",
          "bullet-deformable:substeps=16,precision=double", "implicit", "implicit:substeps=16",
          "pd:iterations=20", "admm:iterations=100", "vbd:iterations=200"})
      for (const int columns : {1, 3}) {
        Scene s = hung(columns);
        s.stiffness = {k, k, k};
        if (!can_run(findings, solver, s)) continue;
        Simulation sim(s, solver);
        settle(sim, 1e-10, 16, 20 * 64);
        findings.below(solver,
                       "distance of an extension from (N-j+1) m g/K, in m g/K, columns: " +
                           std::to_string(columns) + ", K " + shortest(k) + " N/m",
                       "1", worst_extension(s, sim.state(), k), 1e-8);
      }
  }
  for (const char* solver : {"jakobsen", "bullet", "avbd"})
    if (findings.wants(solver)) findings.not_applicable(solver, "its links are rigid");
}

}  // namespace taut
