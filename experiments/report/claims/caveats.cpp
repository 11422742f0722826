#include <algorithm>

#include "experiments/report/claims/claim.hpp"

namespace taut::report {

std::vector<std::string> caveats(const ReportInput& input) {
  std::vector<std::string> points;
  if (input.bench)
    points.push_back("Cost elsewhere: times were measured on one machine (" + input.bench->machine +
                     "), with the settings that were tried; a finer search may find cheaper ones "
                     "(taut advise).");
  else
    points.emplace_back(
        "Cost in time: equal sweeps are equal work, not equal time; taut bench measures CPU time.");
  points.emplace_back(
      "Real cloth: every error here is a distance from the constraints, from a reference or from a "
      "closed form, not from a measured fabric.");
  points.emplace_back(
      "What the engines are good at elsewhere: Bullet's collision shapes, rigid-body coupling and "
      "material parameters are outside these scenes.");
  points.emplace_back(
      "Visual quality: less stretch is not always better looking; damping and relaxation change "
      "motion as well as error.");
  points.emplace_back(
      "Other machines: results repeat bit for bit on one build; a Bullet built otherwise or "
      "another kind of processor may change the last digits.");
  std::size_t records = 0, planned = 0;
  for (const StudyResult& study : input.studies)
    records += study.records.size(), planned += std::max(study.planned, study.records.size());
  if (records < planned)
    points.push_back("The " + std::to_string(planned - records) +
                     " planned cases that have not been run.");
  return points;
}

}  // namespace taut::report
