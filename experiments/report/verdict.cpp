#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/comparison.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/html.hpp"

namespace taut::report {

namespace {

std::string times(double factor) { return "<b>" + ratio(factor) + " times</b>"; }

std::string plural(int n, const std::string& one) {
  return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

/// Scenes on which one contender has less of a value, with how much less (geometric mean).
struct Wins {
  std::vector<std::string> scenes;
  double logs = 0;
  std::string example;  ///< "ball: 1.2 % against 1.9 %", where it wins most
  double most = 0;
  double factor() const { return std::exp(logs / static_cast<double>(scenes.size())); }
};

/// Residual stretch of two contenders, scene by scene, at the quoted sweeps.
struct Match {
  std::vector<std::string> alike;
  Wins wins[2];

  Match(const Contender& a, const Contender& b, const std::vector<std::string>& scenes,
        int sweeps) {
    for (const std::string& scene : scenes) {
      const auto one = value_at(a, scene, sweeps, "stretch.rms");
      const auto two = value_at(b, scene, sweeps, "stretch.rms");
      if (!one || !two) continue;
      const double quotient = std::max(*two, kNoStretch) / std::max(*one, kNoStretch);
      if (quotient < kAlike && quotient > 1 / kAlike) {
        alike.push_back(scene);
        continue;
      }
      Wins& w = wins[quotient > 1 ? 0 : 1];
      const double by = std::abs(std::log(quotient));
      w.scenes.push_back(scene), w.logs += by;
      if (by <= w.most) continue;
      const Quantity q = quantity("stretch.rms");
      w.most = by;
      w.example = escape_html(scene) + ": " + q.text(std::min(*one, *two)) + " against " +
                  q.text(std::max(*one, *two)) + " RMS";
    }
  }
};

std::string wins_clause(const Wins& wins, const std::string& who) {
  return who + " leaves " + times(wins.factor()) + " less on " + listed(wins.scenes) + " (" +
         wins.example + ")";
}

std::string stretch_sentence(const Comparison& facts, std::size_t i,
                             const std::vector<std::string>& scenes) {
  const std::string who[2] = {solver_name(facts.contenders.front()),
                              solver_name(facts.contenders[i])};
  const Match match(facts.contenders.front(), facts.contenders[i], scenes, facts.sweeps);
  const bool decided = !match.wins[0].scenes.empty() || !match.wins[1].scenes.empty();
  std::string out = "At " + plural(facts.sweeps, "sweep") + " per step ";
  if (!decided && match.alike.empty()) return "";
  if (!decided)
    return out + who[0] + " and " + who[1] + " leave <b>the same stretch</b> on " +
           (match.alike.size() == 1 ? match.alike[0]
                                    : "all " + std::to_string(match.alike.size()) + " scenes");
  if (!match.alike.empty())
    out += who[0] + " and " + who[1] + " leave <b>the same stretch</b> on " + listed(match.alike) +
           "; ";
  bool first = true;
  for (const std::size_t k : {0U, 1U})
    if (!match.wins[k].scenes.empty()) {
      out += (first ? "" : ", ") + wins_clause(match.wins[k], who[k]);
      first = false;
    }
  return out;
}

/// All that can be said without a common number of sweeps.
std::string mean_sentence(const Comparison& facts, std::size_t i) {
  const Ratio& r = *facts.stretch[i];
  const std::string us = solver_name(facts.contenders.front()),
                    them = solver_name(facts.contenders[i]);
  const std::string basis = " (geometric mean over " + plural(r.pairs, "pair") + " of cases)";
  if (r.mean < kAlike && r.mean > 1 / kAlike)
    return us + " and " + them + " leave <b>the same stretch</b>" + basis;
  return (r.mean > 1 ? us : them) + " leaves " + times(std::max(r.mean, 1 / r.mean)) +
         " less stretch than " + (r.mean > 1 ? them : us) + basis;
}

/// How deep cloth of each contender lies inside colliders, where all of them have a value.
std::string depth_sentence(const Comparison& facts, const std::vector<std::string>& scenes) {
  std::vector<double> deepest(facts.contenders.size(), -1);
  std::vector<std::string> where(facts.contenders.size());
  for (const std::string& scene : scenes) {
    std::vector<double> here;
    for (const Contender& c : facts.contenders)
      if (const auto depth = value_at(c, scene, facts.sweeps, "penetration.max"))
        here.push_back(*depth);
    if (here.size() != deepest.size()) continue;
    for (std::size_t k = 0; k < here.size(); ++k)
      if (here[k] > deepest[k]) deepest[k] = here[k], where[k] = scene;
  }
  if (std::ranges::any_of(deepest, [](double d) { return d < 0; })) return "";
  if (std::ranges::all_of(deepest, [](double d) { return d == 0; }))
    return ". No cloth sinks into a collider";
  std::string out;
  for (std::size_t k = 0; k < deepest.size(); ++k)
    out += (k == 0 ? ". " : ", ") + solver_name(facts.contenders[k]) +
           (deepest[k] == 0 ? " keeps all cloth <b>outside</b> the colliders"
                            : " lets it sink <b>" + quantity("penetration.max").text(deepest[k]) +
                                  "</b> deep (" + escape_html(where[k]) + ")");
  return out;
}

/// Time steps that were tried and went well are no limit; only what failed is one.
std::string dt_sentence(const Comparison& facts, const std::vector<std::string>& scenes) {
  const SoundSteps steps = sound_steps(facts, scenes);
  if (steps.dt.size() < 2) return "";
  const Quantity q = quantity("dt");
  const std::string on = " on " + listed(steps.scenes);
  if (steps.no_limit)
    return "; " + std::string(steps.dt.size() == 2 ? "both" : "all") +
           " stay sound at every time step tried, up to " + q.text(steps.dt.front()) + on;
  const std::size_t better = steps.dt[0] >= steps.dt[1] ? 0 : 1;
  const double factor = steps.dt[better] / steps.dt[1 - better];
  if (factor < kAlike) return "; both stay sound at time steps up to " + q.text(steps.dt[0]) + on;
  return "; " + solver_name(facts.contenders[better]) + " stays sound at " + times(factor) +
         " longer time steps" + on + " (" + q.text(steps.dt[better]) + " against " +
         q.text(steps.dt[1 - better]) + ")";
}

std::string cost_sentence(const Comparison& facts) {
  if (facts.cost.size() < 2 || !facts.cost[1]) return "";
  const double r = facts.cost[1]->mean;
  if (r < kAlike && r > 1 / kAlike) return "; a step costs both the same CPU time";
  return "; a step of " + solver_name(facts.contenders[r > 1 ? 0 : 1]) + " costs " +
         times(r > 1 ? r : 1 / r) + " less CPU time";
}

std::string failure_sentence(const Comparison& facts) {
  if (std::ranges::all_of(facts.failed, [](int n) { return n == 0; })) return "No case failed.";
  std::string out = "Failed cases:";
  for (std::size_t i = 0; i < facts.contenders.size(); ++i)
    out += (i > 0 ? ", " : " ") + solver_name(facts.contenders[i]) + " " +
           std::to_string(facts.failed[i]) + " of " + std::to_string(facts.total[i]);
  return out + ".";
}

}  // namespace

std::string verdict(const Comparison& facts, const std::vector<std::string>& scenes) {
  if (facts.contenders.size() < 2)
    return solver_name(facts.contenders.front()) + " ran " + plural(facts.total.front(), "case") +
           " alone: there is nothing to compare it with. " + failure_sentence(facts);
  std::string out;
  for (std::size_t i = 1; i < facts.contenders.size(); ++i) {
    if (!facts.stretch[i]) continue;
    std::string one = stretch_sentence(facts, i, scenes);
    if (one.empty()) one = mean_sentence(facts, i);
    out += (out.empty() ? "" : ". ") + one;
  }
  if (out.empty())
    out =
        std::string(
            "No case ended well for two solvers under equal settings: stretch cannot be compared") +
        (equal_substeps(facts) ? "" : " (their substeps differ; name the same for all)");
  return out + depth_sentence(facts, scenes) + dt_sentence(facts, scenes) + cost_sentence(facts) +
         ". " + failure_sentence(facts);
}

}  // namespace taut::report
