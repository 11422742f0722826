#include "experiments/report/price.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/report/format.hpp"

namespace taut::report {

namespace {

constexpr double kTolerance = 0.05;

ScenePrice price_on(const SceneBench& bench, const std::string& first, const std::string& other) {
  const std::vector<Offer> offers = bench.offers(kPricedMetric);
  ScenePrice price{bench.scene,
                   cheapest_within(offers, first, kPricedError),
                   cheapest_within(offers, other, kPricedError),
                   std::ranges::find(offers, other, &Offer::solver) != offers.end(),
                   {},
                   false};
  if (price.first && price.other) price.ratio = bench.ratio(*price.other, *price.first);
  price.apart = price.ratio && told_apart(*price.ratio, bench.control);
  return price;
}

}  // namespace

double strayed(const Interval& control) {
  return std::expm1(std::max(std::abs(std::log(control.low)), std::abs(std::log(control.high))));
}

bool told_apart(const Interval& ratio, const Interval& control) {
  return !ratio.contains(1) &&
         std::abs(std::log(ratio.mid)) > std::log1p(std::max(kTolerance, strayed(control)));
}

Interval geometric_mean(const std::vector<Interval>& ratios) {
  double mid = 0, below = 0, above = 0;
  for (const Interval& r : ratios) {
    mid += std::log(r.mid);
    below += std::pow(std::log(r.mid / r.low), 2);
    above += std::pow(std::log(r.high / r.mid), 2);
  }
  const auto n = static_cast<double>(ratios.size());
  return {std::exp((mid - std::sqrt(below)) / n), std::exp(mid / n),
          std::exp((mid + std::sqrt(above)) / n)};
}

Price compare_price(const BenchSession& bench, const std::string& first, const std::string& other) {
  Price price;
  std::vector<Interval> ratios, ours, theirs;
  for (const SceneBench& scene : bench.scenes) {
    const ScenePrice& here = price.scenes.emplace_back(price_on(scene, first, other));
    price.strayed = std::max(price.strayed, strayed(scene.control));
    if (!here.ratio) continue;
    ratios.push_back(*here.ratio);
    ours.push_back(scene.cases[*here.first].cost());
    theirs.push_back(scene.cases[*here.other].cost());
  }
  if (ratios.empty()) return price;
  price.mean = geometric_mean(ratios);
  price.first_cost = geometric_mean(ours).mid, price.other_cost = geometric_mean(theirs).mid;
  return price;
}

std::string with_interval(const Interval& i, int digits) {
  return significant(i.mid, digits) + " (" + significant(i.low, digits) + "–" +
         significant(i.high, digits) + ")";
}

}  // namespace taut::report
