#include "experiments/timing/advice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace taut {

namespace {

/// Indices of offers that grant the wish, best first.
std::vector<std::size_t> ranking(const std::vector<Offer>& offers, const Wish& wish) {
  std::vector<std::size_t> order(offers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !wish.grants(offers[i]); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return wish.prefers(offers[i], offers[j]);
  });
  return order;
}

Certainty certainty_of_cost(const Interval& ratio, const Interval& control, double tolerance) {
  if (ratio.low <= 1) return Certainty::a_tie;
  return judge(ratio, control, tolerance) == Judgement::slower ? Certainty::clear
                                                               : Certainty::likely;
}

}  // namespace

std::string_view to_string(Certainty certainty) {
  switch (certainty) {
    case Certainty::clear:
      return "clear";
    case Certainty::likely:
      return "likely";
    case Certainty::a_tie:
      return "a tie";
    case Certainty::unopposed:
      return "unopposed";
  }
  return "";
}

std::vector<std::size_t> finalists(const std::vector<Offer>& tried, const Wish& wish,
                                   std::size_t most) {
  const std::vector<std::size_t> order = ranking(tried, wish);
  std::vector<std::size_t> chosen;
  std::set<std::string> solvers;
  for (const std::size_t i : order)
    if (chosen.size() + 1 < most && solvers.insert(tried[i].solver).second) chosen.push_back(i);
  for (const std::size_t i : order)
    if (chosen.size() < most && std::find(chosen.begin(), chosen.end(), i) == chosen.end())
      chosen.push_back(i);
  return chosen;
}

Advice judge_finalists(const SceneBench& bench, const Wish& wish, const std::string& metric,
                       double tolerance) {
  const std::vector<Offer> offers = bench.offers(metric);
  const std::vector<std::size_t> order = ranking(offers, wish);
  Advice advice;
  if (order.empty()) return advice;
  advice.best = order.front();
  const auto rival = std::find_if(order.begin() + 1, order.end(), [&](std::size_t i) {
    return offers[i].solver != offers[*advice.best].solver;
  });
  if (rival != order.end())
    advice.runner_up = *rival;
  else if (order.size() > 1)
    advice.runner_up = order[1];
  if (advice.runner_up) advice.ratio = bench.ratio(*advice.runner_up, *advice.best);
  if (wish.budget)
    // Errors repeat to the last bit; what is uncertain is whether the budget holds.
    advice.certainty =
        offers[*advice.best].cost.high <= *wish.budget ? Certainty::clear : Certainty::likely;
  else if (advice.ratio)
    advice.certainty = certainty_of_cost(*advice.ratio, bench.control, tolerance);
  return advice;
}

}  // namespace taut
