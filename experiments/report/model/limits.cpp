// What scenes require of a model, and how far solvers go.
#include <algorithm>
#include <cmath>

#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/settings.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

Json columns(const std::vector<std::string>& titles) {
  Json all = Json::array();
  for (const std::string& title : titles) all.push_back({{"title", title}});
  return all;
}

Json required_table(const std::vector<RequiredModel>& required) {
  Json rows = Json::array();
  for (const RequiredModel& one : required)
    rows.push_back(Json::array({one.scene, solver_title(one.solver.substr(0, one.solver.find(':'))),
                                one.chaotic.empty() ? "no" : one.chaotic, one.answers, one.drop,
                                one.keep, one.time}));
  return {
      {"id", "required"},
      {"title", "The smallest model that keeps a scene's answers"},
      {"caption",
       "taut require takes away or coarsens one effect at a time and then all that can go; an "
       "answer may move by its tolerance, or by what a rounding error at the start moves it. Of "
       "a chaotic scene only statistics are kept."},
      {"columns", columns({"scene", "solver", "chaotic", "kept answers", "can go", "required",
                           "CPU time left"})},
      {"rows", rows}};
}

std::string setting_text(double value, const KnobFrontier& knob) {
  return significant(value, 3) + (knob.unit.empty() ? "" : "\u00A0" + knob.unit);
}

std::string end_text(const KnobFrontier& knob) {
  if (!knob.lacks.empty()) return "–: " + knob.lacks;
  if (std::isnan(knob.bad)) return setting_text(knob.to, knob) + ", as far as was asked";
  return (std::isnan(knob.good) ? "none" : setting_text(knob.good, knob)) + ", then " +
         knob.symptom +
         (std::isnan(knob.theory) ? "" : " (theory: " + setting_text(knob.theory, knob) + ")");
}

Json frontier_table(const std::vector<KnobFrontier>& frontiers) {
  std::vector<std::string> solvers, knobs;
  for (const KnobFrontier& f : frontiers) {
    if (!std::ranges::count(solvers, f.solver)) solvers.push_back(f.solver);
    if (!std::ranges::count(knobs, f.knob)) knobs.push_back(f.knob);
  }
  std::vector<std::string> titles{"knob"};
  titles.insert(titles.end(), solvers.begin(), solvers.end());
  Json rows = Json::array();
  for (const std::string& knob : knobs) {
    Json row = Json::array({knob});
    for (const std::string& solver : solvers) {
      const auto at = std::ranges::find_if(
          frontiers, [&](const auto& f) { return f.knob == knob && f.solver == solver; });
      row.push_back(at == frontiers.end() ? "–" : end_text(*at));
    }
    rows.push_back(std::move(row));
  }
  return {
      {"id", "frontiers"},
      {"title", "How far every knob goes on a small swinging sheet"},
      {"caption",
       "The hardest setting up to which nothing was wrong, and what goes wrong first beyond it, "
       "by its own metric; taut frontier --all."},
      {"columns", columns(titles)},
      {"rows", rows}};
}

}  // namespace

Json json_of_limits(const ReportInput& input, Json& tables) {
  Json limits;
  const auto add = [&](Json table) {
    limits["tables"].push_back(table["id"]);
    tables.push_back(std::move(table));
  };
  if (!input.required.empty()) add(required_table(input.required));
  if (!input.frontiers.empty()) add(frontier_table(input.frontiers));
  return limits;
}

}  // namespace taut::report
