#include "experiments/timing/scaling.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/system/distinct.hpp"

namespace taut {

namespace {

std::string size_of(const Case& one) {
  return std::to_string(one.scene->mesh.size()) + " vertices";
}

/// Fits a power law if there are at least three stable cases.
std::optional<PowerLaw> fit(const std::vector<BenchedCase>& cases,
                            const std::function<double(const BenchedCase&)>& value) {
  std::vector<double> x, y;
  for (const BenchedCase& c : cases)
    if (c.stable() && value(c) > 0) {
      x.push_back(c.record.vertices);
      y.push_back(value(c));
    }
  if (x.size() < 3) return {};
  return fit_power_law(x, y);
}

void measure(ScalingLine& line, const std::vector<const Case*>& cases, double limit,
             const Measure& measure) {
  double seconds = 0;
  int vertices = 0;
  for (const Case* one : cases) {
    const int size = one->scene->mesh.size();
    const double expected = vertices == 0 ? 0 : seconds * size / vertices;
    if (expected > limit) {
      line.skipped.push_back(size_of(*one) + ": expected to take " +
                             std::to_string(std::lround(expected)) + " s, allowed " +
                             std::to_string(std::lround(limit)) + " s");
      continue;
    }
    Measured measured = measure(*one, expected);
    seconds = std::max(measured.seconds, seconds);
    vertices = size;
    if (!measured.benched.stable())
      line.skipped.push_back(size_of(*one) + ": " +
                             (measured.benched.timing.failure.empty()
                                  ? std::string(to_string(measured.benched.record.status.kind))
                                  : measured.benched.timing.failure));
    line.cases.push_back(std::move(measured.benched));
  }
}

}  // namespace

double plan_bytes(const Record& record) {
  double bytes = 0;
  for (const PassCost& pass : record.step_cost) bytes += static_cast<double>(pass.bytes);
  return bytes;
}

std::vector<ScalingLine> measure_scaling(const std::vector<Case>& cases, double limit,
                                         const Measure& run) {
  std::vector<std::pair<std::string, std::vector<const Case*>>> groups;
  for (const Case& one : cases) group_of(groups, one.choice.brief()).push_back(&one);
  std::vector<ScalingLine> lines;
  for (auto& [setting, members] : groups) {
    std::ranges::stable_sort(members, {}, [](const Case* c) { return c->scene->mesh.size(); });
    ScalingLine line{setting, {}, {}, {}, {}, {}};
    measure(line, members, limit, run);
    line.cpu = fit(line.cases, [](const BenchedCase& c) { return median(c.timing.samples); });
    line.wall = fit(line.cases, [](const BenchedCase& c) { return median(c.timing.wall); });
    line.memory = fit(line.cases, [](const BenchedCase& c) { return plan_bytes(c.record); });
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace taut
