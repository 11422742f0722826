#include "experiments/report/stored.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/study/main_job.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

/// `of`, with times and values of its column, if the table has it.
TimeSeries column(const Series& table, TimeSeries of) {
  const auto index = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(table.columns, name) - table.columns.begin());
  };
  const std::size_t t = index("t"), y = index(of.value);
  if (t == table.columns.size() || y == table.columns.size()) return of;
  for (const auto& row : table.rows) {
    of.t.push_back(row[t]);
    of.y.push_back(row[y]);
  }
  return of;
}

double strain_floor(const Record& r) {
  const double floor = value_of(r, kStrainFloor);
  return std::isfinite(floor) ? floor : 0;
}

/// Series of the quoted cases of a scene.
std::vector<TimeSeries> series_of(const QuotedScene& quoted, const ComparedSolvers& compared,
                                  const Store& store) {
  std::vector<TimeSeries> all;
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    if (!quoted.cases[i]) continue;
    const Record& r = *quoted.cases[i];
    for (TimeSeries& series : shown_series(
             store.series(r.key),
             {r.scene, r.solver, compared.all[i].label, "", {}, {}, r.key, strain_floor(r)}))
      all.push_back(std::move(series));
  }
  return all;
}

/// A record without the parts that only quoted cases need (complete_quoted()).
Record slim(Record r) {
  r.digest = std::string();
  r.log = std::string();
  r.step_cost = std::vector<PassCost>();  // `= {}` would keep its memory
  std::erase_if(r.resolved_settings,
                [](const ResolvedSetting& one) { return one.name != kStrainFloor; });
  r.resolved_settings.shrink_to_fit();
  std::erase_if(r.values, [](const auto& value) { return !std::isfinite(value.second); });
  return r;
}

/// Restores passes and settings of the cases whose settings the page compares.
void complete_quoted(ReportInput& input, const Store& store) {
  std::set<const Record*> quoted;
  for (const QuotedScene& scene : compared_solvers_of(input).scenes)
    quoted.insert(scene.cases.begin(), scene.cases.end());
  for (StudyResult& study : input.studies)
    for (Record& r : study.records)
      if (quoted.contains(&r))
        if (const std::optional<Record> whole = store.find(r.key)) {
          r.step_cost = whole->step_cost;
          r.resolved_settings = whole->resolved_settings;
        }
}

}  // namespace

void keep_roles(Record& r) {
  static const std::vector<const ValueSpec*> roles = values_with_role();
  std::map<std::string, double> kept;
  for (const ValueSpec* value : roles)
    for (const std::string_view name : {value->name, value->floor.value})
      kept.insert(r.values.extract(std::string(name)));
  r.values = std::move(kept);
}

std::vector<TimeSeries> shown_series(const Series& table, const TimeSeries& of) {
  std::vector<TimeSeries> all;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values) {
      if (!value.shown_over_time) continue;
      TimeSeries series = of;
      series.value = value.name;
      series = column(table, std::move(series));
      if (series.t.size() > 1) all.push_back(std::move(series));
    }
  return all;
}

void keep_current(StudyBench& bench) {
  CaseMaker maker;
  for (SceneBench& scene : bench.scenes)
    std::erase_if(scene.cases, [&](const BenchedCase& c) {
      try {
        const Case one = maker.make(c.record.spec);
        if (!scene.limits) scene.limits = default_limits(*one.scene);
        return one.key != c.record.key;
      } catch (const InputError&) {
        return true;  // the scene or the solver no longer exists
      }
    });
  std::erase_if(bench.scenes, [](const SceneBench& scene) { return scene.cases.empty(); });
}

namespace {

std::string name_of(const CaseSpec& spec) {
  return spec.scene + "\n" + spec.solver + "\n" + join(spec.settings, "\n", &SceneSetting::text);
}

/// All records. If several builds ran a case, the record stored last.
std::vector<Record> all_records(const Store& store) {
  std::vector<Record> records;
  std::map<std::string, std::size_t> index;
  for (const std::string& key : store.keys()) {
    std::optional<Record> record = store.find(key);
    if (!record) continue;
    const auto [at, fresh] = index.try_emplace(name_of(record->spec), records.size());
    if (fresh) records.emplace_back();
    records[at->second] = slim(std::move(*record));
  }
  return records;
}

using Names = std::map<std::string, std::set<std::string>>;

Names parameters_of(const std::vector<Record>& records) {
  Names names;
  for (const Record& r : records)
    for (const auto& [name, value] : r.params) names[r.solver].insert(name);
  return names;
}

/// Cases by name, ignoring parameters that only one of the folders knows; nullptr where two share a
/// name.
template <class T, class RecordOf>
std::map<std::string, T*> by_question(std::vector<T>& all, const Names& known, RecordOf record_of) {
  std::map<std::string, T*> index;
  for (T& one : all) {
    const Record& r = std::invoke(record_of, one);
    std::string name = r.scene + "\n" + r.solver;
    for (const SceneSetting& setting : r.spec.settings) name += "\n" + setting.text();
    const auto names = known.find(r.solver);
    for (const auto& [param, value] : r.params)
      if (names != known.end() && names->second.contains(param)) name += "\n" + param + "=" + value;
    const auto [at, fresh] = index.try_emplace(name, &one);
    if (!fresh) at->second = nullptr;  // only a parameter that one build knows distinguishes them
  }
  return index;
}

/// Timed cases by host and processor; `noise` grows to the largest deviation of a control.
std::map<std::string, std::vector<BenchedCase>> all_timed(const Store& store, double& noise) {
  std::map<std::string, std::vector<BenchedCase>> all;
  for (const StudyBench& session : stored_benches(store, "")) {
    std::vector<BenchedCase>& here = all[session.host + ", " + session.machine];
    for (const SceneBench& scene : session.scenes) {
      if (!scene.in_turns) continue;  // its noise is unknown
      noise = std::max(noise, spread(scene.control));
      here.insert(here.end(), scene.cases.begin(), scene.cases.end());
    }
  }
  return all;
}

}  // namespace

Differences stored_differences(const Store& a, const Store& b) {
  Differences found{a.root().string(), b.root().string(), {}, {}, 0, 0, 0};
  std::vector<Record> in_a = all_records(a), in_b = all_records(b);
  Names names = parameters_of(in_a);
  const Names other = parameters_of(in_b);
  for (auto& [solver, own] : names)
    std::erase_if(own, [&, &solver = solver](const std::string& name) {
      return !other.contains(solver) || !other.at(solver).contains(name);
    });
  const std::identity itself;
  const auto of_a = by_question(in_a, names, itself), of_b = by_question(in_b, names, itself);
  for (const auto& [name, record] : of_a)
    if (const auto at = of_b.find(name); record && at != of_b.end() && at->second)
      found.pairs.emplace_back(std::move(*record), std::move(*at->second));
  found.only_a = in_a.size() - found.pairs.size();
  found.only_b = in_b.size() - found.pairs.size();
  auto timed_a = all_timed(a, found.noise), timed_b = all_timed(b, found.noise);
  for (auto& [host, in_b_here] : timed_b) {
    const auto same = timed_a.find(host);
    if (same == timed_a.end()) continue;  // times of different hosts are not compared
    const auto costs = by_question(in_b_here, names, &BenchedCase::record);
    for (const auto& [name, one] : by_question(same->second, names, &BenchedCase::record))
      if (const auto at = costs.find(name); one && at != costs.end() && at->second)
        found.timed.emplace_back(*one, *at->second);
  }
  return found;
}

ReportInput stored_anywhere(const std::vector<Study>& studies, const Store& store) {
  ReportInput input;
  const std::vector<Record> all = all_records(store);
  std::map<std::string, const Record*> by_name;
  for (const Record& r : all) by_name[name_of(r.spec)] = &r;
  for (const Study& study : studies) {
    StudyResult result{study.name, study.question, {}, 0, {}};
    for (const Case& one : cases_of(study))
      if (const auto at = by_name.find(name_of(one.spec)); at != by_name.end())
        result.records.push_back(*at->second);
    if (!result.records.empty()) input.studies.push_back(std::move(result));
  }
  if (input.studies.empty() && !all.empty())
    input.studies.push_back({"stored", "All cases of " + store.root().string(), all, 0, {}});
  complete_quoted(input, store);
  return input;
}

std::optional<double> theory_slope(const Scene& scene) {
  const bool bends = std::ranges::any_of(
      scene.links, [](const Link& link) { return link.family == Family::bend; });
  if (scene.pins.empty() || !scene.pin_motions.empty() || !scene.releases.empty() ||
      !scene.colliders.empty() || scene.wind || scene.self_collision || scene.bending ||
      scene.membrane || bends || !elastic_links(scene).empty())
    return std::nullopt;
  return -1;
}

namespace {

/// Calls `visit` for each planned case, with its record if the store has one.
template <class Visit>
void each_record(const Study& study, const Store& store, const Visit& visit) {
  each_case(study, [&](Case&& one) {
    std::optional<Record> record = store.find(one);
    if (record) record = slim(std::move(*record));
    visit(one, std::move(record));
  });
}

}  // namespace

void add_stored_maps(ReportInput& input, const std::vector<Study>& studies, const Store& store) {
  for (const Study& study : studies) {
    const auto plot = std::ranges::find(study.plots, "stability", &Plot::kind);
    if (plot == study.plots.end() || study.axes.size() != 2) continue;
    const auto axis = [&](const char* name, const char* otherwise) {
      const auto option = plot->options.find(name);
      return option == plot->options.end() ? std::string(otherwise) : option->second;
    };
    MapResult map{study.name, study.question, axis("x", "dt"), axis("y", kSweeps), {}};
    const auto held = std::ranges::find(input.studies, study.name, &StudyResult::name);
    if (held == input.studies.end())
      each_record(study, store, [&](const Case&, std::optional<Record> record) {
        if (record) map.records.push_back(std::move(*record));
      });
    if (held != input.studies.end() ? !held->records.empty() : !map.records.empty())
      input.maps.push_back(std::move(map));
  }
}

std::vector<TimeSeries> stored_series(const Records& records, const std::string& value,
                                      const Store& store) {
  std::vector<TimeSeries> all;
  const SettingLabels labels(records);
  for (const Record* r : records) {
    const std::string label = titled(r->solver, labels.of(*r));
    TimeSeries series =
        column(store.series(r->key),
               {r->scene, r->solver, label, value, {}, {}, r->key, strain_floor(*r)});
    if (series.t.size() > 1) all.push_back(std::move(series));
  }
  return all;
}

namespace {

/// Adds the newest bench of the study itself, or of the main job's bench study.
void add_bench(ReportInput& input, const std::vector<Study>& studies, const Store& store) {
  std::vector<std::string> benched;
  if (studies.size() == 1) benched.push_back(studies.front().name);
  benched.push_back(main_job().bench);
  for (const std::string& name : benched) {
    if (input.bench) break;
    try {
      for (StudyBench& bench : stored_benches(store, name)) {
        keep_current(bench);
        if (bench.scenes.empty()) continue;
        input.cost_hosts.push_back(bench.host + ", program " + bench.build.substr(0, 10) + ": " +
                                   bench.machine +
                                   (input.bench ? "; not shown and not pooled" : "; shown"));
        if (!input.bench) input.bench = std::move(bench);
      }
    } catch (const InputError& error) {
      input.left_out.emplace_back("the costs of " + name, error.what());
    }
  }
}

/// Adds the cases of a study, with values that a bench measured for them.
void add_study(ReportInput& input, const Study& study, const Store& store,
               const std::map<std::string, std::map<std::string, double>>& timed) {
  StudyResult result{study.name, study.question, {}, 0, {}};
  each_record(study, store, [&](const Case& one, std::optional<Record> record) {
    ++result.planned;
    if (std::ranges::find(input.scenes, one.scene->name, &SceneInfo::name) == input.scenes.end())
      input.scenes.push_back({one.scene->name, one.scene->summary});
    if (const auto slope = theory_slope(*one.scene)) result.slopes[one.scene->name] = *slope;
    if (!record) return;
    const std::size_t place = result.records.size();
    if (place == kMostCases) std::ranges::for_each(result.records, keep_roles);
    if (place >= kMostCases) keep_roles(*record);
    if (const auto at = timed.find(record->key); at != timed.end())
      record->values.insert(at->second.begin(), at->second.end());
    result.records.push_back(std::move(*record));
  });
  input.studies.push_back(std::move(result));
}

}  // namespace

ReportInput stored_results(const std::vector<Study>& studies, const Store& store) {
  ReportInput input;
  add_bench(input, studies, store);
  for (const Missing& one : store.still_missing())
    input.left_out.emplace_back(store.file().string(), one.sentence());
  std::map<std::string, std::map<std::string, double>> timed;  // by key
  if (input.bench) {
    for (const Record& r : input.bench->records()) timed[r.key] = r.values;
    // Cases that were not timed in turns only contribute values; no comparison is based on them.
    std::erase_if(input.bench->scenes, [](const SceneBench& scene) { return !scene.in_turns; });
    if (input.bench->scenes.empty()) input.bench.reset();
  }
  for (const Study& study : studies) add_study(input, study, store, timed);
  complete_quoted(input, store);
  input.spent = store.spent();
  const ComparedSolvers compared = compared_solvers_of(input);
  for (const QuotedScene& quoted : compared.scenes)
    for (TimeSeries& series : series_of(quoted, compared, store))
      input.series.push_back(std::move(series));
  return input;
}

}  // namespace taut::report
