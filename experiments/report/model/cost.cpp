#include <limits>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/timing/profile.hpp"
#include "experiments/timing/recommendation.hpp"

namespace taut::report {

namespace {

/// "1.23 ms (1.20–1.26)", with as many decimals as its width lets matter.
std::string with_interval(const Interval& i, double scale, const std::string& unit) {
  const int decimals = decimals_for((i.high - i.low) * scale);
  const auto number = [&](double v) { return fixed(v * scale, decimals); };
  return number(i.mid) + unit + " (" + number(i.low) + "–" + number(i.high) + ")";
}
std::string milliseconds(const Interval& seconds, double scale = 1e3) {
  return with_interval(seconds, scale, "\u00A0ms");
}

/// Settings of one solver on one scene that a table speaks of.
struct CostScene {
  const SceneBench& bench;
  const std::vector<Record>& records;
  Citations& refs;

  std::string setting(std::size_t at) const {
    const std::string label = SettingLabels(records).of(bench.cases[at].record);
    return label.empty() ? work_of(bench.cases[at].record).text() : label;
  }
  Json cell(std::size_t at, const std::string& text) const {
    const BenchedCase& c = bench.cases[at];
    const Interval cost = c.cost();
    return {{"text", text},
            {"value", cost.mid},
            {"low", cost.low},
            {"high", cost.high},
            {"case", refs.key(c.record)}};
  }
  /// "share of the way travelled 98 %": what a small strain may have cost.
  std::string motion(std::size_t at) const {
    std::string text;
    for (const ValueSpec* value : values_with_role())
      if (value->role == Role::motion)
        if (const double v = value_of(bench.cases[at].record, std::string(value->name));
            std::isfinite(v))
          text += (text.empty() ? "" : ", ") + quantity(std::string(value->name)).title + " " +
                  quantity(std::string(value->name)).text(v);
    return text;
  }
  /// "not reached by the settings tried (at best 0.12 %)".
  std::string missed(const std::string& solver) const {
    const std::vector<Candidate> candidates = bench.candidates(kErrorMetric);
    const auto nearest =
        best_for({.budget = std::numeric_limits<double>::infinity()}, candidates, solver);
    if (!nearest) return "no case completed";
    return std::string(bench.searched_to_the_end(solver)
                           ? "never reached, to the end of its accuracy parameters"
                           : "not reached by the settings tried") +
           " (at best " + quantity(kErrorMetric).text(candidates[*nearest].error) + ")";
  }
};

/// How a solver's cheapest compares with the cheapest of all.
std::string ratio_note(const Interval& times, Certainty sure) {
  return with_interval(times, 1, " × the cheapest") +
         (is_difference(sure) ? "" : ", " + undecided(sure));
}

/// Columns of a table: the first, then the metric of every solver.
Json solver_columns(const SceneBench& scene, Json first, const std::string& metric) {
  Json columns;
  columns.push_back(std::move(first));
  for (const std::string& solver : solvers_of(scene))
    columns.push_back({{"title", solver_title(solver)}, {"metric", metric}});
  return columns;
}

/// Without the cases that use a parameter which another solver of the scene lacks: a table compares
/// what all have, what only one has is said apart.
SceneBench with_shared_parameters(SceneBench bench) {
  std::map<std::string, std::map<std::string, std::string>> params;
  for (const BenchedCase& c : bench.cases) params[c.record.solver] = c.record.params;
  std::erase_if(bench.cases, [&](const BenchedCase& c) {
    return std::ranges::any_of(params, [&](const auto& other) {
      return other.first != c.record.solver && !extras(c.record, other.second).empty();
    });
  });
  return bench;
}

Json levels_table(const CostScene& scene) {
  const Quantity q = quantity(kErrorMetric);
  Json table = json_table(
      "cost-levels-" + slug(scene.bench.scene), "Cost of an error",
      "CPU time per simulated second, its 95 % interval, and the setting: the cheapest that was "
      "tried, with what all solvers of the scene have.",
      solver_columns(scene.bench, {{"title", "to reach"}, {"metric", kErrorMetric}},
                     "cpu.per_second"));
  for (const double level : kErrorLevels) {
    Json row = Json::array();
    row.push_back({{"text", q.text(level, 1)}, {"value", level}});
    for (const SolverRecommendation& r :
         recommend(scene.bench, {.error = level}, kErrorMetric).solvers) {
      if (!r.at) {
        row.push_back(scene.missed(r.solver));
        continue;
      }
      Json cell = scene.cell(
          *r.at, milliseconds(scene.bench.cases[*r.at].cost()) + ", " + scene.setting(*r.at));
      std::string note = scene.motion(*r.at);
      if (r.times && r.times->mid > 1) {
        const Certainty sure = judge(*r.times, scene.bench.control);
        note = ratio_note(*r.times, sure) + (note.empty() ? "" : "; ") + note;
        if (sure != Certainty::none) cell["sure"] = to_string(sure);
      }
      if (!note.empty()) cell["note"] = note;
      row.push_back(std::move(cell));
    }
    table["rows"].push_back(std::move(row));
  }
  return table;
}

Json budgets_table(const CostScene& scene) {
  const Quantity q = quantity(kErrorMetric);
  Json table = json_table(
      "cost-budgets-" + slug(scene.bench.scene), "Error within a budget",
      "The least error within a budget of CPU time per frame of 1/60 s, what it costs and with "
      "which setting, of those that were tried with what all solvers have.",
      solver_columns(scene.bench, {{"title", "within, per frame"}}, kErrorMetric));
  const std::vector<Candidate> candidates = scene.bench.candidates(kErrorMetric);
  for (const double budget : kFrameBudgets) {
    Json row = Json::array();
    row.push_back({{"text", significant(1e3 * budget, 2) + "\u00A0ms"}, {"value", budget}});
    for (const std::string& solver : solvers_of(scene.bench)) {
      const auto at = best_for({.budget = budget / kFrame}, candidates, solver);
      if (!at) {
        row.push_back("nothing that cheap");
        continue;
      }
      Json cell{{"text", q.text(candidates[*at].error) + " for " +
                             milliseconds(candidates[*at].cost, 1e3 * kFrame) + ", " +
                             scene.setting(*at)},
                {"value", candidates[*at].error},
                {"case", scene.refs.key(scene.bench.cases[*at].record)}};
      if (const std::string motion = scene.motion(*at); !motion.empty()) cell["note"] = motion;
      row.push_back(std::move(cell));
    }
    table["rows"].push_back(std::move(row));
  }
  return table;
}

/// Who is cheapest for the priced error, by how much, and how to ask again.
Json cheapest_row(const CostScene& scene) {
  const SceneBench& bench = scene.bench;
  const CaseSpec spec =
      bench.cases.empty() ? CaseSpec{bench.scene, {}, {}} : bench.cases.front().record.spec;
  std::string again = "taut advise " + spec.scene + " --error 1%";
  for (const std::string& value : spec.overrides) again += " --set '" + value + "'";
  const auto best = best_for({.error = kPricedError}, bench.candidates(kErrorMetric));
  if (!best) return {bench.scene, "not reached by the settings tried", "–", "–", again};
  const BenchedCase& c = bench.cases[*best];
  std::string others;
  for (const SolverRecommendation& r :
       recommend(bench, {.error = kPricedError}, kErrorMetric).solvers) {
    if (r.at == best) continue;
    others += (others.empty() ? "" : "; ") + solver_title(r.solver) + " ";
    if (!r.at || !r.times) {
      others += scene.missed(r.solver);
      continue;
    }
    others +=
        ratio_note(*r.times, judge(*r.times, bench.control)) + " with " + scene.setting(*r.at);
  }
  return {bench.scene, solver_title(c.record.solver) + " " + scene.setting(*best),
          scene.cell(*best, milliseconds(c.cost())),
          others.empty() ? "no other solver can run this scene" : others, again};
}

/// Dolan and More's performance profiles at a few factors.
Json profile_table(const std::vector<SceneBench>& scenes) {
  const std::vector<PerformanceProfile> profiles = performance_profiles(scenes, kErrorMetric);
  const std::size_t problems = profiles.empty() ? 0 : profiles.front().ratios.size();
  constexpr double kFactors[] = {1, 1.5, 2, 4, 10, std::numeric_limits<double>::max()};
  Json table = json_table(
      "cost-profiles", "How often each solver is within a factor of the cheapest",
      "Share of " + std::to_string(problems) + " problems: an error of " +
          quantity(kErrorMetric).title +
          " to be reached on a scene. Every solver has equally many settings of a scene, with what "
          "all of its solvers have.",
      {"solver", "the cheapest", "within 1.5 ×", "within 2 ×", "within 4 ×", "within 10 ×",
       "at any cost"});
  for (const PerformanceProfile& profile : profiles) {
    if (problems == 0) break;
    Json row = Json::array({solver_title(profile.solver)});
    for (const double factor : kFactors) row.push_back(shown(kShare, profile.share(factor)));
    table["rows"].push_back(std::move(row));
  }
  return table;
}

}  // namespace

Json json_of_cost(const StudyBench& study, Citations& refs, Json& charts, Json& tables) {
  Json cost{{"machine", study.machine}};
  Json cheapest = json_table(
      "cost-cheapest",
      "Cheapest setting for " + quantity(kErrorMetric).text(kPricedError, 1) + " " +
          quantity(kErrorMetric).title,
      "With what all solvers of a scene have; what only one has is said apart.",
      {"scene", "cheapest setting", "CPU time per simulated second", "the others", "ask again"});
  refs.use("cpu.per_second"), refs.use("cpu.per_step");
  std::vector<SceneBench> shared;
  for (const SceneBench& bench : study.scenes) {
    const std::vector<Record> records = StudyBench{"", "", {bench}}.records();
    shared.push_back(with_shared_parameters(bench));
    const CostScene scene{shared.back(), records, refs};
    Json one{
        {"scene", bench.scene},
        {"control", json_interval(bench.control,
                                  bench.cases.empty() ? 0 : bench.cases[0].timing.samples.size())},
        {"noisy", spread(bench.control) > kTolerance},
        {"noise", "Timing noise: two runs of identical code differed by up to " +
                      shown(kShare, spread(bench.control)) + "."}};
    try {
      add_by_id(one, "charts", json_of(cost_chart(bench, records), refs), charts);
    } catch (const InputError&) {
      // nothing completed: the tables say so
    }
    for (Json& table : std::vector{levels_table(scene), budgets_table(scene)})
      add_by_id(one, "tables", std::move(table), tables);
    cheapest["rows"].push_back(cheapest_row(scene));
    cost["scenes"].push_back(std::move(one));
  }
  add_by_id(cost, "tables", std::move(cheapest), tables);
  if (Json profiles = profile_table(shared); !profiles["rows"].empty())
    add_by_id(cost, "tables", std::move(profiles), tables);
  return cost;
}

}  // namespace taut::report
