// Section 4, chains: springs, catenaries, swinging modes, and the chain under k sweeps.
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/model/index.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/fit.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"
#include "core/reference/textbook.hpp"
#include "experiments/truths/quoted.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

using reference::Sweep;
Scene hanging(int n, double mass, double dt, double g = kG) {
  Scene s = bare::chain(n, 1, mass);
  s.gravity = {0, -g, 0};
  s.dt = dt;
  return s;
}

Scene catenary_scene(double mass) {
  const int n = 16;
  Scene s = under_gravity(bare::chain(n, 1, mass, Vec3::UnitX()));
  s.pins = {0, n};
  s.dt = 1.0 / 256;
  s.damping = 4;
  // start: a shallow zigzag of the right lengths between pins 0.8 apart
  for (int i = 0; i <= n; ++i)
    s.start.x[to_index(i)] = Vec3(0.8 * i / n, i % 2 ? -0.6 / n : 0.0, 0);
  return s;
}

double sag(const std::vector<Vec3>& x) {
  double lowest = 0;
  for (const Vec3& p : x) lowest = std::min(lowest, p.y());
  return -lowest;
}

/// Strains [m] of the hanging chain at rest under k sweeps, from an unstrained start.
std::vector<double> settled_strains(const std::string& solver, int n, int k, double dt,
                                    double g = kG) {
  Scene s = hanging(n, 0.1, dt, g);
  Simulation sim(s, solver);
  const double decay = std::numbers::pi * std::numbers::pi * k / (8.0 * n * n);  // per step
  sim.step(static_cast<int>(20 / decay) + 40);
  return strains(s, sim.state());
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

/// Largest distance from the recurrence, relative to the largest strain.
double recurrence_gap(const std::vector<double>& e, Sweep sweep, int k, double a) {
  const auto exact =
      reference::steady_strain(reference::chain_sweep(static_cast<int>(e.size()), sweep), k, a);
  double worst = 0;
  for (std::size_t j = 0; j < e.size(); ++j)
    worst = std::max(worst, std::abs(e[j] - exact[static_cast<Eigen::Index>(j)]));
  return worst / exact.maxCoeff();
}

}  // namespace

TAUT_TRUTH(elastic_chain, 4, 6,
           "link j of a vertical elastic chain extends (N-j+1) m g/K; tip m g N(N+1)/(2K)",
           "statics") {
  const int n = 8;
  const double stiffness = 1000, mass = 0.1;
  const auto check = [&](const std::string& solver, int links, double tolerance) {
    Scene s = hanging(links, mass, 1.0 / 1024);
    s.damping = solver_name(solver) == "mass-spring" ? 0 : 8;
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    settle(sim, 1e-12, 64, 64 * 400);
    const std::vector<double> e = strains(s, sim.state());
    double worst = 0;
    for (int j = 1; j <= links; ++j) {
      const double expected = (links - j + 1) * mass * kG / stiffness;
      worst = std::max(worst, std::abs(e[to_index(j - 1)] - expected));
    }
    findings.below(solver, "distance of a link's extension from (N-j+1) m g/K", "m", worst,
                   tolerance);
    findings.equal(solver, "extension of the tip, m g N(N+1)/(2K)", "m", -sim.x(links).y() - 1,
                   mass * kG * links * (links + 1) / (2 * stiffness), links * tolerance);
  };
  for (const char* integrator : {"explicit-euler", "symplectic-euler", "verlet"})
    check(mass_spring(integrator, stiffness, 5), n, 1e-10);
  check("xpbd:iterations=100,substeps=1,structural=0.001,precision=double", n, 1e-10);
}

TAUT_TRUTH(spring_chain_modes, 4, 7,
           "fixed-free spring chain: w_j = 2 sqrt(K/m) sin((2j-1) pi/(2(2N+1)))",
           "Lagrange 1788; Verlet's sin(W dt/2) = w dt/2 undone") {
  const int n = 16;
  const double stiffness = 50, mass = 0.2, dt = 1.0 / 64;
  const auto w = reference::spring_chain_frequencies(n, stiffness, mass);
  for (const char* integrator : {"verlet", "symplectic-euler"}) {
    const std::string solver = mass_spring(integrator, stiffness);
    Scene s = bare::chain(n, n, mass);
    s.dt = dt;
    if (!can_run(findings, solver, s)) continue;
    double worst = 0;
    for (int j = 1; j <= n; ++j) {
      Scene mode = s;
      for (int i = 1; i <= n; ++i)
        mode.start.x[to_index(i)].y() +=
            0.2 * std::sin((2 * j - 1) * std::numbers::pi * i / (2 * n + 1));
      Simulation sim(mode, solver);
      const auto y = sim.record(100, [&] { return sim.x(n).y() + n; });
      const double measured = std::sqrt(2 - two_term_recurrence(y)[0]) / dt;
      worst = std::max(worst, std::abs(measured / w[to_index(j - 1)] - 1));
    }
    findings.below(solver, "relative distance from 2 sqrt(K/m) sin((2j-1) pi/(2(2N+1))), 16 modes",
                   "1", worst, 1e-8);
  }
}

TAUT_TRUTH(hanging_chain_modes, 4, 8,
           "w^2 = (g/l) xi with L_N(xi) = 0; order 1 in l to Bessel's (j_0m/2) sqrt(g/L)",
           "D. Bernoulli 1733; Laguerre") {
  const double printed[2][2] = {{3.70910, 8.52202}, {3.73712, 8.58035}};
  std::vector<double> lengths, errors;
  for (const int n : {16, 32, 64, 128}) {
    const auto w = reference::hanging_chain_frequencies(n, 1, kG);
    lengths.push_back(1.0 / n);
    errors.push_back(reference::hanging_rope_frequency(1, 1, kG) - w[0]);
    for (const int mode : {0, 1})
      if (n <= 32)
        findings.equal("closed form",
                       "mode " + std::to_string(mode + 1) + " of " + std::to_string(n) + " links",
                       "rad/s", w[to_index(mode)], printed[n / 32][mode], 5e-6);
  }
  findings.equal("closed form", "Bessel limit, mode 1", "rad/s",
                 reference::hanging_rope_frequency(1, 1, kG), 3.76607, 5e-6);
  findings.equal("closed form", "Bessel limit, mode 2", "rad/s",
                 reference::hanging_rope_frequency(2, 1, kG), 8.64470, 5e-6);
  const PowerLaw order = fit_power_law(lengths, errors);
  findings.slope("closed form", "order in the link length", order, 1, 0.02);
  if (!findings.wants(kShake)) return;
  const int n = 16;
  const double dt = 1.0 / 256;
  for (const int mode : {1, 2}) {
    Scene s = hanging(n, 0.1, dt);
    const auto shape = reference::hanging_chain_mode(n, mode);
    for (int i = 1; i <= n; ++i) {
      const auto at = to_index(i);
      s.start.x[at].x() = 1e-3 * shape[at - 1];
      const double dx = s.start.x[at].x() - s.start.x[at - 1].x(), l = 1.0 / n;
      s.start.x[at].y() = s.start.x[at - 1].y() - std::sqrt(l * l - dx * dx);
    }
    reference::Shake shake(s, dt);
    std::vector<double> y;
    for (int k = 0; k < 400; ++k) {
      shake.step();
      y.push_back(shake.state().x.back().x());
    }
    findings.equal(kShake, "mode " + std::to_string(mode) + " of 16 links in motion", "rad/s",
                   std::sqrt(2 - two_term_recurrence(y)[0]) / dt, printed[0][mode - 1], 1e-4);
  }
}

TAUT_TRUTH(discrete_catenary, 4, 9,
           "tan(theta_i) = (P/H)(i - (N+1)/2), sum l cos(theta_i) = D; elastic: l + T/K",
           "statics of every joint; order 2 in l to the catenary") {
  const int n = 16;
  const double mass = 0.02, exact = 0.265991492135;
  findings.equal("closed form", "sag, L = 1, D = 0.8, 16 links", "m",
                 reference::discrete_catenary(n, 0.8, 1.0 / n, mass * kG).sag(), exact, 5e-13);
  findings.equal("closed form", "sag of the continuum", "m", reference::continuum_sag(1, 0.8),
                 0.265437509140, 5e-13);
  const PowerLaw order = fit_over({1.0 / 16, 1.0 / 32, 1.0 / 64, 1.0 / 128}, [](double link) {
    const int links = static_cast<int>(1 / link);
    return reference::discrete_catenary(links, 0.8, link, 1).sag() -
           reference::continuum_sag(1, 0.8);
  });
  findings.slope("closed form", "order in the link length", order, 2, 0.02);
  const Scene s = catenary_scene(mass);
  if (findings.wants(kStatic)) {
    const auto e = reference::static_equilibrium(s);
    findings.equal(kStatic, "sag", "m", e.unique ? sag(e.x) : std::nan(""), exact, 5e-13);
  }
  // However many sweeps there are, they start g dt^2 below. Their directions, and hence the shape
  // at rest, are off in second order.
  for (const std::string& solver : {jakobsen(1200), jakobsen(1200, "sqrt-free"), bullet(1200)}) {
    if (!can_run(findings, solver, s)) continue;
    double off = 0;
    const PowerLaw slope = fit_over({1.0 / 64, 1.0 / 128, 1.0 / 256}, [&](double dt) {
      Scene finer = s;
      finer.dt = dt;
      Simulation sim(finer, solver);
      settle(sim, 1e-9, 32, static_cast<int>(12 / dt));
      return off = std::abs(sag(sim.state().x) - exact);
    });
    findings.slope(solver, "order in dt of the sag at rest, 1200 sweeps", slope, 2, 0.1);
    findings.below(solver, "error of the sag at dt = 1/256 s", "m", off, 3e-5);
  }
  const double stiffness = 200;
  const std::string springs = mass_spring("verlet", stiffness, 0.05);
  Scene elastic = s;
  elastic.dt = 1.0 / 1024;
  elastic.stiffness = {stiffness, stiffness, stiffness};
  const double stretched =
      reference::discrete_catenary(n, 0.8, 1.0 / n, mass * kG, stiffness).sag();
  // Solvers that stop short of the step's equilibrium start g dt^2 below: off in second order, as
  // above.
  for (const auto& [solver, tolerance] :
       {std::pair("xpbd:iterations=100,substeps=1,precision=double", 1e-5),
        {"bullet-deformable:precision=double", 1e-5},
        {"implicit", 1e-9},
        {"pd:iterations=20", 1e-9},
        {"admm:iterations=20", 1e-9},
        {"vbd:iterations=20", 1e-9}}) {
    if (!can_run(findings, solver, elastic)) continue;
    Simulation sim(elastic, solver);
    settle(sim, 1e-11, 256, 256 * 48);
    findings.equal(solver, "sag of the elastic chain, link length l + T/K", "m", sag(sim.state().x),
                   stretched, tolerance);
  }
  elastic.damping = 0;
  if (!can_run(findings, springs, elastic)) return;
  Simulation sim(elastic, springs);
  settle(sim, 1e-12, 256, 256 * 400);
  findings.equal(springs, "sag of the elastic chain, link length l + T/K", "m", sag(sim.state().x),
                 stretched, 1e-9);
}

TAUT_TRUTH(hanging_chain_sweeps, 4, 10,
           "at rest under k sweeps the strain is e = (I - G^k)^-1 G^k a delta_1, a = g dt^2",
           "fixed point of fall and sweep in strain space") {
  const std::string subject = jakobsen(1);
  if (can_run(findings, subject, hanging(4, 1, 1.0 / 64))) {
    double worst = 0;
    for (const int n : {16, 32, 64, 128})
      for (const int k : {1, 4, 16, 64, 256})
        worst = std::max(worst, recurrence_gap(settled_strains(jakobsen(k), n, k, 1.0 / 64),
                                               Sweep::gauss_seidel, k, kG / 4096));
    for (const double rate : {30.0, 60.0, 120.0, 240.0, 480.0})
      worst = std::max(worst, recurrence_gap(settled_strains(jakobsen(4), 16, 4, 1 / rate),
                                             Sweep::gauss_seidel, 4, kG / rate / rate));
    findings.below(subject,
                   "relative distance from (I - G^k)^-1 G^k a delta_1: N 16..128, k 1..256, "
                   "dt 1/30..1/480",
                   "1", worst, 1e-6);
    const std::vector<double> once = settled_strains(subject, 16, 1, 1.0 / 64);
    findings.equal(subject, "k = 1: strain of the top link, (N-1) g dt^2", "m", once[0],
                   15 * kG / 4096, 1e-9);
  }
  // Small g keeps the square-root-free form of Bullet and the substep form of XPBD in the linear
  // range.
  const double g = 1e-3;
  for (const int k : {1, 4, 16}) {
    const std::string sweeps = "k = " + std::to_string(k);
    for (const std::string& solver :
         {bullet(k), jakobsen(k, "sqrt-free"),
          "xpbd:order=mesh,substeps=1,precision=double,iterations=" + std::to_string(k)})
      if (can_run(findings, solver, hanging(4, 1, 1.0 / 64)))
        findings.below(solver, "relative distance from the recurrence, N = 16, " + sweeps, "1",
                       recurrence_gap(settled_strains(solver, 16, k, 1.0 / 64, g),
                                      Sweep::gauss_seidel, k, g / 4096),
                       2e-4);
  }
  // n substeps of one sweep and one step of n sweeps differ by a factor n.
  const std::string substeps = jakobsen(1, "exact", "substeps=16");
  if (!can_run(findings, substeps, hanging(4, 1, 1.0 / 64))) return;
  Scene s = hanging(16, 0.1, 1.0 / 64);
  Simulation sim(s, substeps, 1200);
  findings.equal(substeps, "top strain of one sweep each, over (N-1) g (dt/16)^2", "1",
                 largest(strains(s, sim.state())) / (15 * kG / 4096 / 256), 1, 1e-6);
}

TAUT_TRUTH(hanging_chain_slopes, 4, 11,
           "its slopes: 2.0000 in dt, -1.036 -1.086 -1.216 -1.834 in k (N = 16); one curve in "
           "k/dt^2",
           "the recurrence, and its limit of many links") {
  struct Row {
    int n;
    double printed[4];
  };
  const int ks[] = {1, 4, 16, 64, 256};
  for (const Row& row :
       {Row{16, {-1.036, -1.086, -1.216, -1.834}}, Row{128, {-1.004, -1.009, -1.019, -1.040}}}) {
    std::vector<double> exact, measured;
    const bool run = can_run(findings, jakobsen(1), hanging(4, 1, 1.0 / 64));
    for (const int k : ks) {
      const auto g = reference::chain_sweep(row.n, Sweep::gauss_seidel);
      exact.push_back(reference::steady_strain(g, k, kG / 4096).maxCoeff());
      if (run) measured.push_back(largest(settled_strains(jakobsen(k), row.n, k, 1.0 / 64)));
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string name = "slope in k, " + std::to_string(ks[i]) + " to " +
                               std::to_string(ks[i + 1]) + ", N = " + std::to_string(row.n);
      const double span = std::log(4.0);
      findings.equal("closed form", name, "1", std::log(exact[i + 1] / exact[i]) / span,
                     row.printed[i], 1e-3);
      if (run)
        findings.equal(jakobsen(1), name, "1", std::log(measured[i + 1] / measured[i]) / span,
                       row.printed[i], 1e-3);
    }
  }
  for (const std::string& solver : {jakobsen(4), bullet(4)}) {
    if (!can_run(findings, solver, hanging(4, 1, 1.0 / 64))) continue;
    const PowerLaw slope =
        fit_over({1.0 / 32, 1.0 / 64, 1.0 / 128, 1.0 / 256, 1.0 / 512},
                 [&](double dt) { return largest(settled_strains(solver, 16, 4, dt, 1e-3)); });
    findings.slope(solver, quoted::kSlopeInTimeStep, slope, 2, 5e-4);
  }
  // All lie on one curve in k/dt^2: the large-N sum, within O(1/N).
  for (const int n : {64, 128}) {
    double worst = 0;
    for (const int k : {16, 64, 256, 1024, 4096}) {
      const double exact_max =
          reference::steady_strain(reference::chain_sweep(n, Sweep::gauss_seidel), k, 1).maxCoeff();
      worst = std::max(worst, std::abs(exact_max / reference::collapsed_strain(n, k, 1) - 1));
    }
    findings.below(
        "closed form",
        "relative distance of e_max from the collapsed curve, k >= 16, N = " + std::to_string(n),
        "1", worst, 0.08);
  }
}

TAUT_TRUTH(softer_sweeps, 4, 12,
           "Jacobi sweeps are 2x softer than Gauss-Seidel's, averaged Jacobi 4x",
           "spectra of the sweeps: cos^2, cos, (1 + cos)/2 of pi/2N") {
  const int n = 64, k = 16;
  const std::string base = jakobsen(k);
  if (!can_run(findings, with(base, "method=jacobi"), hanging(n, 1, 1.0 / 64))) return;
  const auto tip = [&](const std::vector<double>& e) {
    return std::accumulate(e.begin(), e.end(), 0.0);
  };
  const auto gauss_seidel = settled_strains(base, n, k, 1.0 / 64);
  const std::string plain = with(base, "method=jacobi");
  const auto jacobi = settled_strains(plain, n, k / 2, 1.0 / 64);
  findings.below(plain, "relative distance from the recurrence, N = 64", "1",
                 recurrence_gap(jacobi, Sweep::jacobi, k, kG / 4096), 1e-6);
  findings.equal(plain, "extension of the tip over Gauss-Seidel's", "1",
                 tip(jacobi) / tip(gauss_seidel), 2, 0.1);
  findings.deviates(
      plain, "largest strain over Gauss-Seidel's", "1", largest(jacobi) / largest(gauss_seidel), 2,
      4, 0.1, "its eigenvalues come in pairs +-mu: an alternating strain of equal size adds up");
  const std::string averaged = with(base, "method=jacobi-averaged");
  const auto mean = settled_strains(averaged, n, k / 4, 1.0 / 64);
  findings.equal(averaged, "extension of the tip over Gauss-Seidel's", "1",
                 tip(mean) / tip(gauss_seidel), 4, 0.2);
}

TAUT_TRUTH(chain_tension, 4, 13,
           "the corrections of a step sum to the weight below: lambda/dt^2 = T, for any k",
           "momentum balance of a step at rest") {
  const int n = 16;
  const double mass = 0.1;
  for (const int k : {1, 3, 16}) {
    const std::string solver = jakobsen(k);
    const Scene s = hanging(n, mass, 1.0 / 64);
    if (!can_run(findings, solver, s)) continue;
    Simulation sim(s, solver, 20000 / k);
    Textbook<double> textbook(s, k);
    textbook.load(sim.state());
    textbook.step();
    double worst = 0;
    for (int j = 0; j < n; ++j)
      worst = std::max(
          worst, std::abs(textbook.lambda()[to_index(j)] / s.dt / s.dt - (n - j) * mass * kG));
    findings.below(solver, "distance of lambda/dt^2 from the weight below the link", "N", worst,
                   1e-8);
  }
}

}  // namespace taut
