// Section 3, particles without springs: falling, damping, wind on a face, the tilted strip.
#include <cmath>
#include <numbers>

#include "core/reference/closed_forms.hpp"
#include "experiments/truths/quoted.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

const Vec3 kGravity(0, -kG, 0);
const Vec3 kThrow(3, 4, -1);  // m/s

/// Two free particles far apart, thrown with the same velocity.
Scene thrown() {
  Scene s = bare::scene({Vec3::Zero(), Vec3(1, 0, 0)}, {0.3, 2.0}, {});
  s.gravity = kGravity;
  s.start.v = {kThrow, kThrow};
  return s;
}

/// Settings that step like Verlet.
std::vector<std::string> verlet_like() {
  return {jakobsen(1), bullet(1), xpbd(1), mass_spring("verlet", 1),
          mass_spring("symplectic-euler", 1)};
}

/// One horizontal face of equal masses in wind of strength c, and nothing else.
Scene face(double strength, Wind::Law law) {
  Scene s = bare::scene({Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, -0.5)}, {0.1, 0.1, 0.1}, {});
  s.mesh.triangles = {{0, 1, 2}};
  s.gravity = kGravity;
  s.wind = Wind{Vec3::Zero(), strength, law};
  return s;
}

constexpr double kArea = 0.25, kMass = 0.3;

/// A strip hung by its top edge. Each quad is covered twice, once per diagonal, at half the
/// strength: only this triangulation loads the vertices of a row equally.
Scene strip(double wind_speed, double strength, double area_density) {
  const int rows = 9;
  const double width = 0.125, height = 1;
  Scene s = bare::sheet(2, rows, {.shear = true}, Lumping::area, width, height,
                        area_density * width * height);
  s.mesh.triangles.clear();
  for (int j = 0; j + 1 < rows; ++j) {
    const int a = 2 * j, b = a + 1, c = a + 2, d = a + 3;
    for (const Triangle& t :
         {Triangle{a, c, d}, Triangle{a, d, b}, Triangle{a, c, b}, Triangle{b, c, d}})
      s.mesh.triangles.push_back(t);
  }
  s.pins = {0, 1};
  s.gravity = kGravity;
  s.wind = Wind{Vec3(0, 0, wind_speed), strength / 2, Wind::Law::relative};
  s.damping = 4;
  return s;
}

}  // namespace

TAUT_TRUTH(free_fall, 3, 1, "x_n = x0 + v0 t + g t^2/2 + g t dt/2; explicit Euler has -g t dt/2",
           "sum of the Verlet recurrence") {
  const auto check = [&](const std::string& solver, const char* quantity, double offset,
                         const Vec3& correction) {
    Scene s = thrown();
    for (Vec3& v : s.start.v) v += correction;
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double worst = sim.worst(64, [&](int n) {
      const double t = n * s.dt;
      return (sim.x(0) - (kThrow * t + kGravity * (t * t / 2 + offset * t * s.dt / 2))).norm();
    });
    findings.below(solver, quantity, "m", worst, 1e-12);
  };
  for (const std::string& solver : verlet_like()) {
    check(solver, "distance from v0 t + g t^2/2 + g t dt/2 over 1 s", 1, Vec3::Zero());
    check(solver, "distance from the exact parabola, start x_-1 = x0 - v0 dt + g dt^2/2", 0,
          -kGravity / 128);
  }
  check(mass_spring("explicit-euler", 1), "distance from v0 t + g t^2/2 - g t dt/2 over 1 s", -1,
        Vec3::Zero());
  const std::string in_float = "jakobsen:substeps=1,order=mesh,precision=float";
  Scene s = thrown();
  if (!can_run(findings, in_float, s)) return;
  Simulation sim(s, in_float, 64);
  findings.below(in_float, "distance from v0 t + g t^2/2 + g t dt/2 at 1 s", "m",
                 (sim.x(0) - (kThrow + kGravity * (0.5 + 1.0 / 128))).norm(), 1e-4);
}

TAUT_TRUTH(damping_factor, 3, 2,
           "x_n = x0 + u0 q(1-q^n)/(1-q) + a/(1-q) [n - q(1-q^n)/(1-q)], q = exp(-damping dt)",
           "sum of x* = x + q (x - x') + a dt^2") {
  for (const std::string& solver : verlet_like()) {
    Scene s = thrown();
    s.damping = 3;
    if (!can_run(findings, solver, s)) continue;
    const double q = std::exp(-s.damping * s.dt);
    Simulation sim(s, solver);
    const Vec3 a = kGravity * s.dt * s.dt;
    const double worst = sim.worst(64, [&](int n) {
      const double decay = q * (1 - std::pow(q, n)) / (1 - q);
      return (sim.x(0) - (kThrow * s.dt * decay + a / (1 - q) * (n - decay))).norm();
    });
    const bool is_bullet = solver_name(solver) == "bullet";
    findings.below(solver, "distance from the closed form of x + q (x - x') + g dt^2 over 1 s", "m",
                   worst, is_bullet ? 1e-9 : 1e-12);
    sim.step(64 * 14);
    findings.equal(solver, "terminal speed g dt/(1 - q)", "m/s", -sim.v(0).y(), kG * s.dt / (1 - q),
                   1e-9);
  }
}

TAUT_TRUTH(wind_face, 3, 6, "v_n = (m g/cA)(1 - (1 - cA dt/m)^n); stable iff cA dt/m < 2",
           "Vasilovici, Cloth Simulation Report, section 3, with d the wind relative to the face") {
  for (const std::string& solver : verlet_like()) {
    const double c = 8;
    const Scene s = face(c, Wind::Law::relative);
    if (!can_run(findings, solver, s)) continue;
    const double rate = c * kArea * s.dt / kMass, terminal = kMass * kG / (c * kArea);
    Simulation sim(s, solver);
    const double worst = sim.worst(64, [&](int n) {
      const Vec3 expected(0, -terminal * (1 - std::pow(1 - rate, n)), 0);
      return std::max({(sim.v(0) - expected).norm(), (sim.v(1) - expected).norm(),
                       (sim.v(2) - expected).norm()});
    });
    findings.below(solver, "distance from (m g/cA)(1 - (1 - cA dt/m)^n)", "m/s", worst, 1e-11);
    sim.step(1000);
    findings.equal(solver, "terminal speed m g/(cA)", "m/s", -sim.v(0).y(), terminal, 1e-11);

    // Stable while cA dt/m < 2: the factor 1 - rate per step is measured on both sides of this
    // limit.
    double factors[2];
    for (const bool above : {false, true}) {
      Scene edge = face((above ? 2.001 : 1.999) * kMass / (kArea * s.dt), Wind::Law::relative);
      edge.gravity.setZero();
      edge.start.v.assign(3, Vec3(0, -1, 0));
      Simulation fast(edge, solver, 101);
      const double first = fast.v(0).y();
      fast.step();
      factors[above] = std::abs(fast.v(0).y() / first);
    }
    findings.equal(solver, "growth per step at cA dt/m = 1.999", "1", factors[0], 0.999, 1e-9);
    findings.equal(solver, "growth per step at cA dt/m = 2.001", "1", factors[1], 1.001, 1e-9);
  }
}

TAUT_TRUTH(wind_literal, 3, 7, "with d the wind itself, as printed, a face accelerates without end",
           "Vasilovici, Cloth Simulation Report, section 3, read literally") {
  for (const std::string& solver : verlet_like()) {
    Scene s = face(0.4, Wind::Law::literal);
    s.wind->velocity = Vec3(0, 2, 1);
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, 640);
    // c (n . d) n A/m upwards, whatever the speed
    const double a = 0.4 * 2 * kArea / kMass - kG;
    findings.equal(solver, "speed after 10 s: no terminal speed", "m/s", sim.v(0).y(), 10 * a,
                   1e-9);
  }
}

TAUT_TRUTH(wind_tilt, 3, 8,
           "a strip hung by its top edge in steady wind is a plane: tan(tilt) = wind/weight",
           "balance of moments of every row, masses lumped by area") {
  const double speed = 4, c = 0.25, density = 0.1;  // c U = 1 N/m^2 against 0.981 N/m^2
  const double expected = std::atan(c * speed / (density * kG)) * 180 / std::numbers::pi;
  findings.equal("closed form", "tilt where the wind weighs 1/0.981 of the cloth", "deg", expected,
                 45.5495, 5e-5);
  const auto check = [&](const std::string& solver) {
    const Scene s = strip(speed, c, density);
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    if (!settle(sim, 1e-9, 64, 64 * 100)) {
      findings.equal(solver, "comes to rest", "1", 0, 1, 0);
      return;
    }
    double flattest = 1e300, steepest = 0;
    for (int j = 1; j < 9; ++j)
      for (int i = 0; i < 2; ++i) {
        const Vec3 d = sim.x(2 * j + i) - sim.x(i);
        const double tilt = std::atan2(d.z(), -d.y()) * 180 / std::numbers::pi;
        flattest = std::min(flattest, tilt);
        steepest = std::max(steepest, tilt);
      }
    // Stretched faces catch more wind: strain e adds e cos(tilt) sin(tilt) rad.
    const double slack = 1e-6 + max_strain(s, sim.state()) * 90 / std::numbers::pi;
    findings.equal(solver, "smallest tilt of a row", "deg", flattest, expected, slack);
    findings.equal(solver, "largest tilt of a row", "deg", steepest, expected, slack);
  };
  check(jakobsen(400));
  check(jakobsen(400, "sqrt-free"));
  check(bullet(400));
  check(xpbd(64));
}

/// In float, x + (x - x') is a whole number of units in the last place of x, so every step adds
/// gravity's g dt^2 rounded to such units. This is not noise but a different gravity in each
/// binade.
TAUT_TRUTH(float_gravity, 3, 9,
           "in float a step adds g dt^2 rounded to units in the last place of the coordinates",
           "x - x' is exact (Sterbenz 1974), so only the sum is rounded") {
  const std::string solver = "jakobsen:substeps=1,order=mesh,precision=float";
  Scene s = bare::scene({Vec3(0, -4.5, 0), Vec3(1, -4.5, 0)}, {1, 1}, {});
  s.gravity = kGravity;
  s.dt = 1.0 / 1024;
  if (!can_run(findings, solver, s)) return;
  const int n = 800;
  Simulation sim(s, solver, n);
  const double unit = 0x1p-21;  // of coordinates from 4 m to 8 m
  const double step = kG * s.dt * s.dt, fallen = n * (n + 1) / 2.0;
  findings.deviates(solver, "way fallen in 800 steps of 1/1024 s from 4.5 m off the origin", "m",
                    -4.5 - sim.x(0).y(), fallen * step, fallen * std::round(step / unit) * unit,
                    1e-12, "g dt^2 = 19.6 units in the last place of the coordinates counts as 20");

  // The largest share that is not refused is an eighth: half a unit of four.
  Scene sheet = bare::sheet(3, 3, {.shear = true}, Lumping::area, 0.25, 0.25, 0.1);
  for (Vec3& x : sheet.mesh.rest) x.y() += 0.6;
  sheet.start.x = sheet.mesh.rest;
  sheet.gravity = kGravity;
  sheet.steps = 16;
  const int substeps = 95;
  const double steps = sheet.steps * substeps;
  for (const char* name : {"jakobsen:iterations=1", "xpbd:iterations=1", "mass-spring:drag=0",
                           "pd:iterations=1", "admm:iterations=1", "avbd:iterations=1"}) {
    const std::string many =
        name + std::string(",precision=float,substeps=") + std::to_string(substeps);
    if (!can_run(findings, many, sheet)) continue;
    Simulation falls(sheet, many, sheet.steps);
    const double h = sheet.dt / substeps;
    findings.equal(many, "way fallen in 0.25 s, where g h^2 is 4.5 units, over the exact one", "1",
                   (sheet.start.x[4].y() - falls.x(4).y()) / (kG * h * h * steps * (steps + 1) / 2),
                   1, 0.125);
  }
}

TAUT_TRUTH(free_spin, 3, 10,
           "two masses on a link: projections keep momentum, and lose angular momentum as "
           "tan(phi') = sin(phi)/(2 - cos(phi)); springs keep both",
           "a correction along the link as it will lie turns it back; phi = angle per step") {
  const double spin = 6;
  const auto check = [&](const std::string& solver, double angular, double tolerance) {
    Scene s = bare::pair(1, 1, 1, 1);
    const Vec3 throws(1, 2, -0.5), center = (s.start.x[0] + s.start.x[1]) / 2,
                                   axis = Vec3(1, -2, 0).normalized();  // perpendicular to the link
    for (const std::size_t i : {0u, 1u})
      s.start.v[i] = throws + spin * axis.cross(s.start.x[i] - center);
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver, 64);
    findings.below(solver, "change of momentum in 64 steps, of 4.6 kg m/s", "kg m/s",
                   (sim.v(0) + sim.v(1) - 2 * throws).norm(), 1e-12);
    const Vec3 arm = (sim.x(1) - sim.x(0)) / 2, turns = (sim.v(1) - sim.v(0)) / 2;
    findings.equal(solver, quoted::kAngularMomentumLeft, "1",
                   2 * arm.cross(turns).dot(axis) / (2 * 0.25 * spin), angular, tolerance);
  };
  const double dt = 1.0 / 64;
  double phi = std::atan(spin * dt);  // the first step goes along the tangent
  for (int n = 1; n < 64; ++n) phi = reference::stick_next_angle(phi);
  for (const std::string& solver : {jakobsen(1), jakobsen(8, "sqrt-free"), xpbd(1), bullet(8)})
    check(solver, std::sin(phi) / (spin * dt), 1e-12);
  check(mass_spring("verlet", 1000), 1, 1e-12);
}

}  // namespace taut
