#include "experiments/timing/study_bench.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <tuple>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/task.hpp"
#include "experiments/results/database.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

/// Digest over everything that the file holds about a scene's bench.
class DigestedBench {
 public:
  DigestedBench(const StudyBench& study, const SceneBench& scene) {
    for (const std::string& text : {study.study, study.host, study.build, scene.scene}) add(text);
    add(scene.in_turns ? "in turns" : "");
    for (double ratio : {scene.control.low, scene.control.mid, scene.control.high}) add(ratio);
  }
  void add(const std::string& key, const Timing& timing) {
    for (const std::string& text :
         {key, timing.failure, timing.remark, std::to_string(timing.peak_bytes)})
      add(text);
    for (double seconds : timing.samples) add(seconds);
    for (double seconds : timing.wall) add(seconds);
  }
  std::string digest() const { return sha256(all_); }

 private:
  void add(std::string_view text) { all_.append(text).append(1, '\0'); }
  void add(double number) {  // NaN is stored as NULL
    if (!std::isnan(number)) all_.append(reinterpret_cast<const char*>(&number), sizeof number);
    add("");
  }
  std::string all_;
};

/// A timing with its samples.
Timing timing_in(Database& database, const Database::Rows& row) {
  Timing timing{.peak_bytes = static_cast<std::size_t>(row.integer(2)),
                .failure = row.text(3),
                .remark = row.text(4)};
  Database::Rows sample = database.rows(
      "SELECT cpu, wall FROM samples WHERE timing_id = ? ORDER BY sample", row.integer(0));
  while (sample.next()) {
    timing.samples.push_back(sample.number(0));
    timing.wall.push_back(sample.number(1));
  }
  return timing;
}

/// A scene of a bench, without cases that are no longer stored. If it does not match its digest,
/// reports that and returns it without any cases.
SceneBench scene_in(const Store& store, const StudyBench& study, const Database::Rows& row) {
  SceneBench scene{
      row.text(5), {row.number(7), row.number(8), row.number(9)}, {}, row.integer(6) != 0};
  Database::Rows timed = store.reading()->rows(
      "SELECT timing_id, key, peak_bytes, failure, remark FROM timings WHERE bench_id = ? ORDER BY "
      "timing_id",
      row.integer(0));
  DigestedBench digested(study, scene);
  while (timed.next()) {
    const std::string key = timed.text(1);
    Timing timing = timing_in(*store.reading(), timed);
    digested.add(key, timing);
    if (auto record = store.find(key))
      scene.cases.push_back({std::move(*record), std::move(timing)});
  }
  if (digested.digest() == row.text(10)) return scene;
  store.say_damaged("bench of " + scene.scene + " in " + study.study);
  scene.cases.clear();
  return scene;
}

void insert(Database& database, const StudyBench& study, const SceneBench& scene) {
  DigestedBench digested(study, scene);
  for (const auto& [record, timing] : scene.cases) digested.add(record.key, timing);
  database.run(
      "INSERT INTO benches (study, host, build, machine, made, scene, in_turns, control_low, "
      "control, control_high, digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      study.study, study.host, study.build, study.machine, utc_stamp(), scene.scene,
      static_cast<int>(scene.in_turns), scene.control.low, scene.control.mid, scene.control.high,
      digested.digest());
  const std::int64_t bench = database.number_of("SELECT last_insert_rowid()");
  for (const auto& [record, timing] : scene.cases) {
    database.run(
        "INSERT INTO timings (bench_id, key, peak_bytes, failure, remark) VALUES (?, ?, ?, ?, ?)",
        bench, record.key, timing.peak_bytes, timing.failure, timing.remark);
    const std::int64_t id = database.number_of("SELECT last_insert_rowid()");
    for (std::size_t i = 0; i < timing.samples.size(); ++i)
      database.run("INSERT INTO samples VALUES (?, ?, ?, ?)", id, i, timing.samples[i],
                   timing.wall[i]);
  }
}

}  // namespace

bool BenchedCase::stable() const { return not_timed().empty() && completed(record.status); }

std::string BenchedCase::not_timed() const {
  return !timing.failure.empty() ? timing.failure : timing.samples.empty() ? "not timed" : "";
}

Interval BenchedCase::cost() const { return bootstrap_median(timing.samples) * (1 / record.dt); }

std::vector<Candidate> SceneBench::candidates(const std::string& metric) const {
  std::vector<Candidate> all;
  for (const BenchedCase& c : cases)
    all.push_back(judge(c.record, metric, limits, c.cost(), c.not_timed()));
  return all;
}

std::string SceneBench::deciding_metric() const {
  std::vector<const Record*> records;
  for (const BenchedCase& c : cases) records.push_back(&c.record);
  return taut::deciding_metric(records);
}

std::optional<Interval> SceneBench::ratio(std::size_t i, std::size_t j) const {
  const BenchedCase &a = cases[i], &b = cases[j];
  if (!a.timing.failure.empty() || !b.timing.failure.empty()) return {};
  const std::size_t samples = a.timing.samples.size();
  if (!in_turns || samples != b.timing.samples.size() || samples % 2 != 0) return {};
  return interleaved_ratio(a.timing.samples, b.timing.samples) * (b.record.dt / a.record.dt);
}

std::vector<ParameterRange> SceneBench::parameter_ranges(const std::string& solver) const {
  const auto entry = std::ranges::find(solvers(), solver, &SolverEntry::name);
  if (entry == solvers().end()) return {};
  std::vector<ParameterRange> ranges;
  const AccuracyParameters& accuracy = (*entry)->accuracy;
  for (const auto& [parameter, end] :
       {std::pair{accuracy.substeps, kMostSubsteps}, std::pair{accuracy.sweeps, kMostSweeps}}) {
    if (parameter.empty()) continue;
    ParameterRange& range = ranges.emplace_back(ParameterRange{std::string(parameter), 0, end});
    for (const BenchedCase& c : cases)
      if (const auto at = c.record.params.find(range.parameter);
          c.record.solver == solver && at != c.record.params.end())
        range.largest = std::max(range.largest, std::atoi(at->second.c_str()));
  }
  return ranges;
}

bool SceneBench::searched_to_the_end(const std::string& solver) const {
  const std::vector<ParameterRange> ranges = parameter_ranges(solver);
  return !ranges.empty() &&
         std::ranges::all_of(ranges, [](const ParameterRange& r) { return r.largest >= r.end; });
}

SceneBench bench_scene(const std::string& scene, const std::vector<Record>& records,
                       const std::vector<Limit>& limits, const TimingOptions& options) {
  std::vector<CaseToTime> cases;
  for (const Record& record : records) cases.push_back({record.spec, steps_done(record)});
  TimingSession bench = time_cases(cases, options);
  SceneBench result{.scene = scene, .control = bench.control, .cases = {}, .limits = limits};
  for (std::size_t i = 0; i < records.size(); ++i)
    result.cases.push_back({records[i], std::move(bench.timings[i])});
  return result;
}

namespace {

/// Groups records by scene and its settings, in order of appearance. Leaves out cases that a solver
/// refuses.
std::vector<std::pair<std::string, std::vector<Record>>> by_scene(
    const std::vector<Record>& records) {
  std::set<Task> asked;
  for (const Record& record : records) asked.insert(task_of(record));
  std::vector<std::pair<std::string, std::vector<Record>>> groups;
  for (const Record& record : records) {
    if (record.status.kind == Status::Kind::unsupported) continue;
    group_of(groups, title_among(task_of(record), asked)).push_back(record);
  }
  return groups;
}

}  // namespace

StudyBench bench_study(
    const std::string& name, const std::vector<Record>& records,
    const std::function<TimingOptions(const std::string& scene, std::size_t cases)>& options_of) {
  StudyBench result = StudyBench::here(name);
  CaseMaker maker;
  for (const auto& [scene, own] : by_scene(records)) {
    const auto limits = default_limits(*maker.make(own.front().spec).scene);
    result.scenes.push_back(bench_scene(scene, own, limits, options_of(scene, own.size())));
  }
  return result;
}

std::vector<std::string> solvers_of(const SceneBench& bench) {
  return distinct(bench.cases, [](const BenchedCase& c) { return c.record.solver; });
}

std::vector<Record> StudyBench::records() const {
  std::vector<Record> records;
  for (const SceneBench& scene : scenes)
    for (const BenchedCase& c : scene.cases) {
      records.push_back(c.record);
      if (!c.timing.failure.empty()) continue;
      records.back().values[kCpuPerStep] = median(c.timing.samples);
      records.back().values[kCpuPerSecond] = c.cost().mid;
      records.back().values[kWallPerStep] = median(c.timing.wall);
      records.back().values[kPeakMemory] = static_cast<double>(c.timing.peak_bytes);
    }
  return records;
}

StudyBench StudyBench::here(const std::string& study) {
  return {study, machine_name(), {}, host_name(), program_digest()};
}

void keep(Store& store, const StudyBench& study) {
  Database& database = store.writing();
  database.transaction([&] {
    database.run("DELETE FROM benches WHERE study = ? AND host = ? AND build = ?", study.study,
                 study.host, study.build);
    for (const SceneBench& scene : study.scenes) insert(database, study, scene);
  });
}

std::vector<StudyBench> stored_benches(const Store& store, const std::string& study) {
  std::vector<StudyBench> all;
  Database* database = store.reading();
  if (!database) return all;
  const StudyBench mine = StudyBench::here(study);
  Database::Rows row = database->rows(
      "SELECT bench_id, study, machine, host, build, scene, in_turns, control_low, control, "
      "control_high, digest FROM benches WHERE ?1 IN ('', study) "
      "ORDER BY study, host <> ?2 OR build <> ?3, host <> ?2, host, build, bench_id",
      study, mine.host, mine.build);
  while (row.next()) {
    StudyBench bench{row.text(1), row.text(2), {}, row.text(3), row.text(4)};
    const auto is_of = [&](const StudyBench& b) {
      return std::tie(b.study, b.host, b.build) == std::tie(bench.study, bench.host, bench.build);
    };
    SceneBench scene = scene_in(store, bench, row);
    if (all.empty() || !is_of(all.back())) all.push_back(std::move(bench));
    if (!scene.cases.empty()) all.back().scenes.push_back(std::move(scene));
  }
  std::erase_if(all, [](const StudyBench& bench) { return bench.scenes.empty(); });
  return all;
}

void require_one_quiet_host() {
  const auto number = [](const char* name) {
    const char* text = std::getenv(name);
    return text ? std::atol(text) : 0;
  };
  if (number("SLURM_JOB_NUM_NODES") > 1)
    throw InputError("this Slurm job has " + std::to_string(number("SLURM_JOB_NUM_NODES")) +
                     " nodes; the times of a bench are of one host: sbatch --nodes=1");
  const long cores = sysconf(_SC_NPROCESSORS_ONLN), mine = number("SLURM_CPUS_ON_NODE");
  if (mine > 0 && mine < cores)
    throw InputError("this Slurm job has " + std::to_string(mine) + " of the node's " +
                     std::to_string(cores) +
                     " cores; others would be in the times: sbatch --exclusive");
}

}  // namespace taut
