#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/comparison.hpp"
#include "experiments/report/html.hpp"

namespace taut::report {

namespace {

/// One solver's scenes with their factors, all above 1.
struct Cheaper {
  std::vector<std::string> scenes;
  std::vector<Interval> factors;

  void add(const std::string& scene, const Interval& factor) {
    scenes.push_back(scene), factors.push_back(factor);
  }
  std::string clause(const std::string& who, const std::string& than) const {
    const Interval mean = geometric_mean(factors);
    return who + " needs <b>" + ratio(mean.mid) + " times less CPU time</b> than " + than +
           " (95 % interval " + ratio(mean.low) + "–" + ratio(mean.high) + span() + ") on " +
           listed(scenes);
  }
  /// Where the factor is least and largest, if that is worth a word.
  std::string span() const {
    const auto [least, most] = std::ranges::minmax_element(factors, {}, &Interval::mid);
    if (most->mid < 1.5 * least->mid) return "";
    const auto where = [&](auto at) {
      return ratio(at->mid) + " on " +
             escape_html(scenes[static_cast<std::size_t>(at - factors.begin())]);
    };
    return "; from " + where(least) + " to " + where(most);
  }
};

std::string sentence(const Price& price, const std::string& us, const std::string& them) {
  Cheaper ours, theirs;
  std::vector<std::string> even, only_us, only_them, neither, absent;
  for (const ScenePrice& p : price.scenes) {
    if (!p.other_ran) absent.push_back(p.scene);
    if (p.ratio && !p.apart)
      even.push_back(p.scene);
    else if (p.ratio && p.ratio->mid > 1)
      ours.add(p.scene, *p.ratio);
    else if (p.ratio)
      theirs.add(p.scene, {1 / p.ratio->high, 1 / p.ratio->mid, 1 / p.ratio->low});
    else if (p.other_ran)
      (p.first ? only_us : p.other ? only_them : neither).push_back(p.scene);
  }
  if (absent.size() == price.scenes.size()) return "";  // was not in the bench at all
  std::vector<std::string> clauses;
  if (!ours.scenes.empty()) clauses.push_back(ours.clause(us, them));
  if (!theirs.scenes.empty()) clauses.push_back(theirs.clause(them, us));
  if (!even.empty()) clauses.push_back("no difference can be told on " + listed(even));
  if (!only_us.empty()) clauses.push_back("only " + us + " reaches it on " + listed(only_us));
  if (!only_them.empty()) clauses.push_back("only " + them + " reaches it on " + listed(only_them));
  if (!neither.empty()) clauses.push_back("neither reaches it on " + listed(neither));
  if (!absent.empty()) clauses.push_back(them + " cannot run " + listed(absent));
  std::string out;
  for (const std::string& clause : clauses) out += (out.empty() ? "" : "; ") + clause;
  return out;
}

}  // namespace

std::string price_verdict(const Comparison& facts) {
  std::string out;
  double strayed = 0;
  for (std::size_t i = 1; i < facts.contenders.size(); ++i) {
    if (!facts.price[i]) continue;
    const std::string one = sentence(*facts.price[i], solver_name(facts.contenders.front()),
                                     solver_name(facts.contenders[i]));
    if (one.empty()) continue;
    out += (out.empty() ? "" : ". ") + one;
    strayed = std::max(strayed, facts.price[i]->strayed);
  }
  if (out.empty()) return "";
  return "For <b>" + quantity(kPricedMetric).text(kPricedError, 1) + " " +
         quantity(kPricedMetric).title + "</b>, each at the cheapest setting tried, " + out +
         ". <small>The same code timed against itself strayed by up to " +
         significant(100 * strayed, 2) + " %.</small>";
}

}  // namespace taut::report
