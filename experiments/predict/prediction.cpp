#include "experiments/predict/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/model/text.hpp"

namespace taut {

namespace {

using reference::StrainAtRest;

/// Steps of a timing: at least kFewest, and until they have taken this long [s].
constexpr double kTimed = 5e-3;
constexpr int kFewest = 3, kMost = 64;
constexpr double kMostWork = 1e6;  ///< sweeps or substeps that are tried

/// The least CPU time [s] of the first steps but one, which warms the caches.
double cpu_of_step(const Scene& scene, const SolverChoice& choice) {
  const std::unique_ptr<Solver> solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  double least = std::numeric_limits<double>::infinity(), all = 0;
  for (int n = 0; n <= kMost && (n <= kFewest || all < kTimed); ++n) {
    const double before = solver->cpu_seconds();
    solver->step(n * scene.dt, scene.dt);
    const double spent = solver->cpu_seconds() - before;
    all += spent;
    if (n > 0) least = std::min(least, spent);
  }
  return least;
}

/// The sweeps or the substeps of a setting.
struct Work {
  bool of_substeps;
  std::string_view parameter(const SolverChoice& choice) const {
    return of_substeps ? choice.entry->accuracy.substeps : choice.entry->accuracy.sweeps;
  }
  int now(const SolverChoice& choice) const {
    return of_substeps ? choice.substeps() : choice.sweeps();
  }
  StrainAtRest::Strain strain(StrainAtRest& law, const SolverChoice& choice, double n) const {
    return of_substeps ? law.at(choice.sweeps(), n) : law.at(n, choice.substeps());
  }
  /// n such that the RMS strain, which falls with n or with its square, is this; nothing: not even
  /// with kMostWork, or the law has no such strain.
  std::optional<double> with(StrainAtRest& law, const SolverChoice& choice, double rms) const {
    const double power = of_substeps ? 2 : 1;
    double n = now(choice);
    for (int round = 0; round < 40; ++round) {
      const StrainAtRest::Strain here = strain(law, choice, n);
      if (!here.found || !(here.rms > 0)) return {};
      const double ratio = here.rms / rms;
      if (std::abs(ratio - 1) < 1e-3) return n;
      if (n <= 1 && ratio < 1) return 1;
      n = std::clamp(n * std::pow(ratio, 1 / power), 1.0, kMostWork);
      if (n == kMostWork) return {};
    }
    return {};
  }
};

SolverChoice with(const SolverChoice& choice, const Work& work, double n) {
  return choice.with(work.parameter(choice), std::to_string(std::lround(n)));
}

/// Fills in everything but what is known already.
PredictedStrain complete(const Scene& scene, StrainAtRest& law, PredictedStrain one,
                         bool as_stiffness) {
  const int substeps = one.choice.substeps();
  one.correction = law.correction();
  one.strain = law.at(one.choice.sweeps(), substeps);
  one.refused = law.outside(one.strain, substeps);
  if (!one.refused.empty()) return one;
  if (std::isnan(one.cpu)) one.cpu = cpu_of_step(scene, one.choice);
  if (as_stiffness) one.stiffness = law.stiffness_of(one.strain);
  return one;
}

/// With three digits.
std::string percent(double share) {
  if (!(share > 0)) return shortest(share);
  const double scale = std::pow(10, 2 - std::floor(std::log10(100 * share)));
  return shortest(std::round(100 * share * scale) / scale) + " %";
}

/// The sweeps or substeps that have this strain: the fewest that are below it, or the nearest.
PredictedStrain with_strain(StrainAtRest& law, const SolverChoice& choice, const Work& work,
                            double rms, bool nearest) {
  PredictedStrain one{.choice = choice, .found = std::string(work.parameter(choice))};
  const std::optional<double> n = work.with(law, choice, rms);
  if (!n) {
    one.refused = {"no " + one.found + " up to " + shortest(kMostWork) + " have a strain of " +
                   percent(rms)};
    return one;
  }
  double whole = std::max(1.0, nearest ? std::round(*n) : std::ceil(*n * (1 - 2e-3)));
  // the search ends near the strain; a fewest has to be below it
  while (!nearest && whole < kMostWork && work.strain(law, choice, whole).rms > rms) ++whole;
  one.choice = with(choice, work, whole);
  return one;
}

/// The most sweeps or substeps that the budget allows: from the time of two numbers of them, then
/// fewer until it is kept.
PredictedStrain within(const Scene& scene, const SolverChoice& choice, const Work& work,
                       double cpu) {
  PredictedStrain one{.choice = choice, .found = std::string(work.parameter(choice))};
  constexpr double kFew = 1, kMore = 9;
  const double few = cpu_of_step(scene, with(choice, work, kFew)),
               more = cpu_of_step(scene, with(choice, work, kMore));
  if (few > cpu) {
    one.refused = {"one of its " + one.found + " costs more than the budget"};
    return one;
  }
  const double each = std::max((more - few) / (kMore - kFew), few / 1000);
  double n = std::clamp(std::floor(kFew + (cpu - few) / each), 1.0, kMostWork);
  for (int round = 0; round < 8; ++round) {
    one.choice = with(choice, work, n);
    one.cpu = n > 1 ? cpu_of_step(scene, one.choice) : few;
    if (one.cpu <= cpu || n == 1) break;
    n = std::max(1.0, std::min(n - 1, std::floor(n * cpu / one.cpu)));
  }
  return one;
}

}  // namespace

std::vector<PredictedStrain> predict(const Scene& scene, const SolverChoice& choice,
                                     const PredictionWanted& wanted) {
  PredictedStrain plain{.choice = choice};
  plain.refused = StrainAtRest::refuse(scene, choice);
  if (!plain.refused.empty()) return {plain};
  StrainAtRest law(scene, choice);
  if (std::isnan(law.correction())) {
    plain.refused = law.outside({}, 1);
    return {plain};
  }
  double like_springs = 0;
  if (wanted.stiffness) {
    const StrainAtRest::Strain strain = law.of_springs(*wanted.stiffness);
    like_springs = strain.rms;
    if (!strain.found || !(like_springs > 0) || !std::isfinite(like_springs)) {
      plain.refused = {"no rest was found for links of " + shortest(*wanted.stiffness) + " N/m"};
      return {plain};
    }
  }
  std::vector<PredictedStrain> all;
  for (const bool of_substeps : {false, true}) {
    const Work work{of_substeps};
    if (wanted.error)
      all.push_back(with_strain(law, choice, work, *wanted.error, false));
    else if (wanted.stiffness)
      all.push_back(with_strain(law, choice, work, like_springs, true));
    else if (wanted.budget)
      all.push_back(within(scene, choice, work, *wanted.budget));
    else if (all.empty())
      all.push_back(plain);
  }
  for (PredictedStrain& one : all)
    if (one.refused.empty()) one = complete(scene, law, std::move(one), wanted.as_stiffness);
  return all;
}

}  // namespace taut
