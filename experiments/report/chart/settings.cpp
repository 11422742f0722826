#include "experiments/report/chart/settings.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/quantity.hpp"

namespace taut::report {

namespace {

const SolverEntry* find_entry(std::string_view solver) {
  const auto known = solvers();
  const auto found = std::ranges::find(known, solver, &SolverEntry::name);
  return found == known.end() ? nullptr : *found;
}

std::vector<std::string> parts(std::string_view names) {
  std::vector<std::string> all;
  for (std::size_t end = 0; !names.empty(); names.remove_prefix(std::min(end + 1, names.size()))) {
    end = std::min(names.find('|'), names.size());
    all.emplace_back(names.substr(0, end));
  }
  return all;
}

}  // namespace

std::string solver_title(std::string_view solver) {
  if (const SolverEntry* entry = find_entry(solver); entry && !entry->title.empty())
    return std::string(entry->title);
  std::string title(solver);
  std::ranges::replace(title, '_', ' ');
  std::ranges::replace(title, '-', ' ');
  return capitalised(title);
}

std::string parameter_of(std::string_view solver, std::string_view name) {
  std::string_view own;
  if (const SolverEntry* entry = find_entry(solver)) {
    if (name == kSweeps) own = entry->accuracy.sweeps;
    if (name == kSubsteps) own = entry->accuracy.substeps;
  }
  return std::string(own.empty() ? name : own);
}

std::vector<std::string> accuracy_parameters(const std::string& solver) {
  std::vector<std::string> all{parameter_of(solver, kSubsteps), parameter_of(solver, kSweeps)};
  const SolverEntry* entry = find_entry(solver);
  for (const std::string& name : parts(entry ? entry->accuracy.labelled : ""))
    if (std::ranges::find(all, name) == all.end()) all.push_back(name);
  return all;
}

std::vector<std::string> extras(const Record& r, const std::map<std::string, std::string>& others) {
  std::vector<std::string> used;
  const SolverEntry* entry = find_entry(r.solver);
  for (const std::string& name : parts(entry ? entry->accuracy.accelerators : "")) {
    const auto spec = std::ranges::find(entry->params, name, &ParamSpec::name);
    const auto at = r.params.find(name);
    if (at != r.params.end() && at->second != spec->default_value && !others.contains(name))
      used.push_back(name);
  }
  return used;
}

std::string Work::text() const {
  if (sweeps < 0) return substeps < 0 ? "defaults" : std::to_string(substeps) + " substeps";
  if (substeps < 0) return std::to_string(sweeps) + " sweeps";
  return std::to_string(substeps) + " × " + std::to_string(sweeps);
}

Work work_of(const Record& r) {
  const auto number = [&](std::string_view name) {
    const double value = value_of(r, name);
    return std::isfinite(value) ? static_cast<int>(value) : -1;
  };
  const int substeps = number(kSubsteps), sweeps = number(kSweeps);
  return {sweeps >= 0 ? std::max(1, substeps) : substeps, sweeps};  // whole steps are one substep
}

std::string brief_settings(const std::string& solver) try {
  const SolverChoice choice = parse_solver(solver);
  const std::string sweeps = parameter_of(choice.entry->name, kSweeps),
                    substeps = parameter_of(choice.entry->name, kSubsteps);
  Work work;
  std::string text;
  for (const ParamSpec& spec : choice.params.specs()) {
    const std::string value(choice.params.value(spec.name));
    if (spec.name == sweeps)
      work.sweeps = std::stoi(value);
    else if (spec.name == substeps)
      work.substeps = std::stoi(value);
    else if (value != spec.default_value)
      text += ", " + std::string(spec.name) + "=" + value;
  }
  if (work.sweeps >= 0) work.substeps = std::max(1, work.substeps);
  if (work == Work{} && !text.empty()) return text.substr(2);
  return work.text() + text;
} catch (const InputError&) {
  const auto colon = solver.find(':');
  return colon == std::string::npos ? "" : solver.substr(colon + 1);
}

std::string unequal_work(const Records& records) {
  std::map<std::string, std::set<Work>> works;
  std::vector<std::string> solvers;
  for (const Record* r : records)
    if (const Work work = work_of(*r); work.sweeps > 0) {
      if (!works.contains(r->solver)) solvers.push_back(r->solver);
      works[r->solver].insert(work);
    }
  if (works.size() < 2) return "";
  std::set<Work> common = works.begin()->second;
  std::string text;
  for (const std::string& solver : solvers) {
    const std::set<Work>& own = works[solver];
    std::erase_if(common, [&](const Work& work) { return !own.contains(work); });
    const Work &first = *own.begin(), &last = *own.rbegin();
    text += (text.empty() ? "" : ", ") + solver_title(solver) + " " + first.text() +
            (own.size() > 1 ? " to " + last.text() : "");
  }
  return common.empty() ? text + " (substeps × sweeps)" : "";
}

SettingLabels::SettingLabels(const Records& all) {
  for (const Record* r : all)
    for (const std::string& name : accuracy_parameters(r->solver))
      if (const auto at = r->params.find(name); at != r->params.end())
        seen_[{r->solver, name}].insert(at->second);
}

std::string SettingLabels::of(const Record& record) const {
  const std::string sweeps = parameter_of(record.solver, kSweeps),
                    substeps = parameter_of(record.solver, kSubsteps);
  std::string text;
  bool work = false;
  for (const std::string& name : accuracy_parameters(record.solver)) {
    const auto at = record.params.find(name);
    if (at == record.params.end()) continue;
    const auto seen = seen_.find({record.solver, name});
    const bool varies = seen != seen_.end() && seen->second.size() > seen->second.count(at->second);
    if (!varies || at->second == "off") continue;
    if (name == substeps || name == sweeps)
      work = true;
    else
      text += ", " + (at->second == "on" ? name : at->second);
  }
  if (work) return work_of(record).text() + text;
  return text.empty() ? "" : text.substr(2);
}

}  // namespace taut::report
