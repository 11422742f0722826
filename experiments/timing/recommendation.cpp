#include "experiments/timing/recommendation.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "experiments/timing/cheapest.hpp"

namespace taut {

namespace {

/// Indices of candidates that meet the target, best first.
std::vector<std::size_t> ranking(const std::vector<Candidate>& candidates, const Target& target) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !target.meets(candidates[i]); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return target.prefers(candidates[i], candidates[j]);
  });
  return order;
}

}  // namespace

std::string verdict(const Recommendation& recommendation, const SceneBench& bench) {
  const std::string sure = recommendation.certainty == Certainty::clear ? "clearly " : "likely ";
  if (recommendation.target.budget) return sure + "within the budget";
  if (recommendation.certainty == Certainty::unopposed) return "nothing else timed reaches it";
  const std::string& other = bench.cases[*recommendation.runner_up].record.solver;
  const std::string rest =
      other == bench.cases[*recommendation.best].record.solver ? "the next setting" : other;
  if (recommendation.certainty == Certainty::too_noisy) return "too noisy to compare with " + rest;
  if (recommendation.certainty == Certainty::none)
    return same_within(recommendation.tolerance, *recommendation.ratio)
               ? "costs the same as " + rest + " within " +
                     number_text(100 * recommendation.tolerance) + " %"
               : "not measurably cheaper than " + rest;
  return sure + "cheaper than " + rest;
}

std::string nearest(const SolverRecommendation& solver, const SceneBench& bench,
                    const Recommendation& recommendation, const std::string& metric) {
  const std::string missed = bench.searched_to_the_end(solver.solver)
                                 ? "never, to the end of its accuracy parameters"
                                 : "not by the settings tried";
  const Cell why = why_not(recommendation.target, bench.candidates(metric), metric, solver.solver);
  return missed + (why.note.empty() ? "" : "; " + why.note);
}

std::vector<std::size_t> finalists(const std::vector<Candidate>& tried, const Target& target,
                                   std::size_t most) {
  const std::vector<std::size_t> order = ranking(tried, target);
  std::vector<std::size_t> chosen;
  std::set<std::string> solvers;
  for (const std::size_t i : order)
    if (chosen.size() + 1 < most && solvers.insert(tried[i].solver).second) chosen.push_back(i);
  for (const std::size_t i : order)
    if (chosen.size() < most && std::find(chosen.begin(), chosen.end(), i) == chosen.end())
      chosen.push_back(i);
  return chosen;
}

Recommendation recommend(const SceneBench& bench, const Target& target, const std::string& metric,
                         double tolerance) {
  const JudgedScene scene(bench, metric);
  const std::vector<std::size_t> order = ranking(scene.candidates, target);
  Recommendation recommendation{.target = target, .tolerance = tolerance};
  for (const std::string& solver : solvers_of(bench))
    recommendation.solvers.push_back({solver, scene.best(target, solver), {}});
  if (order.empty()) return recommendation;
  const std::size_t best = order.front();
  recommendation.best = best;
  for (SolverRecommendation& solver : recommendation.solvers)
    if (solver.at) solver.times = bench.ratio(*solver.at, best);
  const auto other = std::find_if(order.begin() + 1, order.end(), [&](std::size_t i) {
    return scene.candidates[i].solver != scene.candidates[best].solver;
  });
  if (order.size() > 1) {
    const Rival rival = scene.beside(other != order.end() ? *other : order[1], best, tolerance);
    recommendation.runner_up = rival.at;
    recommendation.ratio = rival.times;
    if (rival.times) recommendation.certainty = rival.certainty;
  }
  if (target.budget)
    // Errors repeat to the last bit; what is uncertain is whether the budget holds.
    recommendation.certainty =
        scene.candidates[best].cost.high <= *target.budget ? Certainty::clear : Certainty::likely;
  return recommendation;
}

Interval cost_expected_again(const SceneBench& bench, std::size_t at) {
  const double stray = 1 + spread(bench.control);
  const Interval cost = bench.cases[at].cost();
  return {cost.low / stray, cost.mid, cost.high * stray};
}

std::string text(const Target& target, const std::string& metric, double fps) {
  if (target.error) return metric + " <= " + number_text(*target.error, unit_of_value(metric));
  return "least " + metric + " within " + number_text(*target.budget, frame_cost(fps)) + " of 1/" +
         number_text(fps) + " s";
}

Table recommendations(const std::string& metric) {
  return {"recommended",
          "the best for each target, and what the other solvers cost",
          {{"scene"},
           {"target"},
           {"solver"},
           {"setting"},
           {"error", metric, unit_of_value(metric)},
           {"cost", "CPU time", kFrameCost},
           {"times", "times the best"},
           {"answer"}}};
}

void add(Table& table, const Recommendation& recommendation, const SceneBench& bench,
         const std::string& metric) {
  const auto row = [&](const SolverRecommendation& solver, const Cell& times, Cell answer) {
    auto& cells = table.rows.emplace_back(std::vector<Cell>{bench.scene,
                                                            text(recommendation.target, metric),
                                                            solver.solver,
                                                            "",
                                                            {},
                                                            {},
                                                            times,
                                                            answer});
    if (!solver.at) return;
    const BenchedCase& c = bench.cases[*solver.at];
    cells[3] = parse_solver(c.record.spec.solver).brief();
    cells[3].key = c.record.key;
    cells[4] = error_of(c.record, metric);
    cells[5] = c.cost();
  };
  if (recommendation.best)
    row({bench.cases[*recommendation.best].record.solver, recommendation.best, {}}, {},
        verdict(recommendation, bench));
  for (const SolverRecommendation& solver : recommendation.solvers)
    if (!recommendation.best || solver.at != recommendation.best)
      row(solver, solver.times, solver.at ? "" : nearest(solver, bench, recommendation, metric));
}

}  // namespace taut
