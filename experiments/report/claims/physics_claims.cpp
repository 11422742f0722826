#include <algorithm>
#include <cmath>
#include <set>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

/// A map needs at least this many time steps, over at least this range, to have a largest one.
constexpr std::size_t kLeastSteps = 3;
constexpr double kLeastRange = 4;

std::string at_work(const ComparedSolvers& compared) { return " at " + compared.work_text(); }

std::string dt_text(double dt) { return quantity("dt").text(dt, 3); }

/// ", time step 15.6 ms": of these scenes, if it is one for all.
std::string at_step(const ComparedSolvers& compared, const std::vector<std::string>& scenes) {
  std::set<double> steps;
  for (const std::string& title : scenes) steps.insert(compared.quoted(title)->question.dt);
  if (steps.size() == 1) return ", time step " + dt_text(*steps.begin());
  return ", time steps " + dt_text(*steps.begin()) + " to " + dt_text(*steps.rbegin());
}

/// Why a quoted case has no value: "exploded", "was not run like this".
std::string why_none(const Record* r) {
  if (!r) return "was not run like this";
  if (completed(r->status)) return "has no value";
  return "ended as " + std::string(to_string(r->status.kind));
}

/// What all solvers compared have on a scene, or why not.
struct SceneValues {
  std::string scene;                          ///< its title
  std::vector<std::optional<double>> values;  ///< of each solver compared
  std::string lacking;                        ///< "box (Bullet ended as exploded)"; "": nothing
  bool any = false;                           ///< somebody has a value
};

std::vector<SceneValues> look_at_all(const ComparedSolvers& compared, Evidence& evidence) {
  std::vector<SceneValues> all;
  for (const QuotedScene& quoted : compared.scenes) {
    SceneValues here{.scene = quoted.title, .values = {}, .lacking = {}};
    std::string why;
    for (std::size_t i = 0; i < compared.all.size(); ++i) {
      const Record* r = quoted.cases[i];
      here.values.push_back(r ? evidence.look(compared.all[i].label, *r) : std::nullopt);
      here.any = here.any || here.values.back();
      if (!here.values.back())
        why += (why.empty() ? "" : ", ") + compared.all[i].label + " " + why_none(r);
    }
    if (!why.empty()) here.lacking = here.scene + " (" + why + ")";
    all.push_back(std::move(here));
  }
  return all;
}

/// "RMS stretch in the last second"
std::string in_window(const Quantity& q) {
  return q.title +
         (q.window == Window::last_second ? " in the "
          : q.window == Window::run       ? " over the "
                                          : " at the ") +
         std::string(to_string(q.window));
}

/// "stretch" of "stretch.rms", which has all that is said of an error by that name; of further
/// errors of one metric the whole name.
std::string topic(const ValueSpec& error) {
  const MetricEntry& metric = *find_value(error.name).first;
  const bool alone = std::ranges::count(metric.values, Role::error, &ValueSpec::role) == 1;
  return std::string(alone ? metric.name : error.name);
}

/// Who has least of it on which scenes; less than `negligible` counts as that: else a scene in free
/// fall (1e-17 against 1e-13) would have a winner.
std::string winners(const ComparedSolvers& compared, const std::vector<SceneValues>& common,
                    double negligible) {
  std::vector<std::vector<std::string>> least(compared.all.size());
  std::vector<std::string> alike;
  for (const SceneValues& here : common) {
    std::vector<double> v;
    for (const auto& value : here.values) v.push_back(std::max(*value, negligible));
    const auto best = static_cast<std::size_t>(std::ranges::min_element(v) - v.begin());
    std::vector<double> sorted = v;
    std::ranges::sort(sorted);
    if (sorted[1] < (1 + kTolerance) * sorted[0])
      alike.push_back(here.scene);
    else
      least[best].push_back(here.scene);
  }
  std::string text;
  const std::string word = compared.all.size() > 2 ? " Least" : " Less";
  for (std::size_t i = 0; i < compared.all.size(); ++i)
    text += sentence_if(word + " with " + compared.all[i].label + " on ", least[i]);
  return text + sentence_if(compared.all.size() > 2 ? " The two least within 5\u00A0% on "
                                                    : " Within 5\u00A0% of each other on ",
                            alike);
}

void claim_error(const ComparedSolvers& compared, const ValueSpec& error,
                 std::vector<Claim>& claims) {
  const std::string metric(error.name);
  const Quantity q = quantity(metric);
  const double nothing = error.negligible;
  Evidence evidence(metric, "geometric mean over scenes; less than " + q.text(nothing, 1) +
                                " counts as " + q.text(nothing, 1));
  std::vector<SceneValues> common;
  std::vector<std::string> names, below, lacking;
  for (const SceneValues& here : look_at_all(compared, evidence)) {
    if (!here.lacking.empty()) {
      lacking.push_back(here.lacking);
    } else if (std::ranges::all_of(here.values, [&](const auto& v) { return *v < nothing; })) {
      below.push_back(here.scene);
    } else {
      common.push_back(here);
      names.push_back(here.scene);
    }
  }
  if (evidence.seen().empty()) return;
  const std::string opening = capitalised(in_window(q)) + at_work(compared);
  const std::string rest = sentence_if(" Below " + q.text(nothing, 1) + " with all on ", below) +
                           sentence_if(" Left out: ", lacking);
  if (!lacking.empty()) evidence.leave_out("Left out: " + joined(lacking) + ".");
  if (common.empty()) {
    claims.emplace_back(topic(error), ClaimKind::headline, "all",
                        opening + ": no scene has a value above that of every solver." + rest,
                        Certainty::single_run, std::vector{evidence});
    claims.back().quotes = true;
    return;
  }
  std::vector<Bar> bars;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < compared.all.size(); ++i) {
    std::vector<double> values;
    for (const SceneValues& here : common) values.push_back(std::max(*here.values[i], nothing));
    const double mean = geometric_mean(values);
    bars.push_back({compared.all[i].name, compared.all[i].label, mean, {}, q.text(mean)});
    parts.push_back(q.text(mean) + " with " + compared.all[i].label);
  }
  Claim claim(topic(error), ClaimKind::headline, "all",
              opening + at_step(compared, names) + ", geometric mean over " + joined(names) + ": " +
                  joined(parts) + "." +
                  (bars.size() > 1 ? winners(compared, common, nothing) : "") + rest,
              Certainty::single_run, {evidence});
  claim.strong = parts, claim.quotes = true;
  claims.push_back(claim);
  claims.push_back(claim.tile(capitalised(q.title) + ", " + std::string(to_string(q.window)),
                              "Geometric mean over " + joined(names) + at_work(compared) + ".",
                              bars));
}

/// Penetration: how deep, and how often through.
bool of_depth(const ValueSpec& value) {
  return value.role == Role::vertex_depth || value.role == Role::face_depth ||
         value.role == Role::passages;
}

/// What follows such a number in a sentence.
std::string place_of(Role role) {
  return role == Role::vertex_depth ? " at a vertex"
         : role == Role::face_depth ? " at a face"
                                    : " passages of vertices through a collider";
}

/// The largest of one solver over scenes on which all have the value.
struct Deepest {
  double value = -1;  ///< m; < 0: none
  std::string scene;
};

void claim_depth(const ComparedSolvers& compared, std::vector<Claim>& claims) {
  const std::size_t n = compared.all.size();
  std::vector<Evidence> basis;
  std::vector<Deepest> deepest[2]{std::vector<Deepest>(n), std::vector<Deepest>(n)};
  std::vector<double> passages(n);
  std::set<std::string> counted;
  std::vector<std::string> names, lacking;
  bool passages_known = false;
  for (const ValueSpec* value : values_with_role()) {
    if (!of_depth(*value)) continue;
    const std::string metric(value->name);
    const bool sum = value->role == Role::passages;
    Evidence evidence(metric, sum ? "sum over scenes" : "largest over scenes");
    Evidence all_of_it = evidence;  // scenes without colliders are no evidence
    for (const SceneValues& here : look_at_all(compared, all_of_it)) {
      if (!here.any) continue;
      const QuotedScene& quoted = *compared.quoted(here.scene);
      for (std::size_t i = 0; i < n; ++i)
        if (quoted.cases[i]) evidence.look(compared.all[i].label, *quoted.cases[i]);
      if (!here.lacking.empty()) {
        // A case that failed lacks all three: it is said once.
        const bool only_here = here.lacking.find("has no value") != std::string::npos;
        const std::string what = (only_here ? quantity(metric).title + " on " : "") + here.lacking;
        push_unique(lacking, what);
        continue;
      }
      if (counted.insert(here.scene).second) names.push_back(here.scene);
      for (std::size_t i = 0; i < n; ++i) {
        if (sum) passages[i] += *here.values[i], passages_known = true;
        Deepest& d = deepest[value->role == Role::face_depth][i];
        if (!sum && *here.values[i] > d.value) d = {*here.values[i], here.scene};
      }
    }
    if (!evidence.seen().empty()) basis.push_back(std::move(evidence));
  }
  if (basis.empty()) return;
  const std::string rest = sentence_if(" Left out: ", lacking);
  if (!lacking.empty()) basis.front().leave_out("Left out: " + joined(lacking) + ".");
  const std::string opening = "Peak penetration over the whole run" + at_work(compared);
  if (names.empty()) {
    claims.emplace_back("depth", ClaimKind::headline, "all",
                        opening + ": no scene has a value of every solver." + rest,
                        Certainty::single_run, basis);
    claims.back().quotes = true;
    return;
  }
  std::string text;
  std::vector<Bar> bars;
  for (std::size_t i = 0; i < n; ++i) {
    text += (i > 0 ? "; " : "") + compared.all[i].label;
    Bar bar{compared.all[i].name, compared.all[i].label, {}, {}, ""};
    bool said = false;
    for (std::size_t k = 0; k < 2; ++k) {
      const Deepest& d = deepest[k][i];
      if (d.value < 0) continue;
      const std::string one =
          shown(kErrorLength, d.value) + place_of(k == 0 ? Role::vertex_depth : Role::face_depth);
      text += (said ? " and " : " ") + one + (d.value > 0 ? " (" + d.scene + ")" : ""), said = true;
      if (d.value >= bar.value.value_or(0)) bar.value = d.value, bar.text = one;
    }
    bars.push_back(std::move(bar));
  }
  if (deepest[1].front().value < 0) text += "; faces were not measured";
  if (passages_known) {
    text += "; passages of vertices through a collider:";
    for (std::size_t i = 0; i < n; ++i)
      text += (i > 0 ? ", " : " ") + compared.all[i].label + " " + exact(passages[i]);
  }
  Claim claim("depth", ClaimKind::headline, "all",
              opening + at_step(compared, names) + ", deepest of " + joined(names) + ": " + text +
                  "." + rest,
              Certainty::single_run, basis);
  claim.quotes = true;
  claims.push_back(claim);
  claims.push_back(claim.tile("Peak penetration, vertices and faces",
                              "Whole run, deepest of " + joined(names) + at_work(compared) + ".",
                              bars));
}

/// A case as it is asked of every solver, the time step apart.
using Column = std::pair<std::vector<std::string>, Work>;

/// Which time steps every solver tried in which columns on one scene, and how each case ended.
struct StepMap {
  std::set<double> steps;
  std::set<Work> works;
  std::vector<std::map<double, std::vector<const Record*>>> cases;  ///< [solver][time step]
};

StepMap step_map(const std::vector<const ComparedSolver*>& compared, const std::string& scene) {
  std::vector<std::map<std::pair<double, Column>, const Record*>> tried(compared.size());
  for (std::size_t i = 0; i < compared.size(); ++i)
    for (const Record* r : compared[i]->cases)
      if (r->scene == scene)
        tried[i].try_emplace({r->dt, {question_of(*r).overrides, work_of(*r)}}, r);
  StepMap map;
  map.cases.resize(compared.size());
  std::map<Column, std::set<double>> columns;
  for (const auto& [at, record] : tried.front())
    if (std::ranges::all_of(tried, [&, at = at](const auto& own) { return own.contains(at); }))
      columns[at.second].insert(at.first);
  for (const auto& [column, steps] : columns) {
    if (steps.size() < kLeastSteps || *steps.rbegin() < kLeastRange * *steps.begin()) continue;
    map.works.insert(column.second);
    for (const double dt : steps) {
      map.steps.insert(dt);
      for (std::size_t i = 0; i < compared.size(); ++i)
        map.cases[i][dt].push_back(tried[i].at({dt, column}));
    }
  }
  return map;
}

/// The largest step up to which (itself included) every case completed; 0: the smallest failed.
double largest_stable(const std::map<double, std::vector<const Record*>>& cases) {
  double largest = 0;
  for (const auto& [dt, records] : cases) {
    if (!std::ranges::all_of(records, [](const Record* r) { return completed(r->status); })) break;
    largest = dt;
  }
  return largest;
}

void claim_step(const ComparedSolvers& compared, std::vector<Claim>& claims) {
  std::vector<const ComparedSolver*> with_sweeps;
  for (const ComparedSolver& solver : compared.all)
    if (std::ranges::any_of(solver.cases, [](const Record* r) { return work_of(*r).sweeps > 0; }))
      with_sweeps.push_back(&solver);
  if (with_sweeps.empty()) return;
  Evidence evidence("dt",
                    "largest time step up to which every case completed, over all the work "
                    "that every solver tried");
  std::vector<std::pair<std::string, std::vector<std::string>>> clauses;  // with their scenes
  std::vector<std::vector<double>> found(with_sweeps.size());
  std::vector<std::string> names;
  bool limited = false, none = false;
  for (const QuotedScene& quoted : compared.scenes) {
    const std::string& scene = quoted.question.scene;
    const StepMap map = step_map(with_sweeps, scene);
    if (map.steps.size() < kLeastSteps) continue;
    names.push_back(scene);
    std::vector<std::string> works, parts;
    for (const Work& work : map.works) works.push_back(work.text());
    for (std::size_t i = 0; i < with_sweeps.size(); ++i) {
      for (const auto& [dt, records] : map.cases[i])
        for (const Record* r : records) evidence.look(with_sweeps[i]->label, *r);
      const double largest = largest_stable(map.cases[i]);
      const bool all = largest == *map.steps.rbegin();
      limited = limited || !all, none = none || largest == 0;
      found[i].push_back(largest);
      parts.push_back(
          with_sweeps[i]->label + " " +
          (largest == 0 ? "none" : dt_text(largest) + (all ? " (the largest tried)" : "")));
    }
    const std::string clause = " (" + dt_text(*map.steps.begin()) + " to " +
                               dt_text(*map.steps.rbegin()) + " tried, each at " + joined(works) +
                               ") " + joined(parts);
    const auto same = std::ranges::find(clauses, clause, [](const auto& c) { return c.first; });
    if (same == clauses.end())
      clauses.push_back({clause, {scene}});
    else
      same->second.push_back(scene);
  }
  if (clauses.empty()) return;
  std::string text = join(clauses, "; ", [](const auto& clause) {
    return "on " + joined(clause.second) + clause.first;
  });
  std::vector<Bar> bars;
  std::vector<std::string> means;
  for (std::size_t i = 0; i < with_sweeps.size() && !none; ++i) {
    const double mean = geometric_mean(found[i]);
    bars.push_back({with_sweeps[i]->name, with_sweeps[i]->label, mean, {}, dt_text(mean)});
    means.push_back(with_sweeps[i]->label + " " + dt_text(mean));
  }
  if (clauses.size() > 1 && !none) text += "; geometric mean over these scenes " + joined(means);
  const Claim claim("step", ClaimKind::headline, "all",
                    "Largest time step up to which every case completed: " + text + ".",
                    Certainty::single_run, {evidence});
  claims.push_back(claim);
  if (!none)
    claims.push_back(
        claim.tile(limited ? "Largest stable time step" : "No time step that was tried failed",
                   "Up to it every case completed on " + joined(names) +
                       ", with all substeps and sweeps that every solver tried" +
                       (names.size() > 1 ? "; geometric mean." : "."),
                   bars));
}

void claim_failures(const ComparedSolvers& compared, std::vector<Claim>& claims) {
  Evidence evidence("steps", "count of cases by status, all settings");
  std::vector<std::string> parts, refused;
  for (const ComparedSolver& solver : compared.all) {
    const std::vector<const Record*>& cases = compared.by_solver.at(solver.name);
    std::map<std::string, int> failed;
    int failures = 0, unsupported = 0;
    const std::string name = solver_title(solver.name);
    for (const Record* r : cases) {
      evidence.look(name, *r);
      if (r->status.kind == Status::Kind::unsupported) ++unsupported;
      if (completed(r->status) || r->status.kind == Status::Kind::unsupported) continue;
      ++failures, ++failed[std::string(to_string(r->status.kind))];
    }
    const std::string kinds = join(failed, ", ", [](const auto& kind) {
      return std::to_string(kind.second) + " " + kind.first;
    });
    parts.push_back(name + " " + (failures == 0 ? "none" : std::to_string(failures)) + " of " +
                    std::to_string(cases.size()) + (kinds.empty() ? "" : " (" + kinds + ")"));
    if (unsupported > 0) refused.push_back(name + " " + std::to_string(unsupported));
  }
  if (evidence.seen().empty()) return;
  claims.emplace_back("failures", ClaimKind::headline, "failures",
                      "Cases that failed: " + joined(parts) + "." +
                          sentence_if(compared.studies.size() == 1 ? " Counted in the study "
                                                                   : " Counted in the studies ",
                                      compared.studies) +
                          sentence_if(" Not supported: ", refused),
                      Certainty::single_run, std::vector{evidence});
}

/// One scene, values side by side, failures by name.
void claim_scene(const ComparedSolvers& compared, const QuotedScene& quoted,
                 std::vector<Claim>& claims) {
  const std::string& scene = quoted.question.scene;
  const std::string at = (quoted.title == scene ? "" : " on " + quoted.title) + at_work(compared) +
                         ", time step " + dt_text(quoted.question.dt);
  const auto side_by_side = [&](const std::string& id, const std::string& opening,
                                const std::vector<std::pair<std::string, std::string>>& values) {
    std::vector<Evidence> basis;
    std::vector<std::string> parts(compared.all.size());
    bool any = false;
    for (const auto& [metric, suffix] : values) {
      const Quantity q = quantity(metric);
      Evidence evidence(metric, "values side by side");
      bool here = false;
      for (std::size_t i = 0; i < compared.all.size(); ++i) {
        if (!quoted.cases[i]) continue;
        const auto value = evidence.look(compared.all[i].label, *quoted.cases[i]);
        if (value) parts[i] += (parts[i].empty() ? " " : ", ") + q.text(*value) + suffix;
        here = here || value;
      }
      any = any || here;
      if (here) basis.push_back(std::move(evidence));
    }
    if (!any) return;
    std::string text;
    for (std::size_t i = 0; i < parts.size(); ++i)
      text += (i > 0 ? "; " : "") + compared.all[i].label +
              (parts[i].empty() ? " " + why_none(quoted.cases[i]) : parts[i]);
    claims.emplace_back(id + "-" + scene, ClaimKind::note, scene, opening + at + ": " + text + ".",
                        Certainty::single_run, basis);
    claims.back().quotes = true;
  };
  std::vector<std::pair<std::string, std::string>> depths;
  for (const ValueSpec* value : values_with_role()) {
    const std::string name(value->name);
    if (value->role == Role::error)
      side_by_side(topic(*value), capitalised(in_window(quantity(name))), {{name, ""}});
    if (of_depth(*value)) depths.emplace_back(name, place_of(value->role));
  }
  side_by_side("depth", "Peak penetration over the whole run", depths);
}

}  // namespace

std::vector<Claim> physics_claims(const ComparedSolvers& compared) {
  std::vector<Claim> claims;
  if (compared.all.empty()) return claims;
  for (const ValueSpec* value : values_with_role())
    if (value->role == Role::error) claim_error(compared, *value, claims);
  claim_depth(compared, claims);
  claim_step(compared, claims);
  claim_failures(compared, claims);
  for (const QuotedScene& quoted : compared.scenes) claim_scene(compared, quoted, claims);
  return claims;
}

}  // namespace taut::report
