#include "experiments/report/price.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/report/format.hpp"

namespace taut::report {

namespace {

ScenePrice price_on(const SceneBench& bench, const std::string& first, const std::string& other) {
  const std::vector<Candidate> candidates = bench.candidates(kPricedMetric);
  ScenePrice price{bench.scene,
                   best_for({kPricedError, {}}, candidates, first),
                   best_for({kPricedError, {}}, candidates, other),
                   std::ranges::find(candidates, other, &Candidate::solver) != candidates.end(),
                   {},
                   false};
  if (price.first && price.other) price.ratio = bench.ratio(*price.other, *price.first);
  price.apart = price.ratio && is_significant(*price.ratio, bench.control);
  return price;
}

}  // namespace

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
    price.strayed = std::max(price.strayed, spread(scene.control));
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
