#include "experiments/timing/cheapest.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace taut {

namespace {

Rival rival_of(const Cost& cost, std::size_t other, const RatioOf& ratio, const Interval& control,
               double tolerance) {
  Rival rival{.at = cost.at, .times = ratio(cost.at, other), .is_bound = cost.is_bound};
  if (rival.times) rival.certainty = judge(*rival.times, control, tolerance);
  return rival;
}

}  // namespace

bool Rival::is_dearer() const {
  return times && times->mid > 1 && !is_bound && is_difference(certainty);
}

bool Cheapest::is_told() const {
  return !rivals.empty() && std::ranges::all_of(rivals, &Rival::is_dearer);
}

Cheapest cheapest_of(std::vector<Cost> costs, const RatioOf& ratio, const Interval& control,
                     double tolerance) {
  assert(!costs.empty());
  std::ranges::stable_sort(costs, {}, &Cost::mid);
  Cheapest found{costs.front().at, {}};
  for (std::size_t i = 1; i < costs.size(); ++i)
    found.rivals.push_back(rival_of(costs[i], found.at, ratio, control, tolerance));
  return found;
}

JudgedScene::JudgedScene(SceneBench scene, const std::string& by)
    : bench(std::move(scene)),
      metric(by.empty() ? bench.deciding_metric() : by),
      candidates(bench.candidates(metric)) {}

bool JudgedScene::has(const std::string& solver) const {
  return std::ranges::find(candidates, solver, &Candidate::solver) != candidates.end();
}

std::optional<std::size_t> JudgedScene::best(const Target& target,
                                             const std::string& solver) const {
  return best_for(target, candidates, solver);
}

std::vector<std::size_t> JudgedScene::best_of_each(const Target& target) const {
  std::vector<std::size_t> all;
  for (const std::string& solver : solvers_of(bench))
    if (const auto at = best(target, solver)) all.push_back(*at);
  return all;
}

Cell JudgedScene::why_not(const Target& target, const std::string& solver) const {
  return taut::why_not(target, candidates, metric, solver);
}

bool JudgedScene::is_upper_bound(std::size_t at) const {
  const auto work = [&](std::size_t i) {
    const Record& r = bench.cases[i].record;
    return std::max(1, r.substeps) * std::max(1, r.sweeps);
  };
  if (work(at) == 1) return false;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].solver != candidates[at].solver) continue;
    const bool timed = bench.cases[i].stable();  // one of less work may have failed
    if (work(i) < work(at) || (timed && candidates[i].cost.mid < candidates[at].cost.mid))
      return false;
  }
  return true;
}

Rival JudgedScene::beside(std::size_t at, std::size_t other, double tolerance) const {
  return rival_of(
      {at, candidates[at].cost.mid, is_upper_bound(at)}, other,
      [&](std::size_t i, std::size_t j) { return bench.ratio(i, j); }, bench.control, tolerance);
}

Cheapest JudgedScene::cheapest(const std::vector<std::size_t>& cases) const {
  std::vector<Cost> costs;
  for (const std::size_t at : cases)
    costs.push_back({at, candidates[at].cost.mid, is_upper_bound(at)});
  return cheapest_of(
      std::move(costs), [&](std::size_t i, std::size_t j) { return bench.ratio(i, j); },
      bench.control);
}

}  // namespace taut
