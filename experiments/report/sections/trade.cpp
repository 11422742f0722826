#include <algorithm>
#include <limits>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"
#include "experiments/timing/answer.hpp"

namespace taut::report::section::trade {

namespace {

constexpr const char* kMetric = kPricedMetric;
constexpr double kQuestion = kPricedError;  ///< the level of "which solver at which setting?"

std::string span_text(const Interval& i, const char* unit, double scale = 1) {
  const int decimals = decimals_for((i.high - i.low) * scale);
  return fixed(i.mid * scale, decimals) + unit + " (" + fixed(i.low * scale, decimals) + "–" +
         fixed(i.high * scale, decimals) + ")";
}

std::string setting(const BenchedCase& c) {
  const std::string text = parse_solver(c.record.spec.solver).brief();
  const auto colon = text.find(':');
  if (colon == std::string::npos) return "defaults";
  std::string spaced;  // so that a narrow column can break it
  for (const char letter : text.substr(colon + 1))
    spaced += letter == ',' ? ", " : std::string(1, letter);
  return spaced;
}

/// "never reached (at best 0.12 %)".
std::string never(const SceneBench& scene, const std::string& solver) {
  const std::vector<Candidate> candidates = scene.candidates(kMetric);
  const auto nearest = best_for({{}, std::numeric_limits<double>::infinity()}, candidates, solver);
  return nearest
             ? "never reached (at best " + quantity(kMetric).text(candidates[*nearest].error) + ")"
             : "never reached: every case failed";
}

/// The rivals of the cheapest, nearest first.
std::vector<const SolverAnswer*> rivals(const std::vector<SolverAnswer>& row,
                                        const SolverAnswer& best) {
  std::vector<const SolverAnswer*> others;
  for (const SolverAnswer& r : row)
    if (&r != &best && r.times) others.push_back(&r);
  std::ranges::sort(others, {}, [](const SolverAnswer* r) { return r->times->mid; });
  return others;
}

/// The command that asks the same question of the same scene.
std::string ask_again(const SceneBench& scene) {
  std::string text = "taut advise " + scene.scene + " --error 1%";
  if (!scene.cases.empty())
    for (const std::string& value : scene.cases.front().record.spec.overrides)
      text += " --set " + value;
  return text;
}

/// One row of the summary: who is cheapest for the level, by how much, and how to ask again.
std::vector<std::string> answer(const SceneBench& scene) {
  const Answer found = taut::answer(scene, {kQuestion, {}}, kMetric);
  const std::vector<SolverAnswer>& row = found.solvers;
  const auto best = found.best;
  const std::string again = ask_again(scene);
  if (!best) return {scene.scene, "never reached", "–", "–", again};
  const BenchedCase& c = scene.cases[*best];
  const auto& first =
      *std::ranges::find_if(row, [&](const SolverAnswer& r) { return r.at == best; });
  std::string ratios;
  for (const SolverAnswer* r : rivals(row, first))
    ratios += (ratios.empty() ? "" : ", ") + solver_title(r->solver) + " " +
              span_text(*r->times, " ×") +
              (is_significant(*r->times, scene.control) ? "" : ", no difference that can be told");
  for (const SolverAnswer& r : row)
    if (!r.at)
      ratios +=
          (ratios.empty() ? "" : ", ") + solver_title(r.solver) + " " + never(scene, r.solver);
  return {scene.scene, solver_title(c.record.solver) + " " + setting(c),
          span_text(c.cost(), " ms", 1e3), ratios.empty() ? "no rival can run this scene" : ratios,
          again};
}

/// A setting as the chart beside it names it: "2 × 1, coloured".
std::string brief(const BenchedCase& c, const std::vector<Record>& records) {
  std::string label = knob_label(c.record, records);
  if (const auto times = label.find(" × "); times != std::string::npos)
    label.replace(times, std::string(" × ").size(), "\u00A0×\u00A0");
  return label.empty() ? "" : ": " + label;
}

Table levels(const SceneBench& scene, const std::vector<Record>& records) {
  Table table{{"to reach"}, {}};
  for (const std::string& solver : solvers_of(scene)) table.header.push_back(solver_title(solver));
  for (const double level : kErrorLevels) {
    table.rows.push_back({quantity(kMetric).text(level, 1)});
    for (const SolverAnswer& r : taut::answer(scene, {level, {}}, kMetric).solvers)
      table.rows.back().push_back(
          !r.at ? never(scene, r.solver)
                : span_text(scene.cases[*r.at].cost(), " ms", 1e3) +
                      (r.times && r.times->mid > 1 ? ", " + span_text(*r.times, " ×") : "") +
                      brief(scene.cases[*r.at], records));
  }
  return table;
}

Table budgets(const SceneBench& scene, const std::vector<Record>& records) {
  Table table{{"within, per frame"}, {}};
  const std::vector<Candidate> candidates = scene.candidates(kMetric);
  for (const std::string& solver : solvers_of(scene)) table.header.push_back(solver_title(solver));
  for (const double budget : kFrameBudgets) {
    table.rows.push_back({significant(1e3 * budget, 2) + " ms"});
    for (const std::string& solver : solvers_of(scene)) {
      const auto at = best_for({{}, budget / kFrame}, candidates, solver);
      table.rows.back().push_back(at ? quantity(kMetric).text(candidates[*at].error) + " for " +
                                           span_text(candidates[*at].cost, " ms", 1e3 * kFrame) +
                                           brief(scene.cases[*at], records)
                                     : "nothing that cheap");
    }
  }
  return table;
}

std::string scene_part(Page& page, const SceneBench& scene, const std::vector<Record>& records) {
  const std::string control = "the same code against itself: " + span_text(scene.control, " ×");
  return "<h3>" + escape_html(solver_title(scene.scene)) + "</h3><div class=\"cards\">" +
         page.figure({.kind = "work-precision",
                      .x = "cpu.per_second",
                      .y = kMetric,
                      .title = "Error over cost, " + scene.scene,
                      .width = 540,
                      .height = 380},
                     {records, {}}, "Error over cost",
                     "down and left is better; labels are substeps × sweeps; " + control) +
         "<div class=\"card\"><h4>Cost of an error</h4><p>CPU time per simulated second, its 95 % "
         "interval, the ratio to the cheapest, and the setting as the chart names it.</p>" +
         html_table(levels(scene, records), "Cost of an error, " + scene.scene) +
         "</div><div class=\"card wide\"><h4>Error within a budget</h4><p>The least error within a "
         "budget of CPU time per frame of 1/60 s, what it costs and with which setting.</p>" +
         html_table(budgets(scene, records), "Error within a budget, " + scene.scene) +
         "</div></div>\n";
}

std::string render(Page& page, const std::string&) {
  const std::string head = "<section id=\"trade\"><h2>What accuracy costs</h2>";
  if (!page.input().bench)
    return head + absent("No cost was measured.", "taut bench trade --preset quick") +
           "</section>\n";
  const BenchSession& bench = *page.input().bench;
  Table table{{"scene", "cheapest setting", "CPU per simulated second", "the others", "ask again"},
              {}};
  std::string parts;
  for (const SceneBench& scene : bench.scenes) {
    table.rows.push_back(answer(scene));
    parts += scene_part(page, scene, BenchSession{bench.study, bench.machine, {scene}}.records());
  }
  return head + "<p class=\"lead\">Which solver at which setting for " +
         quantity(kMetric).text(kQuestion, 1) + " " + quantity(kMetric).title + "? Measured on " +
         escape_html(bench.machine) +
         ", CPU time of a step alone, in alternating order (ABBA) between processes; intervals are "
         "95 %. "
         "The others' factors are their costs over that of the cheapest.</p><div class=\"card\">" +
         html_table(table, "Cheapest setting for the level") + "</div>" + parts + "</section>\n";
}

}  // namespace
}  // namespace taut::report::section::trade

TAUT_SECTION(trade) = {
    .name = "trade", .order = 35, .render = taut::report::section::trade::render};
