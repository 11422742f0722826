#include "experiments/report/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

namespace {

bool usable(const Record& r) {
  return r.status.kind == Status::Kind::ok || r.status.kind == Status::Kind::unsettled;
}

std::string case_key(const Record& r) {
  std::string key = r.scene + "|" + exact(r.dt);
  for (const char* setting : {"iterations", "substeps"}) key += "|" + exact(value_of(r, setting));
  for (const std::string& text : r.spec.overrides) key += "|" + text;
  return key;
}

std::vector<Record> all_records(const ReportInput& input) {
  std::vector<Record> all;
  std::set<std::string> keys;
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records)
      if (keys.insert(r.key.empty() ? r.id : r.key).second) all.push_back(r);
  return all;
}

std::map<std::string, std::string> choices(const Record& r) {
  auto params = r.params;
  params.erase("iterations");
  params.erase("substeps");
  return params;
}

Contender choose(const std::string& solver, const std::vector<Record>& all) {
  std::vector<std::pair<std::map<std::string, std::string>, std::vector<Record>>> groups;
  for (const Record& r : all) {
    if (r.solver != solver) continue;
    const auto params = choices(r);
    auto group = std::ranges::find(groups, params, [](const auto& g) { return g.first; });
    if (group == groups.end()) group = groups.insert(groups.end(), {params, {}});
    group->second.push_back(r);
  }
  const auto best =
      std::ranges::max_element(groups, {}, [](const auto& group) { return group.second.size(); });
  Contender contender{solver, solver_title(solver), best->second};
  for (const auto& setting : best->first)
    if (std::ranges::any_of(groups, [&](const auto& g) {
          const auto other = g.first.find(setting.first);
          return other == g.first.end() || other->second != setting.second;
        }))
      contender.label += " " + setting.second;
  return contender;
}

/// The number that most contenders were run with, near 16; those without sweeps have no say.
int common_sweeps(const std::vector<Contender>& contenders) {
  std::map<int, int> counts;
  for (const Contender& c : contenders) {
    std::set<int> seen;
    for (const Record& r : c.records)
      if (const double k = value_of(r, "iterations"); k >= 1) seen.insert(static_cast<int>(k));
    for (const int k : seen) ++counts[k];
  }
  const auto rank = [](const std::pair<const int, int>& count) {
    return std::pair(count.second, -std::abs(std::log(count.first / 16.0)));
  };
  const auto best = std::ranges::max_element(counts, {}, rank);
  return best == counts.end() ? 0 : best->first;
}

double geometric(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace

std::optional<Ratio> ratio_of(const Contender& contender, const Contender& first,
                              const std::string& value, double floor) {
  std::map<std::string, double> reference;
  for (const Record& r : first.records)
    if (usable(r)) reference[case_key(r)] = value_of(r, value);
  std::map<std::string, std::vector<double>> by_scene;
  int pairs = 0;
  for (const Record& r : contender.records) {
    const auto other = usable(r) ? reference.find(case_key(r)) : reference.end();
    if (other == reference.end()) continue;
    const double quotient = std::max(value_of(r, value), floor) / std::max(other->second, floor);
    if (!std::isfinite(quotient) || !(quotient > 0)) continue;
    ++pairs;
    by_scene[r.scene].push_back(quotient);
  }
  if (pairs == 0) return std::nullopt;
  Ratio ratio{1, pairs, {}};
  std::vector<double> means;
  for (const auto& [scene, values] : by_scene)
    means.push_back(ratio.by_scene[scene] = geometric(values));
  ratio.mean = geometric(means);
  return ratio;
}

Comparison compare(const ReportInput& input) {
  const std::vector<Record> all = all_records(input);
  std::vector<std::string> solvers;
  for (const Record& r : all)
    if (std::ranges::find(solvers, r.solver) == solvers.end()) solvers.push_back(r.solver);
  std::ranges::stable_sort(solvers, {}, [](const std::string& s) { return s != "jakobsen"; });
  Comparison facts;
  for (const std::string& solver : solvers) facts.contenders.push_back(choose(solver, all));
  facts.sweeps = common_sweeps(facts.contenders);
  for (const Contender& c : facts.contenders) {
    facts.stretch.push_back(ratio_of(c, facts.contenders.front(), "stretch.rms", kNoStretch));
    facts.cost.push_back(ratio_of(c, facts.contenders.front(), kCpuValue, 0));
    facts.price.push_back(
        input.bench ? std::optional(compare_price(*input.bench, solvers.front(), c.solver))
                    : std::nullopt);
    facts.failed.push_back(static_cast<int>(std::ranges::count_if(c.records, [](const Record& r) {
      return !usable(r) && r.status.kind != Status::Kind::unsupported;
    })));
    facts.total.push_back(static_cast<int>(c.records.size()));
  }
  return facts;
}

bool equal_substeps(const Comparison& facts) {
  std::set<std::set<double>> all;
  for (const Contender& c : facts.contenders) {
    std::set<double> own;
    for (const Record& r : c.records)
      if (const double n = value_of(r, "substeps"); std::isfinite(n)) own.insert(n);
    if (!own.empty()) all.insert(own);
  }
  return all.size() <= 1;
}

bool quoted_at(const Record& record, int sweeps) {
  const double own = value_of(record, "iterations");
  return std::isnan(own) || own == sweeps;
}

std::optional<SoundStep> largest_sound_step(const Contender& contender, const std::string& scene,
                                            int sweeps) {
  constexpr std::size_t kLeastSteps = 3;
  constexpr double kLeastRange = 4;
  std::map<double, bool> sound;
  for (const Record& r : contender.records) {
    if (r.scene != scene || !quoted_at(r, sweeps)) continue;
    const auto [at, fresh] = sound.try_emplace(r.dt, true);
    at->second = at->second && usable(r);
  }
  if (sound.size() < kLeastSteps || sound.rbegin()->first < kLeastRange * sound.begin()->first)
    return std::nullopt;
  SoundStep step;
  for (const auto& [dt, good] : sound) {
    step.no_limit = step.no_limit && good;
    if (step.no_limit) step.dt = dt;
  }
  return step;
}

SoundSteps sound_steps(const Comparison& facts, const std::vector<std::string>& scenes) {
  SoundSteps steps;
  std::vector<std::vector<double>> found(facts.contenders.size());
  for (const std::string& scene : scenes) {
    std::vector<SoundStep> here;
    for (const Contender& c : facts.contenders)
      if (const auto step = largest_sound_step(c, scene, facts.sweeps); step && step->dt > 0)
        here.push_back(*step);
    if (here.size() != facts.contenders.size()) continue;
    steps.scenes.push_back(scene);
    for (std::size_t i = 0; i < here.size(); ++i) {
      found[i].push_back(here[i].dt);
      steps.no_limit = steps.no_limit && here[i].no_limit;
    }
  }
  if (!steps.scenes.empty())
    for (const auto& values : found) steps.dt.push_back(geometric(values));
  return steps;
}

std::optional<double> value_at(const Contender& contender, const std::string& scene, int sweeps,
                               const std::string& value) {
  std::vector<Record> here;
  for (const Record& r : contender.records)
    if (r.scene == scene && quoted_at(r, sweeps)) here.push_back(r);
  if (here.empty()) return std::nullopt;
  for (const Record& r : most_common(here, "dt", 1.0 / 64).records)
    if (usable(r) && std::isfinite(value_of(r, value))) return value_of(r, value);
  return std::nullopt;
}

}  // namespace taut::report
