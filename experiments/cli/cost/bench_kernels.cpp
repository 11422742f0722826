#include "core/solver/simd/kernels.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/timing/bench/kernels.hpp"

namespace taut::verb::kernels {

namespace {

struct Options {
  std::vector<int> sizes{32, 128, 512};
  int rounds = 11;
  double seconds = 0.005;
  int largest_bullet = 256;
  Format format;
};

constexpr Unit kNs = kNanoseconds;

/// How many times as fast, from a ratio of costs.
Interval times(const Interval& ratio) { return {1 / ratio.high, 1 / ratio.mid, 1 / ratio.low}; }

Table table_of(const KernelBench& bench) {
  const std::string side = std::to_string(bench.side);
  Table table{"size_" + side,
              side + " x " + side + ", " + std::string(to_string(widest())) +
                  ": structural, shear and bend links",
              {{"name", "one projection"},
               {"cost", "median, 95 %", kNs},
               {"times_textbook", "x textbook, 95 %"},
               {"times_bullet", "x Bullet, 95 %"},
               {"fastest", "fastest", kNs},
               {"fastest_times_textbook", "x textbook"},
               {"fastest_times_bullet", "x Bullet"},
               {"floor", "floor", kNs},
               {"flops"},
               {"bytes"},
               {"threads"},
               {"fixed", "fixed [sweeps]"}}};
  const auto bullet = std::ranges::find_if(
      bench.rows, [](const KernelRow& row) { return row.name.starts_with("bullet"); });
  const bool timed = bullet != bench.rows.end();
  const auto other = static_cast<std::size_t>(bullet - bench.rows.begin());
  for (std::size_t i = 0; i < bench.rows.size(); ++i) {
    const KernelRow& row = bench.rows[i];
    table.rows.push_back({row.name, row.cost() * 1e-9, times(bench.ratio(i, 0)),
                          timed ? Cell(times(bench.ratio(i, other))) : Cell(), 1e-9 * row.fastest,
                          bench.rows[0].fastest / row.fastest,
                          timed ? Cell(bullet->fastest / row.fastest) : Cell(), 1e-9 * row.floor,
                          row.flops, row.bytes, row.threads, bootstrap_median(row.fixed).mid});
  }
  table.caption =
      "fixed: what a step costs without a sweep, in structural sweeps; rows of two threads in wall "
      "time; fastest: of all parts of all samples, while nothing else used the core";
  return table;
}

/// Of every size: what a projection is held to, and what a second core is worth.
Table limits_of(const std::vector<KernelBench>& sizes) {
  Table table{"limits",
              "what bounds a projection, and a second core",
              {{"side"},
               {"arithmetic_float", "in registers, float", kNs},
               {"arithmetic_double", "double", kNs},
               {"traffic_float", "load and store a link, float", kNs},
               {"traffic_double", "double", kNs},
               {"two_threads", "two threads [x one]"},
               {"unrelated_sheets", "unrelated sheets [x one]"},
               {"share", "two threads / unrelated"},
               {"threads_while_free", "two threads, cores free"},
               {"free_rounds", "free rounds"},
               {"rounds"}}};
  for (const KernelBench& bench : sizes) {
    const TwoCores& cores = bench.two_cores;
    table.rows.push_back({bench.side, 1e-9 * bench.arithmetic_float, 1e-9 * bench.arithmetic_double,
                          1e-9 * bench.traffic_float, 1e-9 * bench.traffic_double, cores.threads(),
                          cores.unrelated(), cores.share(), cores.threads_while_free(),
                          cores.free_rounds(), cores.rounds()});
  }
  table.caption = "both cores were free where unrelated sheets are at " +
                  number_text(TwoCores::kFree) + " and more; wall time";
  return table;
}

/// Every sample, in the order in which they were taken.
Table samples_of(const std::vector<KernelBench>& sizes) {
  Table table{
      "samples",
      "samples",
      {{"side"}, {"name"}, {"cost", "cost of a projection", kNs}, {"fixed", "fixed [sweeps]"}}};
  for (const KernelBench& bench : sizes)
    for (const KernelRow& row : bench.rows)
      for (std::size_t i = 0; i < row.samples.size(); ++i)
        table.rows.push_back({bench.side, row.name, 1e-9 * row.samples[i],
                              i < row.fixed.size() ? Cell(row.fixed[i]) : Cell()});
  table.detail = true;
  return table;
}

int run(const Options& o) {
  Answer answer{"bench kernels"};
  std::vector<KernelBench> sizes;
  for (const int side : o.sizes) {
    sizes.push_back(bench_kernels({.side = side,
                                   .rounds = o.rounds,
                                   .seconds = o.seconds,
                                   .bullet = side <= o.largest_bullet,
                                   .progress = Countdown("timing round")}));
    answer.add(table_of(sizes.back()));
  }
  answer.add(limits_of(sizes));
  answer.add(samples_of(sizes));
  print(answer, o.format);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("--sizes", o.sizes, "Vertices along a side (default: 32,128,512)")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096));
  add_samples(app, o.rounds, o.seconds);
  app.add_option("--largest-bullet", o.largest_bullet,
                 "Largest side for Bullet, whose steps take seconds beyond (default: 256)")
      ->check(CLI::Range(0, 4096));
  add_format(app, o.format, "Print every sample, too");
}

}  // namespace
}  // namespace taut::verb::kernels

TAUT_VERB(bench_kernels) = {
    .name = "bench kernels",
    .summary = "Measures one link projection: textbook, colour batches, interleaved sheet, Bullet",
    .example = "taut bench kernels --sizes 32,1024\n  taut-f32 bench kernels   (Bullet in float)",
    .bind = taut::bind_verb<taut::verb::kernels::add_options, taut::verb::kernels::run>};
