// Section 3, damped links: damping in proportion to stiffness, against each scheme's own
// recurrence, and that it does not brake a fall.
#include <cmath>
#include <numbers>

#include "core/model/text.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

constexpr double kStiffness = 40, kMass = 0.1;  // N/m, kg
constexpr int kMasses = 4;

/// w [rad/s] of mode k of the chain of springs, held at one end.
double frequency(int k) {
  return 2 * std::sqrt(kStiffness / kMass) *
         std::sin((2 * k - 1) * std::numbers::pi / (2 * (2 * kMasses + 1)));
}

/// The chain, which starts at rest in mode k along itself.
Scene chain_in_mode(int k, double damping, double dt, double amplitude = 0.02) {
  Scene s = bare::chain(kMasses, kMasses, kMass);
  for (int i = 1; i <= kMasses; ++i)
    s.start.x[to_index(i)].y() -=
        amplitude * std::sin((2 * k - 1) * std::numbers::pi * i / (2 * kMasses + 1));
  s.stiffness = {kStiffness, kStiffness, kStiffness};
  s.link_damping = damping;
  s.dt = dt;
  return s;
}

/// Displacement of the last mass, over its first one, at the start and after each step.
std::vector<double> swing(const Scene& s, const std::string& solver, int steps) {
  const auto at = [](const Vec3& x) { return -x.y() - kMasses; };
  const double first = at(s.start.x.back());
  Simulation sim(s, solver);
  std::vector<double> all = sim.record(steps, [&] { return at(sim.x(kMasses)) / first; });
  all.insert(all.begin(), 1);
  return all;
}

/// What a step makes of the displacements x now and x_0 a step before, with v = w h and
/// q = b w^2 h.
enum class Scheme {
  implicit_euler,    ///< x' - 2 x + x_0 = -v^2 x' - q (x' - x)
  symplectic_euler,  ///< x' - 2 x + x_0 = -v^2 x - q (x - x_0); Verlet is the same
  explicit_euler     ///< x' - 2 x + x_0 = -v^2 x_0 - q (x - x_0)
};
double after(Scheme scheme, double now, double before, double v2, double q) {
  if (scheme == Scheme::implicit_euler) return (2 * now - before + q * now) / (1 + v2 + q);
  const double spring = scheme == Scheme::symplectic_euler ? now : before;
  return 2 * now - before - v2 * spring - q * (now - before);
}

struct Way {
  std::string solver;
  Scheme scheme;
};
std::vector<Way> ways() {
  std::vector<Way> all{{mass_spring("verlet", kStiffness), Scheme::symplectic_euler},
                       {mass_spring("symplectic-euler", kStiffness), Scheme::symplectic_euler},
                       {mass_spring("explicit-euler", kStiffness), Scheme::explicit_euler}};
  for (const char* solver :
       {"implicit", "implicit:multipliers=keep", "vbd:iterations=200", "pd:iterations=400",
        "admm:iterations=400", "xpbd:iterations=400,substeps=1,order=mesh,precision=double",
        "xpbd:iterations=400,substeps=1,precision=double",
        "xpbd:method=global,iterations=5,substeps=1,precision=double",
        "xpbd:method=global,primal=on,iterations=50,substeps=1,precision=double"})
    all.push_back({solver, Scheme::implicit_euler});
  return all;
}

/// Damping ratio of the root of x' = a x + c x_0.
double ratio_of(const std::vector<double>& y) {
  const auto [a, c] = two_term_recurrence(y);
  const double decay = -std::log(-c) / 2, turn = std::acos(a / (2 * std::sqrt(-c)));
  return decay / std::hypot(decay, turn);
}

}  // namespace

TAUT_TRUTH(damped_links, 3, 13,
           "links damped in proportion to stiffness: a mode w has the ratio b w/2; implicit Euler "
           "adds w h/2; explicit steps are below (2/w)(sqrt(1 + zeta^2) - zeta)",
           "Rayleigh damping, each scheme's own recurrence; Macklin et al. 2016, equation 26") {
  const double h = 1.0 / 256;
  for (const auto& [solver, scheme] : ways()) {
    if (!can_run(findings, solver, chain_in_mode(1, 0.02, h))) continue;
    for (const auto& [k, damping] : {std::pair(1, 0.02), {3, 0.005}}) {
      const double w = frequency(k), v2 = w * w * h * h, q = damping * w * w * h;
      const std::vector<double> y = swing(chain_in_mode(k, damping, h), solver, 200);
      double before = 1, now = scheme == Scheme::explicit_euler ? 1 : after(scheme, 1, 1, v2, q),
             most = std::abs(y[1] - now);
      for (std::size_t n = 2; n < y.size(); ++n) {
        const double next = after(scheme, now, before, v2, q);
        before = now;
        now = next;
        most = larger(most, std::abs(y[n] - now));
      }
      findings.below(solver,
                     "distance from its recurrence in 200 steps, mode " + std::to_string(k) +
                         ", over the amplitude",
                     "1", most, 1e-9);
    }
    const double fine = 1.0 / 4096, w = frequency(1), damping = 0.02;
    const double own = scheme == Scheme::implicit_euler     ? w * fine / 2
                       : scheme == Scheme::symplectic_euler ? 0
                                                            : -w * fine / 2;
    findings.equal(
        solver, "damping ratio, less the scheme's own, over b w/2", "1",
        (ratio_of(swing(chain_in_mode(1, damping, fine), solver, 400)) - own) / (damping * w / 2),
        1, 0.01);
  }
  const double w = frequency(kMasses), zeta = 0.5,
               limit = (std::sqrt(1 + zeta * zeta) - zeta) * 2 / w;
  for (const char* integrator : {"verlet", "symplectic-euler"}) {
    const std::string solver = mass_spring(integrator, kStiffness);
    if (!can_run(findings, solver, chain_in_mode(kMasses, 2 * zeta / w, h))) continue;
    const double most = sign_change(0.9 * limit, 1.1 * limit, 1e-10, [&](double dt) {
      const auto y = swing(chain_in_mode(kMasses, 2 * zeta / w, dt, 1e-6), solver, 25);
      return y[25] / y[24] + 1;
    });
    findings.equal(solver, "largest stable dt w/2 with damping ratio 0.5", "1", most * w / 2,
                   std::sqrt(1 + zeta * zeta) - zeta, 1e-6);
  }
}

TAUT_TRUTH(damped_fall, 3, 14, "damping of links does not brake a fall: v = g t",
           "links at rest length have no strain rate; vbd's published damping brakes each vertex") {
  Scene s = under_gravity(bare::sheet(5, 5, {true, true, true}));
  s.stiffness = {20, 10, 1};
  s.link_damping = 0.02;
  const auto error = [](const Scene& scene, const std::string& solver) {
    double most = 0;
    const State end = Simulation(scene, solver, 64).state();
    for (const Vec3& v : end.v) most = larger(most, (v - scene.gravity).norm());
    return most;
  };
  for (const char* solver : {"mass-spring", "implicit", "vbd:iterations=20", "pd", "admm",
                             "xpbd:substeps=1,iterations=20,order=mesh,precision=double",
                             "xpbd:method=global,precision=double"}) {
    if (!can_run(findings, solver, s)) continue;
    findings.below(solver, "distance of the velocity from g t at 1 s", "m/s", error(s, solver),
                   1e-9);
  }
  s.link_damping = 0;
  const std::string published = "vbd:iterations=20,damping=0.02";
  if (!can_run(findings, published, s)) return;
  findings.holds(published, "as published it falls more than a tenth slower",
                 error(s, published) > 0.1 * kG);
}

}  // namespace taut
