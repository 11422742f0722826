#include "experiments/timing/study_bench.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/text.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

constexpr int kBenchSchema = 4;

Interval interval_of(const JsonReader& j) {
  const std::vector<JsonReader> ends = j.items(3);
  return {ends[0].number_or_null(), ends[1].number_or_null(), ends[2].number_or_null()};
}

BenchedCase case_of(const JsonReader& j) {
  BenchedCase benched{record_of(j.at("record")), {}};
  benched.timing = {.samples = j.at("cpu_seconds_per_step").numbers(),
                    .wall = j.at("wall_seconds_per_step").numbers(),
                    .peak_bytes = j.at("peak_bytes").count(),
                    .failure = j.at("failure").text(),
                    .remark = j.find("remark") ? j.at("remark").text() : ""};
  const Timing& timing = benched.timing;
  for (const auto* seconds : {&timing.samples, &timing.wall})
    for (const double value : *seconds)
      if (!(value > 0)) j.fail("expected times greater than 0");
  if (timing.failure.empty() && (timing.samples.empty() || timing.wall.empty()))
    j.fail("has neither times nor a failure");
  return benched;
}

StudyBench study_of(const JsonReader& j) {
  j.require_schema(kBenchSchema);
  StudyBench study{
      j.at("study").text(), j.at("machine").text(), {}, j.at("host").text(), j.at("build").text()};
  for (const JsonReader& one : j.at("scenes").items()) {
    SceneBench scene{one.at("scene").text(), {}, {}};
    if ((scene.in_turns = one.find("control").has_value()))
      scene.control = interval_of(one.at("control"));
    for (const JsonReader& c : one.at("cases").items()) scene.cases.push_back(case_of(c));
    study.scenes.push_back(std::move(scene));
  }
  return study;
}

}  // namespace

bool Target::meets(const Candidate& c) const {
  if (!c.failure.empty() || std::isnan(c.error)) return false;
  return error ? c.error <= *error : c.cost.mid <= *budget;
}

bool Target::prefers(const Candidate& a, const Candidate& b) const {
  if (meets(a) != meets(b)) return meets(a);
  const std::pair by_cost_a(a.cost.mid, a.error), by_cost_b(b.cost.mid, b.error);
  const std::pair by_error_a(a.error, a.cost.mid), by_error_b(b.error, b.cost.mid);
  return error ? by_cost_a < by_cost_b : by_error_a < by_error_b;
}

std::optional<std::size_t> best_for(const Target& target, std::span<const Candidate> candidates,
                                    const std::string& solver) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (target.meets(candidates[i]) && (solver.empty() || candidates[i].solver == solver) &&
        (!best || target.prefers(candidates[i], candidates[*best])))
      best = i;
  return best;
}

bool BenchedCase::stable() const {
  return timing.failure.empty() && !timing.samples.empty() && completed(record.status);
}

Interval BenchedCase::cost() const { return bootstrap_median(timing.samples) * (1 / record.dt); }

std::vector<Candidate> SceneBench::candidates(const std::string& metric) const {
  std::vector<Candidate> all;
  for (const BenchedCase& c : cases) {
    std::string failure = c.timing.failure;
    if (failure.empty() && !c.stable()) failure = describe(c.record.status);
    all.push_back({c.record.solver, c.record.spec.solver, c.cost(),
                   std::abs(c.record.value(metric)), failure});
  }
  return all;
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
                       const TimingOptions& options) {
  std::vector<CaseToTime> cases;
  for (const Record& record : records) cases.push_back({record.spec, steps_done(record)});
  TimingSession bench = time_cases(cases, options);
  SceneBench result{scene, bench.control, {}};
  for (std::size_t i = 0; i < records.size(); ++i)
    result.cases.push_back({records[i], std::move(bench.timings[i])});
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
      records.back().values["cpu.per_step"] = median(c.timing.samples);
      records.back().values["cpu.per_second"] = c.cost().mid;
      records.back().values["wall.per_step"] = median(c.timing.wall);
      records.back().values["memory.peak"] = static_cast<double>(c.timing.peak_bytes);
    }
  return records;
}

std::string to_json(const StudyBench& study) {
  Json all{{"schema", kBenchSchema},
           {"study", study.study},
           {"machine", study.machine},
           {"host", study.host},
           {"build", study.build}};
  for (const SceneBench& scene : study.scenes) {
    Json one{{"scene", scene.scene}};
    if (scene.in_turns) one["control"] = scene.control;
    for (const auto& [record, timing] : scene.cases)
      one["cases"].push_back({{"record", parse_json(to_json(record))},
                              {"cpu_seconds_per_step", timing.samples},
                              {"wall_seconds_per_step", timing.wall},
                              {"peak_bytes", timing.peak_bytes},
                              {"failure", timing.failure},
                              {"remark", timing.remark}});
    for (const std::string& solver : solvers_of(scene))
      for (const ParameterRange& range : scene.parameter_ranges(solver))
        one["accuracy_parameters"][solver][range.parameter] = {{"largest", range.largest},
                                                               {"end", range.end}};
    all["scenes"].push_back(std::move(one));
  }
  return to_text(all, 1) + "\n";
}

StudyBench bench_from_json(std::string_view text, const std::string& where) {
  return read_json(text, where, study_of);
}

StudyBench StudyBench::here(const std::string& study) {
  return {study, machine_name(), {}, host_name(), program_digest()};
}

std::filesystem::path bench_file(const std::filesystem::path& results, const StudyBench& study) {
  return results / "bench" / study.study / (study.host + "-" + study.build.substr(0, 10) + ".json");
}

std::filesystem::path keep(const std::filesystem::path& results, const StudyBench& study) {
  const std::filesystem::path file = bench_file(results, study);
  make_folder(file.parent_path());
  write_durably(file, to_json(study));
  return file;
}

std::vector<std::filesystem::path> bench_files(const std::filesystem::path& results,
                                               const std::string& study) {
  const std::filesystem::path mine = bench_file(results, StudyBench::here(study));
  const std::string name = mine.filename(), host = name.substr(0, name.rfind('-') + 1);
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& file : std::filesystem::directory_iterator(mine.parent_path(), none))
    if (file.path().extension() == ".json") files.push_back(file.path());
  std::ranges::sort(files, {}, [&](const std::filesystem::path& file) {
    const std::string other = file.filename();
    return std::tuple(other != name, !other.starts_with(host), other);
  });
  return files;
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
