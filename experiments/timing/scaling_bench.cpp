#include "experiments/timing/scaling_bench.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/model/input_error.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/frontier/frontier.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

constexpr int kMost = 1 << 16;  ///< most sweeps or substeps that a search tries
constexpr std::size_t kCaseMemory = std::size_t{8} << 30;  ///< private memory of a case [bytes]

Measured measure(const Case& one, double expected, Store& store, const ScalingOptions& options) {
  const auto start = SteadyClock::now();
  options.say(one.id + (expected < 1 ? "" : ", about " + number_text(expected, 2) + " s"));
  BenchedCase benched{*run_stored(one, store, {options.limit * 4, kCaseMemory}), {}};
  Timing& timing = benched.timing;
  const Record& record = benched.record;
  if (record.status.kind != Status::Kind::unsupported && record.status.is_result()) try {
      TimingWorker worker(one.spec);
      const int all = steps_done(record);
      const int steps = times_within(0.05, worker.pilot_run(all).cpu, all);
      for (int i = 0; i < options.samples; ++i) {
        const StepTime time = worker.sample(steps);
        timing.samples.push_back(time.cpu);
        timing.wall.push_back(time.wall);
      }
      timing.peak_bytes = worker.peak_bytes();
    } catch (const std::runtime_error& error) {
      timing.failure = error.what();
    }
  return {std::move(benched), seconds_since(start)};
}

/// Name of the parameter that a search increases until the error is met: the sweeps, or the
/// substeps of a solver with one sweep in each.
std::string searched(const SolverChoice& choice) {
  const AccuracyParameters& of = choice.entry->accuracy;
  const bool sweeps = !of.sweeps.empty() && choice.params.integer(of.sweeps) != 1;
  const std::string name(sweeps ? of.sweeps : of.substeps);
  if (name.empty()) throw InputError(choice.brief() + ": it has neither sweeps nor substeps");
  return name;
}

/// Measures the smallest value of that parameter, to 5 %, for which the case's error is at most
/// `error`. Doubles the value, then bisects. A search that exceeds --limit fails.
Measured least(const Case& base, double error, Store& store, const ScalingOptions& options) {
  const auto start = SteadyClock::now(), end = in_seconds(options.limit);
  const std::string name = searched(base.choice);
  std::optional<Record> last;
  std::optional<std::vector<Limit>> limits;
  const auto with_value = [&](int n) {
    CaseSpec spec = base.spec;
    spec.solver = base.choice.with(name, std::to_string(n)).canonical();
    return make_case(spec);
  };
  const auto meets = [&](int n) -> std::optional<bool> {
    const Case one = with_value(n);
    const auto record = run_stored(one, store, {kLongestSeconds, kCaseMemory}, end);
    if (!record) return {};
    last = record;
    if (!limits) limits = default_limits(*one.scene);
    return Target{.error = error}.meets(judge(*record, deciding_metric({&*record}), limits));
  };
  int low = 0, high = 1;
  std::optional<bool> met;
  while ((met = meets(high)) && !*met && high < kMost) {
    low = high;
    high *= 2;
  }
  while (met && *met && high - low > std::max(1, high / 20)) {
    const int middle = (low + high) / 2;
    const auto enough = meets(middle);
    if (!enough)
      met = enough;
    else
      (*enough ? high : low) = middle;
  }
  if (!met || !*met) {
    Measured failed{{last ? *last : Record{}, {}}, seconds_since(start)};
    failed.benched.timing.failure = met ? "not reached" : "not found within --limit";
    return failed;
  }
  Measured found = measure(with_value(high), 0, store, options);
  found.seconds = seconds_since(start);
  return found;
}

Cell exponent(const std::optional<PowerLaw>& law) {
  return law ? Cell(interval_of_exponent(*law)) : Cell().with("too few sizes");
}

/// Stores the lines as a bench of cases that were not timed in turns, where `taut plot` and the
/// report find them.
void keep_lines(const Study& study, const std::vector<ScalingLine>& lines, Store& store) {
  SceneBench scene{study.scenes.front(), {}, {}, false};
  for (const ScalingLine& line : lines)
    for (const BenchedCase& c : line.cases) scene.cases.push_back(c);
  StudyBench session = StudyBench::here(study.name);
  session.scenes = {scene};
  keep(store, session);
}

}  // namespace

std::vector<ScalingLine> bench_scaling(const Study& study, Store& store,
                                       const ScalingOptions& options) {
  std::vector<ScalingLine> lines =
      measure_scaling(cases_of(study), options.limit, [&](const Case& one, double expected) {
        return options.error ? least(one, *options.error, store, options)
                             : measure(one, expected, store, options);
      });
  keep_lines(study, lines, store);
  return lines;
}

Answer scaling_answer(const std::string& study, const std::vector<ScalingLine>& lines) {
  Answer answer{"bench scaling", study};
  Table sizes{"sizes",
              "",
              {{"setting"},
               {"vertices"},
               Column("run", "as it was run"),
               {"cpu", "CPU time a step, 95 %", kMilliseconds},
               {"wall", "wall time", kMilliseconds},
               {"cpu_per_vertex", "CPU time a vertex", kNanoseconds},
               {"stretch.rms", "stretch.rms", kShare},
               {"plan_bytes_per_vertex", "bytes a vertex", kBytes},
               {"peak_bytes", "process", kMegabytes},
               {"status"}}},
      exponents{"exponents",
                "exponents over vertices, 95 %",
                {{"setting"}, {"cpu", "CPU time"}, {"wall", "wall time"}, {"memory"}}},
      samples{"samples",
              "samples of a step",
              {{"setting"},
               {"vertices"},
               {"cpu", "CPU time", kMilliseconds},
               {"wall", "wall time", kMilliseconds}}},
      skipped{"skipped", "skipped", {{"setting"}, {"why"}}};
  for (const ScalingLine& line : lines) {
    for (const BenchedCase& c : line.cases) {
      const auto n = static_cast<double>(c.record.vertices);
      const Interval cpu = bootstrap_median(c.timing.samples);
      sizes.rows.push_back(
          {line.setting, c.record.vertices, parse_solver(c.record.spec.solver).brief(), cpu,
           median(c.timing.wall), cpu.mid / n, c.record.value("stretch.rms"),
           plan_bytes(c.record) / n, c.timing.peak_bytes,
           c.timing.failure.empty() ? cell_of(c.record.status.kind) : Cell(c.timing.failure)});
      for (std::size_t i = 0; i < c.timing.samples.size(); ++i)
        samples.rows.push_back(
            {line.setting, c.record.vertices, c.timing.samples[i], c.timing.wall[i]});
    }
    exponents.rows.push_back(
        {line.setting, exponent(line.cpu), exponent(line.wall), exponent(line.memory)});
    for (const std::string& why : line.skipped) skipped.rows.push_back({line.setting, why});
  }
  samples.detail = true;
  for (Table* table : {&sizes, &exponents, &skipped, &samples}) answer.add(std::move(*table));
  return answer;
}

}  // namespace taut
