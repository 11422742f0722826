#include "core/model/text.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/timing/scaling_bench.hpp"

namespace taut::verb::scaling {

namespace {

struct Options {
  std::string study, preset, error, out;
  double limit = ScalingOptions{}.limit;
  int samples = ScalingOptions{}.samples;
  Format format;
};

int run(const Options& options) {
  require_one_quiet_host();
  const std::string name = !options.study.empty()  ? options.study
                           : options.error.empty() ? "scaling"
                                                   : "scaling-error";
  ScalingOptions how{.limit = options.limit, .samples = options.samples};
  how.say = [](const std::string& text) { progress() << text << '\n'; };
  if (!options.error.empty()) how.error = error_of(options.error, unit_of_value(kErrorMetric));
  const Study study = load_study(name, options.preset);
  Store store(options.out);
  store.prepare();
  print(scaling_answer(study.name, bench_scaling(study, store, how)), options.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("STUDY", o.study,
                  "A study that varies the cloth's grid (default: scaling, or scaling-error)");
  add_preset(args, o.preset);
  args.add_option(
      "--error", o.error,
      "Search for each solver the fewest substeps (of one sweep), or sweeps if it has more "
      "than one, that reach this RMS stretch: 0.005 or 0.5%");
  args.add_option("--limit", o.limit,
                  "Skip a case that would take longer than this in all [s] (default: " +
                      as_typed(o.limit) + ")")
      .check(above_zero_seconds());
  args.add_option("--samples", o.samples,
                  "Samples of each case (default: " + std::to_string(o.samples) + ")")
      .check(in_range(1, 1000));
  add_results(args, o.out);
  add_format(args, o.format, "Print every sample, too");
}

}  // namespace
}  // namespace taut::verb::scaling

TAUT_VERB(scaling) = {
    .name = "bench scaling",
    .summary = "Measures cost and memory over the cloth's size, with exponents",
    .example =
        "taut bench scaling\n  taut bench scaling --error 0.5%\n  taut bench scaling --preset "
        "quick --limit 5\n  taut plot scaling --preset quick",
    .answer = {{"sizes",
                "setting vertices run cpu wall cpu_per_vertex stretch.rms plan_bytes_per_vertex "
                "peak_bytes status"},
               {"exponents", "setting cpu wall memory"},
               {"skipped", "setting why"},
               {"samples", "setting vertices cpu wall"}},
    .bind = taut::bind_verb<taut::verb::scaling::add_options, taut::verb::scaling::run>};
