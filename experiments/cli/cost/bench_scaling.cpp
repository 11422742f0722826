#include "experiments/command_line/verb.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/timing/scaling.hpp"

namespace taut::verb::scaling {

namespace {

constexpr std::size_t kMemory = std::size_t{8} << 30;  ///< of a case, bytes of private memory

struct Options {
  std::string study = "scaling", preset, out;
  double limit = 20;
  int samples = 6;
  Format format;
};

Measured measure(const Case& one, double expected, const Store& store, const Options& options) {
  const auto start = SteadyClock::now();
  progress() << one.id << (expected < 1 ? "" : ", about " + number_text(expected, 2) + " s")
             << '\n';
  BenchedCase benched{*run_stored(one, store, {options.limit * 4, kMemory}), {}};
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

Cell exponent(const std::optional<PowerLaw>& law) {
  return law ? Cell(interval_of_exponent(*law)) : Cell().with("too few sizes");
}

void add_tables(Answer& answer, const std::vector<ScalingLine>& lines) {
  Table sizes{"sizes",
              "",
              {{"setting"},
               {"vertices"},
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
      sizes.rows.push_back({line.setting, c.record.vertices, cpu, median(c.timing.wall),
                            cpu.mid / n, c.record.value("stretch.rms"), plan_bytes(c.record) / n,
                            c.timing.peak_bytes, to_string(c.record.status.kind)});
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
}

/// Where `taut plot` and the report find it: a bench, but of cases that were not timed in turns.
void keep(const Study& study, const std::vector<ScalingLine>& lines, const Store& store) {
  SceneBench scene{study.scenes.front(), {}, {}, false};
  for (const ScalingLine& line : lines)
    for (const BenchedCase& c : line.cases) scene.cases.push_back(c);
  StudyBench session = StudyBench::here(study.name);
  session.scenes = {scene};
  taut::keep(store, session);
}

int run(const Options& options) {
  require_one_quiet_host();
  const Study study = load_study(options.study, options.preset);
  const std::vector<Case> cases = cases_of(study);
  const Store store(options.out);
  store.prepare();
  const std::vector<ScalingLine> lines = measure_scaling(
      cases, options.limit,
      [&](const Case& one, double expected) { return measure(one, expected, store, options); });
  Answer answer{"bench scaling", study.name};
  keep(study, lines, store);
  add_tables(answer, lines);
  print(answer, options.format);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("STUDY", o.study, "A study that varies the cloth's grid (default: scaling)");
  add_preset(app, o.preset);
  app.add_option("--limit", o.limit,
                 "Skip a case that would take longer than this, physics and timing [s] "
                 "(default: 20)")
      ->check(above_zero_seconds());
  app.add_option("--samples", o.samples, "Samples of each case (default: 6)")
      ->check(CLI::Range(1, 1000));
  add_results(app, o.out);
  add_format(app, o.format, "Print every sample, too");
}

}  // namespace
}  // namespace taut::verb::scaling

TAUT_VERB(scaling) = {
    .name = "bench scaling",
    .summary = "Measures cost and memory over the cloth's size, with exponents",
    .example =
        "taut bench scaling\n  taut bench scaling --preset quick --limit 5\n  taut plot scaling "
        "--preset "
        "quick",
    .bind = taut::bind_verb<taut::verb::scaling::add_options, taut::verb::scaling::run>};
