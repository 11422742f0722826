// Section 5: effect of relaxation on Verlet's stability.
#include <cmath>
#include <numbers>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/dense.hpp"
#include "core/reference/fit.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

using reference::Sweep;

/// A chain without gravity whose links start strained by `strain` [m], at rest.
Scene strained_chain(const Eigen::VectorXd& strain) {
  const int n = static_cast<int>(strain.size());
  Scene s = bare::chain(n, n, 0.1);
  double sum = 0;
  for (int i = 1; i <= n; ++i) s.start.x[to_index(i)].y() -= sum += strain[i - 1];
  return s;
}

/// Coefficients p and q of the recurrence of the first link's strain after `skip` steps.
std::array<double, 2> measured_recurrence(const Scene& s, const std::string& solver, int skip,
                                          int steps) {
  Simulation sim(s, solver);
  if (skip > 0) sim.step(skip);
  std::vector<double> y;
  for (int n = 0; n < steps; ++n) {
    y.push_back(strains(s, sim.state())[0]);
    sim.step();
  }
  return two_term_recurrence(y);
}

}  // namespace

TAUT_TRUTH(sweep_eigenvalue, 5, 1,
           "a mode that the sweeps multiply by mu obeys z^2 - 2 mu z + mu = 0: stable iff "
           "-1/3 <= mu <= 1",
           "e' = G^k (2e - e'')") {
  // Starts in the eigenvector of every real eigenvalue mu of a sweep: e' = 2 mu e - mu e''.
  const int n = 7;
  for (const bool jacobi : {false, true}) {
    const std::string solver = with(jakobsen(1), jacobi ? "method=jacobi" : "");
    if (!can_run(findings, solver, bare::chain(n, n, 1))) continue;
    const reference::Modes modes =
        reference::modes(reference::chain_sweep(n, jacobi ? Sweep::jacobi : Sweep::gauss_seidel));
    double worst = 0;
    int count = 0;
    for (int j = 0; j < n; ++j) {
      const double mu = modes.eigenvalues[j].real();
      if (std::abs(modes.eigenvalues[j].imag()) > 1e-9 || std::abs(mu) < 0.01) continue;
      const Eigen::VectorXd mode = modes.eigenvectors.col(j).real();
      const auto [p, q] = measured_recurrence(
          strained_chain(1e-3 * mode / mode.cwiseAbs().maxCoeff()), solver, 0, 7);
      worst = std::max({worst, std::abs(p - 2 * mu), std::abs(q + mu)});
      ++count;
    }
    findings.below(solver,
                   "distance of z^2 - 2 mu z + mu, " + std::to_string(count) + " modes of 7 links",
                   "1", worst, 1e-6);
  }
  // Stable between mu = -1/3 and 1: one link under omega has mu = 1 - omega.
  findings.equal("closed form", "|z| at mu = -1/3", "1", std::abs(reference::verlet_root(-1.0 / 3)),
                 1, 1e-12);
  findings.equal("closed form", "|z| at mu = 1", "1", std::abs(reference::verlet_root(1)), 1, 1e-7);
}

TAUT_TRUTH(gauss_seidel_decay, 5, 2,
           "|z| = rho^(k/2), rho = cos^2(pi/2N); settles in 8 N^2 dt/(pi^2 k)",
           "roots of z^2 - 2 mu z + mu at mu = rho^k") {
  const int n = 16;
  const double rho = reference::chain_radius(n, Sweep::gauss_seidel);
  for (const int k : {1, 4}) {
    for (const std::string& solver :
         {jakobsen(k), bullet(k),
          "xpbd:order=mesh,substeps=1,precision=double,iterations=" + std::to_string(k)}) {
      Eigen::VectorXd strain = Eigen::VectorXd::Constant(n, 1e-6);
      const Scene s = strained_chain(strain);
      if (!can_run(findings, solver, s)) continue;
      const auto [p, q] = measured_recurrence(s, solver, 800 / k, 400 / k);
      const double radius = std::sqrt(-q), turn = std::acos(p / 2 / radius);
      const std::string at = ", k = " + std::to_string(k);
      findings.equal(solver, "|z| = rho^(k/2)" + at, "1", radius, std::pow(rho, k / 2.0), 1e-5);
      findings.equal(solver, "period 2 pi/acos(rho^(k/2))" + at, "steps",
                     2 * std::numbers::pi / turn,
                     2 * std::numbers::pi / std::acos(std::pow(rho, k / 2.0)), 0.05);
      const double settling = -1 / std::log(radius);
      findings.equal(solver, "settling time over 8 N^2/(pi^2 k)" + at, "1",
                     settling / (8.0 * n * n / (std::numbers::pi * std::numbers::pi * k)), 1, 0.01);
    }
  }
  for (const int links : {2, 7, 16, 64})
    for (const Sweep sweep : {Sweep::gauss_seidel, Sweep::jacobi}) {
      const double radius = reference::spectral_radius(reference::chain_sweep(links, sweep));
      findings.equal("closed form",
                     std::string(sweep == Sweep::jacobi ? "rho_J = cos" : "rho_GS = cos^2") +
                         "(pi/2N), N = " + std::to_string(links),
                     "1", radius, reference::chain_radius(links, sweep), 1e-6);
    }
}

TAUT_TRUTH(plain_jacobi, 5, 3,
           "plain Jacobi with odd k grows up to 1 + sqrt(2) per step; averaging cures it",
           "mu -> -1") {
  const int n = 32;
  const std::string solver = jakobsen(1, "exact", "method=jacobi");
  Eigen::VectorXd strain(n);
  for (int j = 0; j < n; ++j) strain[j] = 1e-12 * (j % 2 ? 1 : -1);
  const Scene s = strained_chain(strain);
  const double bound = 1 + std::numbers::sqrt2;
  const double expected =
      std::abs(reference::verlet_root(-reference::chain_radius(n, Sweep::jacobi)));
  findings.equal("closed form", "growth per step of the fastest mode for many links", "1",
                 std::abs(reference::verlet_root(-1)), bound, 1e-12);
  if (!can_run(findings, solver, s)) return;
  Simulation sim(s, solver, 20);
  const double before = max_strain(s, sim.state());
  sim.step();
  findings.equal(solver, "growth per step of a chain of 32 links, k = 1", "1",
                 max_strain(s, sim.state()) / before, expected, 0.02);
  for (const char* cure : {"method=jacobi-averaged", "method=jacobi-underrelaxed"}) {
    const std::string stable = jakobsen(1, "exact", cure);
    if (!can_run(findings, stable, s)) continue;
    Simulation calm(s, stable, 5000);
    findings.below(stable, "strain after 5000 steps from 1e-12", "1", max_strain(s, calm.state()),
                   1e-12);
  }
}

TAUT_TRUTH(over_relaxation, 5, 4, "one sweep with omega > 4/3 is unstable",
           "mu = 1 - omega of a single link against -1/3") {
  const auto growth = [](const std::string& solver) {
    const Scene s = strained_chain(Eigen::VectorXd::Constant(1, 1e-9));
    Simulation sim(s, solver, 200);
    const double before = std::abs(strains(s, sim.state())[0]);
    sim.step(100);
    return std::pow(std::abs(strains(s, sim.state())[0]) / before, 0.01);
  };
  for (const bool is_bullet : {false, true}) {
    const auto solver = [&](double omega) {
      return is_bullet ? with(bullet(1), "stiffness=" + as_typed(omega))
                       : jakobsen(1, "exact", "omega=" + as_typed(omega));
    };
    const Scene s = strained_chain(Eigen::VectorXd::Constant(1, 1e-9));
    if (!can_run(findings, solver(1.33), s)) continue;
    for (const double omega : {1.33, 1.34}) {
      // Where the roots are complex, |strain| alternates within its envelope; here both are real.
      const double expected = std::abs(reference::verlet_root(1 - omega));
      findings.equal(solver(omega), "growth per step", "1", growth(solver(omega)), expected, 2e-3);
    }
    findings.holds(solver(1.33), "stable", growth(solver(1.33)) < 1);
    findings.holds(solver(1.34), "unstable", growth(solver(1.34)) > 1);
  }
}

TAUT_TRUTH(legitimate_strain, 5, 5,
           "strain (N-1) g dt^2/(k l), up to twice that on the way: 500 % is no blow-up",
           "the hanging chain under k sweeps") {
  const int n = 32;
  const double dt = static_cast<double>(1.0F / 60), l = 1.0 / n;
  Scene s = under_gravity(bare::chain(n, 1, 0.1));
  s.dt = dt;
  struct Strain {
    double peak = 0, rest = 0;
  };
  for (const int k : {1, 4}) {
    const double scale = (n - 1) * kG * dt * dt / (k * l);
    const std::string at = ", k = " + std::to_string(k);
    const auto measure = [&](const std::string& solver) {
      Strain strain;
      Simulation sim(s, solver);
      strain.peak = sim.worst(4000, [&](int) { return strain.rest = max_strain(s, sim.state()); });
      return strain;
    };
    if (can_run(findings, jakobsen(k), s)) {
      const Strain strain = measure(jakobsen(k));
      findings.equal(jakobsen(k), "strain at rest over (N-1) g dt^2/(k l)" + at, "1",
                     strain.rest / scale, 1, 0.1);
      findings.equal(jakobsen(k), "peak over (N-1) g dt^2/(k l)" + at, "1", strain.peak / scale,
                     1.8, 0.2);
      if (k == 1)
        findings.equal(jakobsen(k), "peak on the way to rest, N = 32, 60 Hz, k = 1", "1",
                       strain.peak, 5, 0.5);
    }
    if (can_run(findings, bullet(k), s))
      findings.deviates(bullet(k), "peak over (N-1) g dt^2/(k l)" + at, "1",
                        measure(bullet(k)).peak / scale, 1.8,
                        measure(jakobsen(k, "sqrt-free")).peak / scale, 0.01,
                        "a square-root-free pass overcorrects large stretches, as ours does");
  }
}

}  // namespace taut
