// Cases in the model: a single case, the settings of several, and the counts over a scene's cases.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/record_parts.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/judge.hpp"

namespace taut::report {

namespace {

/// Text of a set of values: "1, 2, 4" or "1 to 256 (9 values)".
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

Table resolved_settings_table(const QuotedScene& quoted, const ComparedSolvers& compared,
                              CaseList& refs) {
  Table table{"settings-" + slug(quoted.task.scene),
              "Settings each solver used for this scene",
              {Column("setting")},
              {},
              "Settings that differ between solvers are marked."};
  std::vector<const Record*> cases;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    const Record* r = quoted.cases[i];
    if (!r) continue;
    cases.push_back(r);
    table.columns.emplace_back(r->solver, compared.all[i].label);
    for (const ResolvedSetting& one : r->resolved_settings) push_unique(names, one.name);
  }
  /// `setting` returns the ResolvedSetting of a record. If its name is empty, the solver does not
  /// have this setting, which does not count as a difference.
  const auto row = [&](const std::string& name, const auto& setting) -> std::vector<Cell>& {
    std::vector<Cell> cells{name};
    std::set<std::string> different;
    for (const Record* r : cases) {
      const ResolvedSetting one = setting(*r);
      cells.emplace_back(one.name.empty() ? "–" : typeset(one.text));
      if (!one.name.empty()) different.insert(one.compared());
    }
    if (different.size() > 1) cells[0].note = "differs";
    return table.rows.emplace_back(std::move(cells));
  };
  if (cases.empty()) return table;
  auto& work = row("substeps × sweeps",
                   [](const Record& r) { return ResolvedSetting("work", work_of(r).text()); });
  for (std::size_t i = 0; i < cases.size(); ++i) work[i + 1].key = refs.key(*cases[i]);
  for (const std::string& name : names)
    row(name, [&](const Record& r) {
      const ResolvedSetting* setting = find_setting(r.resolved_settings, name);
      return setting ? *setting : ResolvedSetting("", "");
    });
  row("passes of a step, in order", [](const Record& r) {
    return ResolvedSetting("passes", join(r.step_cost, ", ", [](const PassCost& pass) {
                             return pass.pass +
                                    (pass.repeats > 1 ? " × " + std::to_string(pass.repeats) : "");
                           }));
  });
  row("work: constraint projections per step", [](const Record& r) {
    return ResolvedSetting("projections", std::to_string(r.projections));
  });
  return table;
}

Json json_of_case(const Record& r, const BenchedCase* timed, CaseList& refs) {
  CaseSpec spec = r.spec;
  if (spec.scene.find('/') != std::string::npos)
    spec.scene = std::filesystem::absolute(spec.scene).lexically_normal().string();
  Json one{{"key", refs.key(r)},
           {"id", r.id},
           {"scene", r.scene},
           {"solver", r.solver},
           {"settings", r.spec.solver},
           {"parameters", r.params},
           {"brief", brief_settings(r)},
           {"studies", refs.studies_of(r)},
           {"dt", r.dt},
           {"steps", r.steps},
           {"vertices", r.vertices},
           {"links", r.links},
           {"projections", r.projections},
           {"status", to_string(r.status.kind)}};
  add_if(one, "reason", r.status.reason.text());
  add_if(one, "finding", off_prediction(r));
  if (r.status.step >= 0) one["step"] = r.status.step;
  if (r.status.vertex >= 0) one["vertex"] = r.status.vertex;
  one["values"] = Json::object();
  const bool of_maps = refs.only_in_maps(r);
  for (const auto& [name, value] : r.values)
    if (const ValueSpec* known = find_value(name).second;
        std::isfinite(value) && !(of_maps && known && known->role == Role::none)) {
      one["values"][name] = rounded_to(value, 7);  // more digits than a page shows
      refs.use(name);
    }
  if (timed && timed->stable()) {
    const Interval second = timed->cost();
    const Interval step{second.low * r.dt, second.mid * r.dt, second.high * r.dt};
    const std::size_t n = timed->timing.samples.size();
    one["cost"] = {{kCpuPerSecond, json_interval(second, n)},
                   {kCpuPerStep, json_interval(step, n)}};
  }
  add_if(one, "scene_settings", r.spec.settings);
  one["command"] = reproduce(spec);
  return one;
}

Json facts_of(const CaseList& refs, const std::string& scene) {
  std::map<std::string, std::set<double>> seen;
  std::size_t cases = 0, off = 0;
  for (const Record* r : refs.cases()) {
    if (r->scene != scene) continue;
    ++cases;
    off += !off_prediction(*r).empty();
    for (const char* name : {"vertices", "links", "dt", kSubsteps, kSweeps})
      if (const double value = value_of(*r, name); std::isfinite(value)) seen[name].insert(value);
    seen["t"].insert(std::round(r->steps * r->dt * 100) / 100);
  }
  Json facts;
  for (const auto& [name, values] : seen) {
    const Quantity q = quantity(name);
    facts.push_back({{"name", q.title}, {"value", range_of(values, q)}});
  }
  facts.push_back({{"name", "cases"}, {"value", std::to_string(cases)}});
  if (off > 0)
    facts.push_back({{"name", kOffPrediction}, {"value", std::to_string(off) + " of these"}});
  return facts;
}

Table spent_table(const std::vector<const Record*>& cases,
                  const std::map<std::string, Spent>& spent) {
  const Unit seconds{Unit::Kind::time, "s", "s"};
  Table table{"spent",
              "CPU time that the cases took",
              {{"solver"},
               {"cases"},
               {"cpu", "CPU time of their processes", seconds},
               {"metrics", "of which metrics", seconds}}};
  struct Sum {
    std::string solver;
    double cases = 0, cpu = 0, metrics = 0;
  };
  std::map<std::string, Sum> sums;
  for (const Record* r : cases)
    if (const auto at = spent.find(r->key); at != spent.end())
      for (const std::string& who : {r->solver, std::string("all")}) {
        Sum& sum = sums[who];
        sum.solver = who;
        ++sum.cases;
        sum.cpu += at->second.cpu;
        sum.metrics += at->second.metrics;
      }
  std::vector<Sum> all;
  for (const auto& [solver, sum] : sums) all.push_back(sum);
  std::ranges::stable_sort(all, std::greater(), &Sum::cpu);
  for (const Sum& sum : all) table.rows.push_back({sum.solver, sum.cases, sum.cpu, sum.metrics});
  return table;
}

}  // namespace taut::report
