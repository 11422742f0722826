#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>

#include "core/solver/simd/kernels.hpp"
#include "experiments/bench/kernels.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/json.hpp"

namespace taut::verb::kernels {

namespace {

struct Options {
  std::vector<int> sizes{32, 128, 512};
  int rounds = 11;
  double seconds = 0.005;
  int largest_bullet = 256;
  bool json = false;
};

std::string times(const Interval& ratio) {
  char text[64];
  std::snprintf(text, sizeof text, "%6.2f [%.2f %.2f]", 1 / ratio.mid, 1 / ratio.high,
                1 / ratio.low);
  return text;
}

void print(const KernelBench& bench) {
  std::printf(
      "\n%d x %d, %s: structural, shear and bend links; ns per projection; fixed: what a step "
      "costs without a sweep, in structural sweeps; rows of two threads in wall time; fastest: "
      "of all parts of all samples, while "
      "nothing else used the core\n",
      bench.side, bench.side, std::string(to_string(widest())).c_str());
  std::printf("%-78s %7s %-15s %-21s %-21s %7s %8s %8s %6s %5s %5s %6s\n", "", "median", "[95 %]",
              "x textbook [95 %]", "x Bullet [95 %]", "fastest", "x textb.", "x Bullet", "floor",
              "flops", "bytes", "fixed");
  const auto bullet = std::find_if(bench.rows.begin(), bench.rows.end(), [](const KernelRow& row) {
    return row.name.starts_with("bullet");
  });
  const bool rival = bullet != bench.rows.end();
  for (std::size_t i = 0; i < bench.rows.size(); ++i) {
    const KernelRow& row = bench.rows[i];
    const Interval cost = row.cost();
    const auto other = static_cast<std::size_t>(bullet - bench.rows.begin());
    std::printf("%-78s %7.3f [%.3f %.3f]  %-21s %-21s %7.3f %8.2f %8.2f %6.3f %5d %5d %6.2f\n",
                row.name.c_str(), cost.mid, cost.low, cost.high, times(bench.ratio(i, 0)).c_str(),
                rival ? times(bench.ratio(i, other)).c_str() : "-", row.fastest,
                bench.rows[0].fastest / row.fastest, rival ? bullet->fastest / row.fastest : 0,
                row.floor, row.flops, row.bytes, bootstrap_median(row.fixed).mid);
  }
  std::printf(
      "a square-root-free projection in registers, without loads and stores: %.3f ns in float, "
      "%.3f ns in double\n"
      "a link of a colour batch, loaded and stored with an addition instead of a projection: %.3f "
      "ns in float, "
      "%.3f ns in double\n",
      bench.arithmetic_float, bench.arithmetic_double, bench.traffic_float, bench.traffic_double);
  const TwoCores& cores = bench.two_cores;
  const auto text = [](const Interval& i) {
    char number[64];
    std::snprintf(number, sizeof number, "%.2f [%.2f %.2f]", i.mid, i.low, i.high);
    return std::string(number);
  };
  std::printf(
      "two threads: %s times one, wall time; two unrelated sheets at once: %s; so two threads get "
      "%s of what two cores give\n",
      text(cores.threads).c_str(), text(cores.unrelated).c_str(), text(cores.share).c_str());
  if (cores.free > 0)
    std::printf(
        "two threads while both cores were free (%.0f %% of the rounds: unrelated sheets at %.1f "
        "and more): %s times one\n",
        100 * cores.free, TwoCores::kFree, text(cores.threads_while_free).c_str());
  std::fflush(stdout);
}

Json json_of(const KernelBench& bench) {
  Json rows = Json::array();
  for (const KernelRow& row : bench.rows)
    rows.push_back({{"name", row.name},
                    {"threads", row.threads},
                    {"ns_per_projection", row.samples},
                    {"fastest_ns", row.fastest},
                    {"floor_ns", row.floor},
                    {"flops", row.flops},
                    {"bytes", row.bytes},
                    {"fixed_sweeps", row.fixed}});
  const auto interval = [](const Interval& i) { return Json{i.low, i.mid, i.high}; };
  return {{"side", bench.side},
          {"instructions", to_string(widest())},
          {"rows", rows},
          {"two_threads", interval(bench.two_cores.threads)},
          {"unrelated_sheets", interval(bench.two_cores.unrelated)}};
}

std::function<int()> bind(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("--sizes", o->sizes, "Vertices along a side (default: 32,128,512)")
      ->delimiter(',')
      ->check(CLI::Range(2, 4096));
  app.add_option("--rounds", o->rounds, "Rounds in alternating order (ABBA) (default: 11)")
      ->check(CLI::Range(1, 1000));
  app.add_option("--seconds", o->seconds, "Of one sample (default: 0.005)")->check(above_zero());
  app.add_option("--largest-bullet", o->largest_bullet,
                 "Largest side for Bullet, whose steps take seconds beyond (default: 256)")
      ->check(CLI::Range(0, 4096));
  add_json(app, o->json, "Every row with its samples");
  return [o] {
    Json all = Json::array();
    for (const int side : o->sizes) {
      const KernelBench bench = bench_kernels({.side = side,
                                               .rounds = o->rounds,
                                               .seconds = o->seconds,
                                               .bullet = side <= o->largest_bullet});
      o->json ? all.push_back(json_of(bench)) : print(bench);
    }
    if (o->json) std::cout << to_text(all, 1) << '\n';
    return kPass;
  };
}

}  // namespace
}  // namespace taut::verb::kernels

TAUT_VERB(bench_kernels) = {
    .name = "bench kernels",
    .group = VerbGroup::cost,
    .summary = "Measures one link projection: textbook, colour batches, interleaved sheet, Bullet",
    .example = "taut bench kernels --sizes 32,1024\n  taut-f32 bench kernels   (Bullet in float)",
    .bind = taut::verb::kernels::bind};
