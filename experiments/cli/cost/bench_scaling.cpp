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
  bool json = false;
};

std::string exponent(const std::optional<PowerLaw>& law) {
  return law ? number_text(law->exponent) + " +- " + number_text(2 * law->error, 2)
             : "too few sizes";
}

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

void print(const ScalingLine& line) {
  std::cout << line.setting << '\n';
  std::vector<Row> rows{{"vertices", "CPU ms per step (95 %)", "wall ms", "ns per vertex",
                         "stretch.rms", "bytes per vertex", "process MB"}};
  for (const BenchedCase& c : line.cases) {
    if (c.timing.samples.empty()) continue;
    const Interval cpu = bootstrap_median(c.timing.samples);
    const auto n = static_cast<double>(c.record.vertices);
    rows.push_back({std::to_string(c.record.vertices), interval_text(cpu, 1e-3),
                    number_text(1e3 * median(c.timing.wall)), number_text(1e9 * cpu.mid / n),
                    number_text(c.record.value("stretch.rms")),
                    number_text(plan_bytes(c.record) / n),
                    number_text(1e-6 * static_cast<double>(c.timing.peak_bytes))});
  }
  print_columns(rows, 1);
  for (const std::string& skipped : line.skipped) std::cout << "    skipped " << skipped << '\n';
  std::cout << "    exponents over vertices, 95 %: CPU " << exponent(line.cpu) << ", wall "
            << exponent(line.wall) << ", memory " << exponent(line.memory) << '\n';
}

Json json_of(const std::optional<PowerLaw>& law) {
  if (!law) return nullptr;
  return {{"factor", law->factor}, {"exponent", law->exponent}, {"standard_error", law->error}};
}

Json json_of(const ScalingLine& line) {
  Json all{{"setting", line.setting},
           {"skipped", line.skipped},
           {"cpu", json_of(line.cpu)},
           {"wall", json_of(line.wall)},
           {"memory", json_of(line.memory)}};
  for (const BenchedCase& c : line.cases)
    all["sizes"].push_back({{"vertices", c.record.vertices},
                            {"status", to_string(c.record.status.kind)},
                            {"cpu_seconds_per_step", c.timing.samples},
                            {"wall_seconds_per_step", c.timing.wall},
                            {"plan_bytes", plan_bytes(c.record)},
                            {"peak_bytes", c.timing.peak_bytes},
                            {"stretch.rms", c.record.value("stretch.rms")}});
  return all;
}

/// Where `taut plot` and the report find it: a bench, but of cases that were not timed in turns.
std::filesystem::path keep(const Study& study, const std::vector<ScalingLine>& lines,
                           const Options& options) {
  SceneBench scene{study.scenes.front(), {}, {}, false};
  for (const ScalingLine& line : lines)
    for (const BenchedCase& c : line.cases) scene.cases.push_back(c);
  StudyBench session = StudyBench::here(study.name);
  session.scenes = {scene};
  return taut::keep(options.out, session);
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
  const auto file = keep(study, lines, options);
  if (options.json) {
    print_json(json_array(lines, [](const ScalingLine& line) { return json_of(line); }));
    return kPass;
  }
  for (const ScalingLine& line : lines) print(line);
  std::cout << file.string() << '\n';
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
  app.add_flag("--json", o.json, "Everything measured, every sample, as JSON");
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
