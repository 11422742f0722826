#include "experiments/report/stored.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/curves.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/quantity.hpp"
#include "experiments/report/claims/rivals.hpp"
#include "experiments/study/missing.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

TimeSeries column(const Series& table, const Record& record, const std::string& label,
                  const std::string& value) {
  TimeSeries series{record.scene, record.solver, label, value, {}, {}, record.key};
  const auto index = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(table.columns, name) - table.columns.begin());
  };
  const std::size_t t = index("t"), y = index(value);
  if (t == table.columns.size() || y == table.columns.size()) return series;
  for (const auto& row : table.rows) {
    series.t.push_back(row[t]);
    series.y.push_back(row[y]);
  }
  return series;
}

/// What a scene shows over time: its own quantities, and stretch.
constexpr const char* kShown[] = {"stretch.rms", "penetration.max", "tunnelling.count",
                                  "slip.distance"};

/// Values over time of the quoted cases of a scene.
std::vector<TimeSeries> series_of(const QuotedScene& quoted, const Rivals& rivals,
                                  const Store& store) {
  std::vector<TimeSeries> all;
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    if (!quoted.cases[i]) continue;
    const Record& r = *quoted.cases[i];
    const Series table = store.series(r.key);
    for (const char* value : kShown) {
      TimeSeries series = column(table, r, rivals.all[i].label, value);
      if (series.t.size() > 1) all.push_back(std::move(series));
    }
  }
  return all;
}

/// The cost of those cases that were also timed, as further values of their records.
void add_costs(const BenchSession& bench, std::vector<Record>& records) {
  std::map<std::string, Record> timed;
  for (const Record& r : bench.records()) timed[r.key] = r;
  for (Record& r : records)
    if (const auto at = timed.find(r.key); at != timed.end())
      for (const auto& [name, value] : at->second.values) r.values.try_emplace(name, value);
}

}  // namespace

std::optional<BenchSession> stored_bench(const std::filesystem::path& file) {
  BenchSession bench = bench_from_json(read_text(file), file.string());
  CaseMaker maker;
  for (SceneBench& scene : bench.scenes)
    std::erase_if(scene.cases, [&](const BenchedCase& c) {
      try {
        return maker.make(c.record.spec).key != c.record.key;
      } catch (const InputError&) {
        return true;  // the scene or the solver is no longer there
      }
    });
  std::erase_if(bench.scenes, [](const SceneBench& scene) { return scene.cases.empty(); });
  if (bench.scenes.empty()) return std::nullopt;
  return bench;
}

std::optional<double> theory_slope(const Scene& scene) {
  const bool bends = std::ranges::any_of(
      scene.links, [](const Link& link) { return link.family == Family::bend; });
  if (scene.pins.empty() || !scene.pin_motions.empty() || !scene.colliders.empty() || scene.wind ||
      scene.self_collision || bends)
    return std::nullopt;
  return -1;
}

std::vector<MapResult> stored_maps(const std::vector<Study>& studies, const Store& store) {
  std::vector<MapResult> maps;
  for (const Study& study : studies) {
    const auto plot = std::ranges::find(study.plots, "stability", &Plot::kind);
    if (plot == study.plots.end() || study.axes.size() != 2) continue;
    const auto axis = [&](const char* name, const char* otherwise) {
      const auto option = plot->options.find(name);
      return option == plot->options.end() ? std::string(otherwise) : option->second;
    };
    MapResult map{study.name, study.question, axis("x", "dt"), axis("y", "iterations"),
                  collect(study, store).records};
    if (!map.records.empty()) maps.push_back(std::move(map));
  }
  return maps;
}

std::vector<TimeSeries> stored_series(std::span<const Record> records, const std::string& value,
                                      const Store& store) {
  std::vector<TimeSeries> all;
  for (const Record& record : records) {
    const std::string knobs = knob_label(record, records);
    const std::string label = solver_title(record.solver) + (knobs.empty() ? "" : " " + knobs);
    TimeSeries series = column(store.series(record.key), record, label, value);
    if (series.t.size() > 1) all.push_back(std::move(series));
  }
  return all;
}

ReportInput stored_results(const std::vector<Study>& studies, const Store& store) {
  ReportInput input;
  std::set<std::string> seen;
  // A study's own bench before that of the main job.
  std::vector<std::string> benched;
  if (studies.size() == 1) benched.push_back(studies.front().name);
  benched.emplace_back("trade");
  for (const std::string& name : benched) {
    if (input.bench) break;
    for (const std::filesystem::path& file : bench_files(store.root(), name)) try {
        std::optional<BenchSession> bench = stored_bench(file);
        if (!bench) continue;
        input.cost_hosts.push_back(
            bench->host + ", build " + bench->build.substr(0, 10) + ": " + bench->machine +
            (input.bench ? "; not shown and not pooled: " : "; shown: ") + file.string());
        if (!input.bench) input.bench = std::move(bench);
      } catch (const InputError& error) {
        input.left_out.emplace_back(file.string(), error.what());
      }
  }
  for (const Missing& one : still_missing(store))
    input.left_out.emplace_back(one.file.string(), one.sentence());
  for (const Study& study : studies) {
    StudyRecords known = collect(study, store);
    if (input.bench) add_costs(*input.bench, known.records);
    StudyResult result{
        study.name, study.question, std::move(known.records), known.cases.size(), {}};
    for (const Case& one : known.cases) {
      if (!seen.insert(one.scene->name).second) continue;
      input.scenes.push_back({one.scene->name, one.scene->summary});
    }
    for (const Case& one : known.cases)
      if (const auto slope = theory_slope(*one.scene)) result.slopes[one.scene->name] = *slope;
    input.studies.push_back(std::move(result));
  }
  const Rivals rivals = rivals_of(input);
  for (const QuotedScene& quoted : rivals.scenes)
    for (TimeSeries& series : series_of(quoted, rivals, store))
      input.series.push_back(std::move(series));
  return input;
}

}  // namespace taut::report
