#include "experiments/report/claims/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/quantity.hpp"

namespace taut::report {

namespace {

std::map<std::string, std::string> choice_of(const Record& r) {
  auto params = r.params;
  params.erase("iterations"), params.erase("substeps");
  return params;
}

Rival choose(const std::string& solver, const std::vector<const Record*>& cases) {
  std::vector<std::pair<std::map<std::string, std::string>, std::vector<const Record*>>> groups;
  for (const Record* r : cases) {
    const auto choice = choice_of(*r);
    auto group = std::ranges::find(groups, choice, [](const auto& g) { return g.first; });
    if (group == groups.end()) group = groups.insert(groups.end(), {choice, {}});
    group->second.push_back(r);
  }
  const auto most =
      std::ranges::max_element(groups, {}, [](const auto& g) { return g.second.size(); });
  Rival rival{solver, solver_title(solver), most->second};
  for (const auto& [name, value] : most->first)
    if (std::ranges::any_of(groups, [&, name = name, value = value](const auto& g) {
          const auto other = g.first.find(name);
          return other == g.first.end() || other->second != value;
        }))
      rival.label += " " + value;
  return rival;
}

/// The work that most rivals did, near 1 × 16, or the sweeps alone where more of them share those;
/// rivals without sweeps have no say.
Work common_work(const std::vector<Rival>& rivals) {
  std::map<Work, int> counts;
  for (const Rival& rival : rivals) {
    std::set<Work> own;
    for (const Record* r : rival.cases)
      if (const Work work = work_of(*r); work.sweeps > 0) own.insert({work, {-1, work.sweeps}});
    for (const Work& work : own) ++counts[work];
  }
  const auto rank = [](const std::pair<const Work, int>& c) {
    return std::tuple(
        c.second, c.first.substeps > 0,
        -std::abs(std::log(c.first.sweeps / 16.0)) - std::log(std::max(1, c.first.substeps)));
  };
  const auto best = std::ranges::max_element(counts, {}, rank);
  return best == counts.end() ? Work{} : best->first;
}

/// The question that most rivals answered at this work; of equals the time step nearest to 1/64 s.
QuotedScene quote(const std::string& scene, const std::vector<Rival>& rivals, const Work& work) {
  std::vector<QuotedScene> asked;
  for (std::size_t i = 0; i < rivals.size(); ++i)
    for (const Record* r : rivals[i].cases) {
      if (r->scene != scene || !work.admits(work_of(*r))) continue;
      const Question question = question_of(*r);
      auto at = std::ranges::find(asked, question, &QuotedScene::question);
      if (at == asked.end())
        at = asked.insert(at, {question, std::vector<const Record*>(rivals.size())});
      if (!at->cases[i]) at->cases[i] = r;
    }
  const auto rank = [](const QuotedScene& q) {
    return std::pair(std::ranges::count(q.cases, nullptr), std::abs(std::log(q.question.dt * 64)));
  };
  const auto best = std::ranges::min_element(asked, {}, rank);
  if (best == asked.end()) return {{scene, {}, 0}, std::vector<const Record*>(rivals.size())};
  return *best;
}

}  // namespace

bool completed(const Record& r) {
  return r.status.kind == Status::Kind::ok || r.status.kind == Status::Kind::unsettled;
}

bool Work::admits(const Work& other) const {
  return (other.substeps < 0 || substeps < 0 || other.substeps == substeps) &&
         (other.sweeps < 0 || other.sweeps == sweeps);
}

std::string Work::text() const {
  if (sweeps < 0) return substeps < 0 ? "defaults" : std::to_string(substeps) + " substeps";
  if (substeps < 0) return std::to_string(sweeps) + " sweeps";
  return std::to_string(substeps) + " × " + std::to_string(sweeps);
}

Work work_of(const Record& r) {
  const auto number = [&](const char* name) {
    const double value = value_of(r, name);
    return std::isfinite(value) ? static_cast<int>(value) : -1;
  };
  return {number("substeps"), number("iterations")};
}

std::string brief_settings(const std::string& solver, const Work& work) {
  std::string text = work.text();
  try {
    const SolverChoice choice = parse_solver(solver);
    for (const ParamSpec& spec : choice.params.specs()) {
      const std::string_view value = choice.params.value(spec.name);
      if (spec.name != "iterations" && spec.name != "substeps" && value != spec.default_value)
        text += ", " + std::string(spec.name) + "=" + std::string(value);
    }
  } catch (const InputError&) {
    // its text says all
  }
  return text;
}

Question question_of(const Record& r) {
  Question question{r.scene, r.spec.overrides, r.dt};
  std::erase_if(question.overrides, [](const auto& text) { return text.starts_with("time.dt="); });
  std::ranges::sort(question.overrides);
  return question;
}

const QuotedScene* Rivals::quoted(const std::string& scene) const {
  const auto at =
      std::ranges::find(scenes, scene, [](const QuotedScene& q) { return q.question.scene; });
  return at == scenes.end() ? nullptr : &*at;
}

std::string Rivals::unequal_work() const {
  std::map<std::string, std::set<int>> substeps;
  for (const Rival& rival : all)
    for (const Record* r : rival.cases)
      if (const Work w = work_of(*r); w.substeps > 0) substeps[rival.label].insert(w.substeps);
  std::set<std::set<int>> kinds;
  std::string text;
  for (const auto& [label, own] : substeps) {
    kinds.insert(own);
    std::string numbers;
    for (const int n : own) numbers += (numbers.empty() ? "" : "/") + std::to_string(n);
    text += (text.empty() ? "" : ", ") + label + " " + numbers;
  }
  return kinds.size() < 2 ? "" : text + " substeps";
}

Rivals rivals_of(const ReportInput& input) {
  Rivals rivals;
  std::vector<std::string> solvers, scenes;
  std::set<std::string> keys;
  const auto add = [](std::vector<std::string>& names, const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) {
      if (!keys.insert(r.key.empty() ? r.id : r.key).second) continue;
      add(solvers, r.solver), add(scenes, r.scene);
      rivals.by_solver[r.solver].push_back(&r);
    }
  std::ranges::stable_sort(solvers, {}, [](const std::string& s) { return s != "jakobsen"; });
  for (const std::string& solver : solvers)
    rivals.all.push_back(choose(solver, rivals.by_solver[solver]));
  rivals.work = common_work(rivals.all);
  for (const std::string& scene : scenes)
    rivals.scenes.push_back(quote(scene, rivals.all, rivals.work));
  return rivals;
}

}  // namespace taut::report
