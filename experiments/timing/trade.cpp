#include "experiments/timing/trade.hpp"

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

bool counts(const Offer& o, const std::string& solver) {
  return !o.failed && !std::isnan(o.error) && (solver.empty() || o.solver == solver);
}

/// The offer that `before` puts first among those that `admits` lets through.
template <class Admits, class Before>
std::optional<std::size_t> first(std::span<const Offer> offers, Admits admits, Before before) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < offers.size(); ++i)
    if (admits(offers[i]) && (!best || before(offers[i], offers[*best]))) best = i;
  return best;
}

bool cheaper(const Offer& a, const Offer& b) {
  return a.cost.mid != b.cost.mid ? a.cost.mid < b.cost.mid : a.error < b.error;
}

bool closer(const Offer& a, const Offer& b) {
  return a.error != b.error ? a.error < b.error : a.cost.mid < b.cost.mid;
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const Offer> offers) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < offers.size(); ++i)
    if (counts(offers[i], "")) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return cheaper(offers[i], offers[j]); });
  std::vector<std::size_t> front;
  for (const std::size_t i : order)
    if (front.empty() || offers[i].error < offers[front.back()].error) front.push_back(i);
  return front;
}

std::optional<std::size_t> cheapest_within(std::span<const Offer> offers, const std::string& solver,
                                           double level) {
  return first(
      offers, [&](const Offer& o) { return counts(o, solver) && o.error <= level; }, cheaper);
}

std::optional<std::size_t> best_within(std::span<const Offer> offers, const std::string& solver,
                                       double budget) {
  return first(
      offers, [&](const Offer& o) { return counts(o, solver) && o.cost.mid <= budget; }, closer);
}

}  // namespace taut
