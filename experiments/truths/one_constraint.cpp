// Section 1: effect of one projection of one link, in closed form.
#include <cmath>

#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// Vasilovici's second listing ("the algorithm then becomes") as printed. This is a test double
/// that must never be used to simulate: its first line belongs to the square-root-free form and its
/// last two to the exact one. `diff` is therefore undefined there and, whatever it may mean, the
/// signs push apart.
///
///     Delta *= restlength * restlength / (delta * delta + restlength * restlength) - 0.5
///     x1 += delta * 0.5 * diff;
///     x2 -= delta * 0.5 * diff;
enum class PrintedReading {
  opposite_sign,  ///< 0.5 diff = 1: the square-root-free form with the printed += and -=
  literal         ///< diff = (d - r)/d, from Vasilovici's first listing
};

/// Strain after one application of the listing to a link of unit rest length and strain e, with
/// equal masses.
double printed_strain(PrintedReading reading, double e) {
  const double rest = 1, d = rest + e;
  double x1 = 0, x2 = d;
  const double diff = reading == PrintedReading::literal ? (d - rest) / d : 2;
  double delta = x2 - x1;
  delta *= rest * rest / (delta * delta + rest * rest) - 0.5;
  x1 += delta * 0.5 * diff;
  x2 -= delta * 0.5 * diff;
  return (x2 - x1) / rest - 1;
}

constexpr double kStrains[] = {-0.9, -0.5, -0.1, -1e-3, 1e-3, 0.1, 0.5, 1, 4, 20};
constexpr double kRest = 0.7;
constexpr double kEpsilon = 2.3e-16, kFloatEpsilon = 1.2e-7;
const char* const kFloat = ",precision=float";

/// Strain of a link after one step from rest, which consists of the sweeps alone; below -1 if its
/// ends have changed sides.
double projected(std::string_view solver, double strain, double mass1 = 1, double mass2 = 3) {
  Simulation sim(bare::pair(kRest * (1 + strain), kRest, mass1, mass2), solver);
  const Vec3 before = (sim.x(1) - sim.x(0)).normalized();
  sim.step();
  const Vec3 after = sim.x(1) - sim.x(0);
  return std::copysign(after.norm(), after.dot(before)) / kRest - 1;
}

/// The strain that one square-root-free projection leaves.
double sqrt_free(double e) { return -e * e / (2 + 2 * e + e * e); }

std::string in_float(std::string_view projection) {
  return "jakobsen:iterations=1,substeps=1,order=mesh,projection=" + std::string(projection) +
         kFloat;
}

template <class F>
double worst_over_strains(const F& error) {
  double worst = 0;
  for (const double e : kStrains) {
    worst = larger(worst, std::abs(error(e)));
  }
  return worst;
}

}  // namespace

TAUT_TRUTH(exact_projection, 1, 1, "one projection of an isolated link gives |delta| = r",
           "Jakobsen 2001, section 4") {
  const auto check = [&](const std::string& solver, double tolerance) {
    if (!can_run(findings, solver, bare::pair(1, 1))) return;
    findings.below(solver, "strain left by one projection, -90 % to +2000 %", "1",
                   worst_over_strains([&](double e) { return projected(solver, e); }), tolerance);
  };
  check(jakobsen(1), 32 * kEpsilon);
  check(in_float("exact"), 32 * kFloatEpsilon);
  check(xpbd(1), 32 * kEpsilon);
}

TAUT_TRUTH(sqrt_free_projection, 1, 2, "the square-root-free form leaves e' = -e^2/(2 + 2e + e^2)",
           "algebra on Jakobsen 2001, section 4, with the signs corrected") {
  const auto check = [&](const std::string& solver, double tolerance) {
    if (!can_run(findings, solver, bare::pair(1, 1))) return;
    findings.below(
        solver, "distance from -e^2/(2 + 2e + e^2), -90 % to +2000 %", "1",
        worst_over_strains([&](double e) { return projected(solver, e) - sqrt_free(e); }),
        tolerance);
  };
  check(jakobsen(1, "sqrt-free"), 32 * kEpsilon);
  check(in_float("sqrt-free"), 32 * kFloatEpsilon);
  check(bullet(1), 32 * kEpsilon);
}

TAUT_TRUTH(repeated_sqrt_free, 1, 3, "n passes give |delta|/r = tanh(2^n atanh(min(x0, 1/x0)))",
           "the map x -> 2x/(1 + x^2) is the doubling of the hyperbolic tangent") {
  for (const bool is_bullet : {false, true}) {
    const auto solver = [&](int n) { return is_bullet ? bullet(n) : jakobsen(n, "sqrt-free"); };
    if (!can_run(findings, solver(4), bare::pair(1, 1))) continue;
    double worst = 0;
    for (int n = 1; n <= 5; ++n)
      for (const double e : {-0.5, 0.1, 0.5, 1.0, 4.0}) {
        const double x0 = 1 + e, u0 = std::atanh(std::min(x0, 1 / x0));
        const double expected = std::tanh(std::ldexp(u0, n)) - 1;
        worst = std::max(worst, std::abs(projected(solver(n), e) - expected));
      }
    findings.below(solver(4), "distance from tanh(2^n u0) - 1, n = 1 to 5", "1", worst, 1e-14);
  }
}

TAUT_TRUTH(relative_correction, 1, 4, "sqrt-free / exact correction = 1 + e/(2 + 2e + e^2)",
           "algebra on both forms") {
  const std::string exact = jakobsen(1), approximate = jakobsen(1, "sqrt-free");
  if (!can_run(findings, exact, bare::pair(1, 1))) return;
  findings.below(exact, "sqrt-free / exact correction against 1 + e/(2 + 2e + e^2)", "1",
                 worst_over_strains([&](double e) {
                   const double ratio = (e - projected(approximate, e)) / (e - projected(exact, e));
                   return ratio - (1 + e / (2 + 2 * e + e * e));
                 }),
                 1e-12);  // at e = 1e-3 the strains have three digits fewer
}

TAUT_TRUTH(far_overshoot, 1, 5,
           "at five rest lengths one sqrt-free projection collapses the link to 5/13 r",
           "2 r^2 d/(d^2 + r^2) at d = 5r") {
  for (const std::string& solver : {jakobsen(1, "sqrt-free"), bullet(1)})
    if (can_run(findings, solver, bare::pair(1, 1)))
      findings.equal(solver, "length after one projection from five rest lengths", "r",
                     1 + projected(solver, 4), 5.0 / 13, 1e-15);
}

TAUT_TRUTH(wrong_signs, 1, 6,
           "Vasilovici's printed listing pushes the particles apart in every reading",
           "Vasilovici's second listing, transcribed literally as a test double") {
  const char* const flipped = "printed listing, opposite sign";
  const char* const literal = "printed listing, diff = (d - r)/d";
  double worst_flipped = 0, worst_literal = 0, least_growth = 1e300;
  for (const double e : {-0.5, -0.1, 1e-3, 0.1, 0.5, 1.0, 4.0}) {
    const double s = 2 + 2 * e + e * e;
    const double f = printed_strain(PrintedReading::opposite_sign, e);
    const double l = printed_strain(PrintedReading::literal, e);
    worst_flipped = std::max(worst_flipped, std::abs(f - (4 * e + 5 * e * e + 2 * e * e * e) / s));
    worst_literal = std::max(worst_literal, std::abs(l - (e + e * e * (2 + e) / (2 * s))));
    if (e > 0) least_growth = std::min(least_growth, f / e);
  }
  findings.below(flipped, "distance from (4e + 5e^2 + 2e^3)/(2 + 2e + e^2)", "1", worst_flipped,
                 1e-14);
  findings.below(literal, "distance from e + e^2 (2 + e)/(2 (2 + 2e + e^2)) = e + e^2/2 + ...", "1",
                 worst_literal, 1e-14);
  findings.equal(flipped, "least growth of a stretch per pass", "1", least_growth, 2, 0.01);
  // The corrected form leaves nothing of a stretch of 1 % after three passes; both of these grow.
  double corrected = 0.01, a = 0.01, b = 0.01;
  for (int pass = 0; pass < 10; ++pass) {
    corrected = sqrt_free(corrected);
    a = printed_strain(PrintedReading::opposite_sign, a);
    b = printed_strain(PrintedReading::literal, b);
  }
  findings.below("corrected form", "strain of 1 % after ten passes", "1", std::abs(corrected),
                 1e-15);
  findings.holds(flipped, "diverges: strain of 1 % after ten passes exceeds", a > 10);
  findings.holds(literal, "diverges: strain of 1 % after ten passes exceeds 1 %", b > 0.01);
}

TAUT_TRUTH(mass_weighted, 1, 7,
           "each end moves by its share of the inverse masses; btSoftBody's kLST = 1 is this",
           "Bullet 3.24, PSolve_Links") {
  // Each end moves by its share of the inverse masses; the centre of mass stays.
  for (const std::string& solver : {bullet(1), jakobsen(1, "sqrt-free"), jakobsen(1), xpbd(1)}) {
    if (!can_run(findings, solver, bare::pair(1, 1))) continue;
    double worst = 0;
    for (const double ratio : {1.0, 3.0, 100.0})
      for (const double e : kStrains) {
        Simulation sim(bare::pair(kRest * (1 + e), kRest, 1, ratio), solver);
        const Vec3 start = sim.x(0) + ratio * sim.x(1);
        sim.step();
        worst = std::max(worst, (sim.x(0) + ratio * sim.x(1) - start).norm() / (1 + ratio));
      }
    findings.below(solver, "motion of the centre of mass, mass ratios 1, 3, 100", "m", worst,
                   1e-14);
  }
  const std::string twin = jakobsen(1, "sqrt-free");
  if (!can_run(findings, bullet(1), bare::pair(1, 1))) return;
  findings.below(bullet(1), "distance from our square-root-free projection", "1",
                 worst_over_strains([&](double e) {
                   return projected(bullet(1), e, 1, 3) - projected(twin, e, 1, 3);
                 }),
                 32 * kEpsilon);
}

}  // namespace taut
