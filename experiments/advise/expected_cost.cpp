#include "experiments/advise/expected_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/model/solver.hpp"
#include "experiments/case/case.hpp"
#include "experiments/timing/search.hpp"
#include "experiments/timing/statistics.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// CPU s per simulated s of each solver's cheapest timed case on the scene.
std::map<std::string, double> last_known(const std::string& scene, const Store& store) {
  std::map<std::string, double> costs;
  for (const StudyBench& bench : stored_benches(store, ""))
    for (const SceneBench& session : bench.scenes)
      for (const BenchedCase& c : session.cases) {
        if (c.record.scene != scene || !c.stable()) continue;
        const double cost = median(c.timing.samples) / c.record.dt;
        const auto [at, fresh] = costs.try_emplace(c.record.solver, cost);
        at->second = std::min(at->second, cost);
      }
  return costs;
}

/// Number of items that the passes visit per simulated second.
double items_of(const Case& one) {
  double items = 0;
  for (const PassCost& pass : one.choice.entry->make(*one.scene, one.choice.params)->step_cost())
    items += static_cast<double>(pass.items * pass.repeats);
  return items / one.scene->dt;
}

}  // namespace

std::vector<std::string> by_expected_cost(std::vector<std::string> solvers,
                                          const std::string& scene, const SceneSettings& settings,
                                          const Store& store) {
  std::map<std::string, double> items, expected;
  std::map<std::string, std::string> name_of;
  std::string name = scene;
  CaseMaker maker;
  for (const std::string& solver : solvers) try {
      items[solver] = kUnknown;
      const Case one = maker.make({scene, settings, cheapest_setting(solver)});
      name = one.scene->name;
      name_of[solver] = one.choice.entry->name;
      items[solver] = items_of(one);
    } catch (const std::runtime_error&) {
      // an external program would have to be run
    }
  const std::map<std::string, double> known = last_known(name, store);
  std::vector<double> costs_per_item;  // s, of the timed solvers
  for (const auto& [solver, n] : items)
    if (const auto cost = known.find(name_of[solver]); cost != known.end() && n < kUnknown)
      costs_per_item.push_back(cost->second / n);
  const double cost_per_item = costs_per_item.empty() ? 1 : median(costs_per_item);
  for (const std::string& solver : solvers) {
    const auto cost = known.find(name_of[solver]);
    expected[solver] = cost != known.end() ? cost->second : cost_per_item * items[solver];
  }
  std::ranges::stable_sort(solvers, {}, [&](const std::string& one) { return expected.at(one); });
  return solvers;
}

std::string so_far(const std::string& best, std::size_t not_tried, std::size_t cut_short) {
  const auto solvers = [](std::size_t n) {
    return std::to_string(n) + (n == 1 ? " solver" : " solvers");
  };
  std::string text = best + " so far; ";
  if (not_tried > 0) text += solvers(not_tried) + " not tried" + (cut_short > 0 ? ", " : "");
  if (cut_short > 0) text += solvers(cut_short) + " not searched to the end";
  return text;
}

}  // namespace taut
