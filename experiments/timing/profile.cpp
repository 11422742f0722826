#include "experiments/timing/profile.hpp"

#include <algorithm>
#include <limits>

namespace taut {

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
    const std::vector<Candidate> tried = scene.candidates(metric);
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
