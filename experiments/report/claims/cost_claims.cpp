#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/model/text.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

/// A ratio of costs on one scene, of two cases.
struct SceneRatio {
  std::string scene;
  Interval ratio;  ///< cost of ours over that of theirs
  Interval control;
  Interval ours = {}, theirs = {};  ///< costs
};

/// A scene's cases with their costs and errors: an interval is a bootstrap, made once.
struct Timed {
  const SceneBench& bench;
  std::vector<Candidate> candidates = bench.candidates(kErrorMetric);
};

/// Two solvers by whose costs a claim is made.
struct Pair {
  std::string first, other;              ///< entries' names
  std::string first_label, other_label;  ///< "Jakobsen"
};

using Admits = std::function<bool(const BenchedCase&)>;

std::map<std::string, std::string> params_of(const SceneBench& scene, const std::string& solver) {
  for (const BenchedCase& c : scene.cases)
    if (c.record.solver == solver) return c.record.params;
  return {};
}

/// Only what both have: no parameter that the other one lacks.
Admits shared_parameters(const SceneBench& scene, const Pair& pair) {
  const auto ours = params_of(scene, pair.first), theirs = params_of(scene, pair.other);
  return [ours, theirs, pair](const BenchedCase& c) {
    return extras(c.record, c.record.solver == pair.first ? theirs : ours).empty();
  };
}

/// The cheapest admitted case of `solver` that reaches the error; nothing: none does.
std::optional<std::size_t> cheapest(const Timed& scene, const std::string& solver,
                                    const Admits& admits) {
  std::vector<Candidate> candidates = scene.candidates;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!admits(scene.bench.cases[i])) candidates[i].failure = "not admitted";
  return best_for({.error = kPricedError}, candidates, solver);
}

bool timed(const Timed& scene, const std::string& solver) {
  return std::ranges::find(scene.candidates, solver, &Candidate::solver) != scene.candidates.end();
}

void look_at(Evidence& evidence, const Timed& scene, const Pair& pair, const Admits& admits) {
  for (std::size_t i = 0; i < scene.candidates.size(); ++i) {
    const BenchedCase& c = scene.bench.cases[i];
    if (admits(c) && (c.record.solver == pair.first || c.record.solver == pair.other))
      evidence.look(c, scene.candidates[i].cost,
                    c.record.solver == pair.first ? pair.first_label : pair.other_label);
  }
}

std::string ratio_text(const Interval& r) {
  return fixed(r.mid, 2) + ", 95\u00A0% interval " + fixed(r.low, 2) + " to " + fixed(r.high, 2);
}

Interval inverse(const Interval& r) { return {1 / r.high, 1 / r.mid, 1 / r.low}; }

/// Why a solver's cases do not reach the level: the search went to the end, or it did not.
std::string not_reached(const SceneBench& scene, const std::string& solver,
                        const std::string& label) {
  return scene.searched_to_the_end(solver)
             ? "Never reached by " + label + ", tried to the end of its accuracy parameters"
             : "Reached by no setting tried of " + label;
}

/// "Two runs of identical code differed by up to 3 %."
std::string noise_text(double noise) {
  return " Two runs of identical code differed by up to " + shown(kShare, noise) + ".";
}

/// Of two that were judged; where there is no difference nothing was.
Certainty less_sure(Certainty a, Certainty b) {
  return a == Certainty::none ? b : b == Certainty::none ? a : std::max(a, b);
}

/// The mean over scenes, who is cheaper where, and how sure all that is.
struct Verdicts {
  std::string text;
  Certainty sure = Certainty::none;  ///< the least sure of all that was judged
  std::vector<std::string> strong;   ///< the factor, if there is a difference
};

Verdicts judge_all(const std::vector<SceneRatio>& ratios, const Pair& pair) {
  std::vector<std::string> ours, theirs, even, noisy, names;
  std::vector<Interval> all;
  Verdicts verdicts;
  double noise = 0;
  const auto sure = [&](Certainty s) { verdicts.sure = less_sure(verdicts.sure, s); };
  for (const SceneRatio& r : ratios) {
    all.push_back(r.ratio), names.push_back(r.scene);
    noise = std::max(noise, spread(r.control));
    const Certainty judged = judge(r.ratio, r.control);
    sure(judged);
    (judged == Certainty::none        ? even
     : judged == Certainty::too_noisy ? noisy
     : r.ratio.mid < 1                ? ours
                                      : theirs)
        .push_back(r.scene);
  }
  const Interval mean = geometric_mean(all), control{1 / (1 + noise), 1, 1 + noise};
  const Certainty judged = judge(mean, control);
  sure(judged);
  const std::string over = "; geometric mean over " + joined(names) + ")";
  if (is_difference(judged)) {
    const bool less = mean.mid < 1;
    const Interval share = less ? mean : inverse(mean);
    verdicts.strong = {share_text(share.mid) + " of the CPU time"};
    verdicts.text = (less ? pair.first_label : pair.other_label) + " uses " +
                    verdicts.strong.front() + " of " +
                    (less ? pair.other_label : pair.first_label) + " (95\u00A0% interval " +
                    share_text(share.low) + " to " + share_text(share.high) + over + ".";
  } else {
    verdicts.text = undecided(judged) + " (" + pair.first_label + " over " + pair.other_label +
                    " " + ratio_text(mean) + over + ".";
  }
  verdicts.text += sentence_if(" Less with " + pair.first_label + " on ", ours) +
                   sentence_if(" Less with " + pair.other_label + " on ", theirs) +
                   sentence_if(" No difference that can be told on ", even) +
                   sentence_if(" Too noisy to judge on ", noisy) + noise_text(noise);
  return verdicts;
}

/// The priced error, each at the cheapest setting tried with what both have.
void claim_price(const std::vector<Timed>& scenes, const Pair& pair, bool with_tile,
                 std::vector<Claim>& claims) {
  const Quantity q = quantity(kErrorMetric);
  const std::string level = q.text(kPricedError, 1) + " " + q.title;
  Evidence evidence("cpu.per_second", "cheapest case that reaches " + level +
                                          "; geometric mean of the interleaved ratios over scenes");
  std::vector<SceneRatio> ratios;
  std::vector<std::string> absent;
  std::map<std::string, std::vector<std::string>> missed;  // scenes, by how a solver missed it
  for (const Timed& scene : scenes) {
    const SceneBench& bench = scene.bench;
    if (!timed(scene, pair.first)) continue;
    if (!timed(scene, pair.other)) {
      absent.push_back(bench.scene);
      continue;
    }
    const Admits shared = shared_parameters(bench, pair);
    look_at(evidence, scene, pair, shared);
    const auto ours = cheapest(scene, pair.first, shared);
    const auto theirs = cheapest(scene, pair.other, shared);
    if (ours && theirs)
      ratios.push_back({bench.scene, *bench.ratio(*ours, *theirs), bench.control,
                        scene.candidates[*ours].cost, scene.candidates[*theirs].cost});
    else if (ours)
      missed[not_reached(bench, pair.other, pair.other_label) + ", but by " + pair.first_label]
          .push_back(bench.scene);
    else if (theirs)
      missed[not_reached(bench, pair.first, pair.first_label) + ", but by " + pair.other_label]
          .push_back(bench.scene);
    else
      missed["Reached by no setting tried"].push_back(bench.scene);
  }
  if (evidence.seen().empty()) return;
  const std::string opening = "For " + level +
                              " in the last second, each at the cheapest setting tried with what "
                              "both have: ";
  std::string rest;
  for (const auto& [how, names] : missed) rest += sentence_if(" " + how + " on ", names);
  rest += sentence_if(" Not timed with " + pair.other_label + " on ", absent);
  const std::string id = "cost-" + pair.other;
  if (ratios.empty()) {
    claims.emplace_back(id, ClaimKind::headline, "cost",
                        opening + "no scene where both reach it." + rest, Certainty::single_run,
                        std::vector{evidence});
    return;
  }
  const Verdicts verdicts = judge_all(ratios, pair);
  std::vector<Interval> costs[2];
  std::vector<std::string> names;
  for (const SceneRatio& r : ratios)
    costs[0].push_back(r.ours), costs[1].push_back(r.theirs), names.push_back(r.scene);
  std::vector<Bar> bars;
  std::vector<std::string> parts;
  const Quantity cpu = quantity("cpu.per_second");
  for (const std::size_t k : {0U, 1U}) {
    const Interval mean = geometric_mean(costs[k]);
    const std::string& label = k == 0 ? pair.first_label : pair.other_label;
    bars.push_back({k == 0 ? pair.first : pair.other, label, mean.mid, mean, cpu.text(mean.mid)});
    parts.push_back(label + " " + cpu.text(mean.mid));
  }
  Claim claim(
      id, ClaimKind::headline, "cost",
      opening + verdicts.text + rest + " CPU time per simulated second: " + joined(parts) + ".",
      verdicts.sure, {evidence});
  claim.strong = verdicts.strong;
  claims.push_back(claim);
  if (with_tile)
    claims.push_back(claim.tile("CPU time for " + level,
                                "Per simulated second, each at the cheapest setting tried with "
                                "what both have, geometric mean over " +
                                    joined(names) + ".",
                                bars));
}

/// A step of the same substeps and sweeps.
void claim_same_work(const std::vector<Timed>& scenes, const Pair& pair,
                     std::vector<Claim>& claims) {
  Evidence evidence("cpu.per_step",
                    "cheapest case of each solver at the same substeps and sweeps; geometric mean "
                    "over these, then over scenes");
  std::vector<SceneRatio> means;
  std::set<Work> works;
  for (const auto& [scene, candidates] : scenes) {
    const Admits shared = shared_parameters(scene, pair);
    std::map<Work, std::pair<std::optional<std::size_t>, std::optional<std::size_t>>> cheapest;
    for (std::size_t i = 0; i < scene.cases.size(); ++i) {
      const BenchedCase& c = scene.cases[i];
      const Work work = work_of(c.record);
      if (!c.stable() || !shared(c) || work.sweeps < 0 || work.substeps < 0) continue;
      if (c.record.solver != pair.first && c.record.solver != pair.other) continue;
      auto& at = c.record.solver == pair.first ? cheapest[work].first : cheapest[work].second;
      if (!at || candidates[i].cost.mid < candidates[*at].cost.mid) at = i;
    }
    std::vector<Interval> ratios;
    for (const auto& [work, both] : cheapest) {
      if (!both.first || !both.second) continue;
      const BenchedCase &ours = scene.cases[*both.first], &theirs = scene.cases[*both.second];
      if (ours.record.dt != theirs.record.dt) continue;
      evidence.look(ours, candidates[*both.first].cost, pair.first_label);
      evidence.look(theirs, candidates[*both.second].cost, pair.other_label);
      ratios.push_back(*scene.ratio(*both.first, *both.second));
      works.insert(work);
    }
    if (!ratios.empty()) means.push_back({scene.scene, geometric_mean(ratios), scene.control});
  }
  if (means.empty()) return;
  std::vector<std::string> names;
  for (const Work& work : works) names.push_back(work.text());
  const Verdicts verdicts = judge_all(means, pair);
  Claim claim("work-" + pair.other, ClaimKind::headline, "cost",
              "For a step of the same substeps × sweeps (" + joined(names) + "): " + verdicts.text,
              verdicts.sure, {evidence});
  claim.strong = verdicts.strong;
  claims.push_back(claim);
}

/// What a solver gains by a parameter that the other one lacks, said apart.
void claim_extras(const std::vector<Timed>& timed_scenes, const Pair& pair,
                  std::vector<Claim>& claims) {
  const Quantity q = quantity(kErrorMetric), cpu = quantity("cpu.per_second");
  Evidence evidence("cpu.per_second", "cheapest case that reaches the level, with and without");
  std::vector<std::string> clauses, missed;
  std::set<std::string> parameters;
  std::optional<Certainty> sure;
  double noise = 0;
  for (const Timed& timed_scene : timed_scenes) {
    if (!timed(timed_scene, pair.other)) continue;
    const auto& [scene, candidates] = timed_scene;
    const auto theirs = params_of(scene, pair.other);
    const Admits shared = shared_parameters(scene, pair);
    const auto used = [&](const BenchedCase& c) { return extras(c.record, theirs); };
    const auto with =
        cheapest(timed_scene, pair.first, [&](const auto& c) { return !used(c).empty(); });
    const auto without = cheapest(timed_scene, pair.first, shared);
    if (!with) {
      if (std::ranges::any_of(scene.cases, [&](const BenchedCase& c) {
            return c.record.solver == pair.first && !used(c).empty();
          }))
        missed.push_back(scene.scene);
      continue;
    }
    noise = std::max(noise, spread(scene.control));
    for (const std::string& name : used(scene.cases[*with])) parameters.insert(name);
    const Interval& cost = candidates[*with].cost;
    evidence.look(scene.cases[*with], cost, pair.first_label + " with");
    std::string text = "on " + scene.scene + " " + cpu.text(cost.mid);
    if (without) {
      evidence.look(scene.cases[*without], candidates[*without].cost,
                    pair.first_label + " without");
      const Interval ratio = *scene.ratio(*with, *without);
      const Certainty judged = judge(ratio, scene.control);
      sure = less_sure(sure.value_or(Certainty::none), judged);
      text += !is_difference(judged)
                  ? (judged == Certainty::too_noisy ? ", too noisy to be told from without ("
                                                    : ", not to be told apart from without (") +
                        ratio_text(ratio) + ")"
              : ratio.mid < 1 ? ", " + share_text(ratio.mid) + " of without"
                              : ", more than without";
    } else {
      text += ", without not reached by the settings tried";
    }
    clauses.push_back(text);
  }
  if (clauses.empty()) return;
  std::string text = join(clauses, "; ");
  if (!missed.empty()) text += "; not reached by the settings tried on " + joined(missed);
  claims.emplace_back(
      "only-" + pair.first + "-" + pair.other, ClaimKind::note, "only",
      "With " + joined({parameters.begin(), parameters.end()}) + ", which " + pair.other_label +
          " does not have, " + pair.first_label + " reaches " + q.text(kPricedError, 1) + " " +
          q.title + " for this CPU time per simulated second: " + text + "." + noise_text(noise),
      sure.value_or(Certainty::single_run), std::vector{evidence});
}

}  // namespace

std::vector<Claim> cost_claims(const ReportInput& input) {
  std::vector<Claim> claims;
  if (!input.bench) return claims;
  std::vector<std::string> names;
  std::vector<Timed> scenes;
  for (const SceneBench& scene : input.bench->scenes) {
    scenes.push_back({scene});
    for (const std::string& solver : solvers_of(scene)) push_unique(names, solver);
  }
  if (names.empty()) return claims;  // nothing was timed
  const std::string first = names.front();
  for (const std::string& other : names) {
    if (other == first) continue;
    const Pair pair{first, other, solver_title(first), solver_title(other)};
    claim_same_work(scenes, pair, claims);
    claim_price(scenes, pair, names.size() == 2, claims);
    claim_extras(scenes, pair, claims);
    claim_extras(scenes, {other, first, pair.other_label, pair.first_label}, claims);
  }
  return claims;
}

}  // namespace taut::report
