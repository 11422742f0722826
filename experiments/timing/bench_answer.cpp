#include "experiments/timing/bench_answer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/answer/number.hpp"
#include "experiments/timing/recommendation.hpp"

namespace taut {

namespace {

/// "clearly cheaper", "likely dearer", "no difference", ...
std::string verdict(const Interval& ratio, const Interval& control, double tolerance) {
  const Certainty sure = judge(ratio, control, tolerance);
  if (sure == Certainty::too_noisy) return "too noisy to judge";
  if (sure == Certainty::none) return "no difference";
  return std::string(sure == Certainty::clear ? "clearly " : "likely ") +
         (ratio.mid < 1 ? "cheaper" : "dearer");
}

/// A table with the control of each scene: the same code timed against itself.
Table controls_of(const StudyBench& bench, double tolerance) {
  Table table{"scenes", "", {{"scene"}, {"control", "the same code against itself"}, {"verdict"}}};
  for (const SceneBench& scene : bench.scenes)
    table.rows.push_back({scene.scene, scene.control,
                          std::isnan(scene.control.mid)       ? "no case could be timed"
                          : spread(scene.control) > tolerance ? "this machine is too noisy now"
                                                              : "quiet enough"});
  return table;
}

std::string metric_of(const SceneBench& scene, const BenchReport& report) {
  return report.metric.empty() ? scene.deciding_metric() : report.metric;
}

/// A table of the cheapest solver for each error and the most accurate one for each budget.
Table recommended_of(const StudyBench& bench, const BenchReport& report) {
  Table table = recommendations(report.metric.empty() ? kVerdict : report.metric);
  for (const SceneBench& scene : bench.scenes) {
    const std::string metric = metric_of(scene, report);
    std::vector<Target> targets;
    for (const double level : report.levels.empty() ? levels_of(metric) : report.levels)
      targets.push_back({level, {}});
    for (const double budget : kFrameBudgets) targets.push_back({{}, budget / kFrame});
    for (const Target& target : targets)
      add(table, recommend(scene, target, metric, report.tolerance), scene, metric);
  }
  return table;
}

/// A table of all cases, each compared with the first of its scene that was timed.
Table cases_of(const StudyBench& bench, const BenchReport& report) {
  Table table{"cases",
              "what was timed",
              {{"scene"},
               {"case"},
               {"solver"},
               {"cost", "CPU time a simulated s", {Unit::Kind::other, "s/s", "ms", 1e3}},
               {"cpu", "CPU time a step", kMilliseconds},
               {"wall", "wall time", kMilliseconds},
               {"peak_bytes", "process", kMegabytes},
               {"error", report.metric.empty() ? "error" : report.metric,
                unit_of_value(report.metric.empty() ? kVerdict : report.metric)},
               {"status"},
               {"times", "times the first"},
               {"verdict"},
               {"remark"}}};
  for (const SceneBench& scene : bench.scenes) {
    const std::string metric = metric_of(scene, report);
    const auto timed = [](const BenchedCase& c) { return c.timing.failure.empty(); };
    const auto first =
        static_cast<std::size_t>(std::ranges::find_if(scene.cases, timed) - scene.cases.begin());
    for (std::size_t i = 0; i < scene.cases.size(); ++i) {
      const auto& [record, timing] = scene.cases[i];
      Cell id(record.id), cost, cpu, wall, bytes;
      id.key = record.key;
      if (timing.failure.empty()) {
        cost = scene.cases[i].cost();
        cpu = bootstrap_median(timing.samples);
        wall = median(timing.wall);
        bytes = timing.peak_bytes;
      }
      const auto times = i > first ? scene.ratio(i, first) : std::nullopt;
      table.rows.push_back(
          {scene.scene, id, record.solver, cost, cpu, wall, bytes, error_of(record, metric),
           cell_of(record.status.kind), times,
           times ? verdict(*times, scene.control, report.tolerance) : "",
           timing.failure.empty() ? timing.remark : "not timed: " + timing.failure});
    }
  }
  return table;
}

Table samples_of(const StudyBench& bench) {
  Table table{"samples",
              "samples of a step",
              {{"scene"},
               {"case"},
               {"sample"},
               {"cpu", "CPU time", kMilliseconds},
               {"wall", "wall time", kMilliseconds}}};
  for (const SceneBench& scene : bench.scenes)
    for (const auto& [record, timing] : scene.cases)
      for (std::size_t k = 0; k < timing.samples.size(); ++k)
        table.rows.push_back({scene.scene, record.id, k, timing.samples[k], timing.wall[k]});
  table.detail = true;
  return table;
}

}  // namespace

Answer bench_answer(const StudyBench& bench, const BenchReport& report) {
  Answer answer{"bench", bench.study};
  answer.add(Column("machine").in_detail(), bench.machine);
  answer.add(Column("host").in_detail(), bench.host);
  answer.add(Column("build").in_detail(), bench.build);
  answer.add(controls_of(bench, report.tolerance));
  if (report.of_study) answer.add(recommended_of(bench, report));
  answer.add(cases_of(bench, report)).detail = report.of_study;
  answer.add(samples_of(bench));
  return answer;
}

}  // namespace taut
