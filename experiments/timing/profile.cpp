#include "experiments/timing/profile.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace taut {

namespace {

/// `count` of the candidates, evenly spread and including first and last.
std::vector<Candidate> spread_over(const std::vector<Candidate>& all, std::size_t count) {
  std::vector<Candidate> some;
  for (std::size_t k = 0; k < count; ++k)
    some.push_back(all[count > 1 ? k * (all.size() - 1) / (count - 1) : 0]);
  return some;
}

/// The same number of settings for every solver.
std::vector<Candidate> equal_budgets(const SceneBench& scene, const std::string& metric) {
  std::map<std::string, std::vector<Candidate>> by_solver;
  for (Candidate& one : scene.candidates(metric)) by_solver[one.solver].push_back(std::move(one));
  std::size_t fewest = scene.cases.size();
  for (const auto& [solver, all] : by_solver) fewest = std::min(fewest, all.size());
  std::vector<Candidate> equal;
  for (const auto& [solver, all] : by_solver)
    for (Candidate& one : spread_over(all, fewest)) equal.push_back(std::move(one));
  return equal;
}

}  // namespace

double PerformanceProfile::share(double factor) const {
  if (ratios.empty()) return 0;
  const auto within = std::ranges::count_if(ratios, [&](double r) { return r <= factor; });
  return static_cast<double>(within) / static_cast<double>(ratios.size());
}

std::vector<PerformanceProfile> performance_profiles(const std::vector<SceneBench>& scenes,
                                                     const std::string& metric,
                                                     std::span<const double> levels) {
  std::vector<PerformanceProfile> profiles;
  for (const SceneBench& scene : scenes)
    for (const std::string& solver : solvers_of(scene))
      if (std::ranges::find(profiles, solver, &PerformanceProfile::solver) == profiles.end())
        profiles.push_back({solver, {}});
  for (const SceneBench& scene : scenes) {
    const std::vector<Candidate> tried = equal_budgets(scene, metric);
    for (const double level : levels) {
      const Target target{level, {}};
      const auto best = best_for(target, tried);
      if (!best) continue;
      for (PerformanceProfile& profile : profiles) {
        const auto own = best_for(target, tried, profile.solver);
        profile.ratios.push_back(own ? tried[*own].cost.mid / tried[*best].cost.mid
                                     : std::numeric_limits<double>::infinity());
      }
    }
  }
  return profiles;
}

}  // namespace taut
