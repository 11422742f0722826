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
  bool json = false;
};

/// How many times as fast, from a ratio of costs.
std::string times(const Interval& ratio) {
  return interval_text({1 / ratio.high, 1 / ratio.mid, 1 / ratio.low});
}

void print(const KernelBench& bench) {
  std::cout
      << '\n'
      << bench.side << " x " << bench.side << ", " << to_string(widest())
      << ": structural, shear and bend links; ns per projection; fixed: what a step costs "
         "without a sweep, in structural sweeps; rows of two threads in wall time; fastest: of "
         "all parts of all samples, while nothing else used the core\n";
  std::vector<Row> table{{"", "median, 95 %", "x textbook, 95 %", "x Bullet, 95 %", "fastest",
                          "x textbook", "x Bullet", "floor", "flops", "bytes", "fixed"}};
  const auto bullet = std::ranges::find_if(
      bench.rows, [](const KernelRow& row) { return row.name.starts_with("bullet"); });
  const bool timed = bullet != bench.rows.end();
  for (std::size_t i = 0; i < bench.rows.size(); ++i) {
    const KernelRow& row = bench.rows[i];
    const auto other = static_cast<std::size_t>(bullet - bench.rows.begin());
    table.push_back({row.name, interval_text(row.cost()), times(bench.ratio(i, 0)),
                     timed ? times(bench.ratio(i, other)) : "-", number_text(row.fastest),
                     number_text(bench.rows[0].fastest / row.fastest),
                     timed ? number_text(bullet->fastest / row.fastest) : "-",
                     number_text(row.floor), std::to_string(row.flops), std::to_string(row.bytes),
                     number_text(bootstrap_median(row.fixed).mid)});
  }
  print_columns(table, 1);
  const auto in_both = [](double single, double twice) {
    return number_text(single) + " ns in float, " + number_text(twice) + " ns in double\n";
  };
  std::cout << "a square-root-free projection in registers, without loads and stores: "
            << in_both(bench.arithmetic_float, bench.arithmetic_double)
            << "a link of a colour batch, loaded and stored with an addition instead of a "
               "projection: "
            << in_both(bench.traffic_float, bench.traffic_double);
  const TwoCores& cores = bench.two_cores;
  std::cout << "two threads: " << interval_text(cores.threads())
            << " times one, wall time; two unrelated sheets at once: "
            << interval_text(cores.unrelated()) << "; so two threads get "
            << interval_text(cores.share()) << " of what two cores give\n";
  if (cores.free_rounds() > 0)
    std::cout << "two threads while both cores were free (" << cores.free_rounds() << " of "
              << cores.rounds() << " rounds: unrelated sheets at " << TwoCores::kFree
              << " and more): " << interval_text(cores.threads_while_free()) << " times one\n";
  std::cout << std::flush;
}

Json json_of(const KernelBench& bench) {
  const auto row_of = [](const KernelRow& row) -> Json {
    return {
        {"name", row.name},          {"threads", row.threads},   {"ns_per_projection", row.samples},
        {"fastest_ns", row.fastest}, {"floor_ns", row.floor},    {"flops", row.flops},
        {"bytes", row.bytes},        {"fixed_sweeps", row.fixed}};
  };
  return {{"side", bench.side},
          {"instructions", to_string(widest())},
          {"rows", json_array(bench.rows, row_of)},
          {"two_threads", bench.two_cores.threads()},
          {"unrelated_sheets", bench.two_cores.unrelated()}};
}

int run(const Options& o) {
  Json all = Json::array();
  for (const int side : o.sizes) {
    const KernelBench bench = bench_kernels({.side = side,
                                             .rounds = o.rounds,
                                             .seconds = o.seconds,
                                             .bullet = side <= o.largest_bullet,
                                             .progress = Countdown("timing round")});
    o.json ? all.push_back(json_of(bench)) : print(bench);
  }
  if (o.json) print_json(all);
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
  add_json(app, o.json, "Every row with its samples");
}

}  // namespace
}  // namespace taut::verb::kernels

TAUT_VERB(bench_kernels) = {
    .name = "bench kernels",
    .summary = "Measures one link projection: textbook, colour batches, interleaved sheet, Bullet",
    .example = "taut bench kernels --sizes 32,1024\n  taut-f32 bench kernels   (Bullet in float)",
    .bind = taut::bind_verb<taut::verb::kernels::add_options, taut::verb::kernels::run>};
