// A case of the model, and what is counted of all cases of a scene.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

/// "1, 2, 4" or "1 to 256 (9 values)".
std::string range_of(const std::set<double>& values, const Quantity& q) {
  if (values.empty()) return "–";
  const auto one = [&](double v) { return tick_of(q, v); };
  const std::string unit = q.unit.shown.empty() ? "" : "\u00A0" + std::string(q.unit.shown);
  if (values.size() > 3)
    return one(*values.begin()) + " to " + one(*values.rbegin()) + unit + " (" +
           std::to_string(values.size()) + " values)";
  return join(values, ", ", one) + unit;
}

}  // namespace

Json json_of_case(const Record& r, const BenchedCase* timed, Citations& refs) {
  CaseSpec spec = r.spec;
  if (spec.scene.find('/') != std::string::npos)
    spec.scene = std::filesystem::absolute(spec.scene).lexically_normal().string();
  Json one{{"key", refs.key(r)},
           {"id", r.id},
           {"scene", r.scene},
           {"solver", r.solver},
           {"settings", r.spec.solver},
           {"parameters", r.params},
           {"brief", brief_settings(r.spec.solver)},
           {"studies", refs.studies_of(r)},
           {"dt", r.dt},
           {"steps", r.steps},
           {"vertices", r.vertices},
           {"links", r.links},
           {"projections", r.projections},
           {"status", to_string(r.status.kind)}};
  add_if(one, "reason", r.status.reason);
  if (r.status.step >= 0) one["step"] = r.status.step;
  if (r.status.vertex >= 0) one["vertex"] = r.status.vertex;
  one["values"] = Json::object();
  for (const auto& [name, value] : r.values)
    if (std::isfinite(value)) one["values"][name] = value, refs.use(name);
  if (timed && timed->stable()) {
    const Interval second = timed->cost();
    const Interval step{second.low * r.dt, second.mid * r.dt, second.high * r.dt};
    const std::size_t n = timed->timing.samples.size();
    one["cost"] = {{"cpu.per_second", json_interval(second, n)},
                   {"cpu.per_step", json_interval(step, n)}};
  }
  add_if(one, "overrides", r.spec.overrides);
  one["command"] = reproduce(spec);
  return one;
}

Json facts_of(const ReportInput& input, const std::string& scene) {
  std::map<std::string, std::set<double>> seen;
  std::size_t cases = 0;
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) {
      if (r.scene != scene) continue;
      ++cases;
      for (const char* name : {"vertices", "links", "dt", kSubsteps, kSweeps})
        if (const double value = value_of(r, name); std::isfinite(value)) seen[name].insert(value);
      seen["t"].insert(std::round(r.steps * r.dt * 100) / 100);
    }
  Json facts;
  for (const auto& [name, values] : seen) {
    const Quantity q = quantity(name);
    facts.push_back({{"name", q.title}, {"value", range_of(values, q)}});
  }
  facts.push_back({{"name", "cases"}, {"value", std::to_string(cases)}});
  return facts;
}

}  // namespace taut::report
