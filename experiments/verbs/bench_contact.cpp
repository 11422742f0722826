#include <cstdio>
#include <memory>

#include "experiments/bench/contact.hpp"
#include "experiments/verbs/verb.hpp"

namespace taut::verb::contact {

namespace {

struct Options {
  std::vector<int> sizes{128};
  int rounds = 11;
  double seconds = 0.01;
};

std::string in_sweeps(const Interval& ratio) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f [%.2f %.2f]", ratio.mid, ratio.low, ratio.high);
  return text;
}

void print(const std::vector<ContactRow>& rows, int side) {
  std::printf(
      "\n%d x %d, %zu particles; CPU ns per particle; contact of a step in structural sweeps "
      "[95 %%]\n",
      side, side, rows.front().particles);
  std::printf("%-8s %-30s %5s %8s %8s %11s %10s  %-20s %-20s\n", "", "", "steps", "touching",
              "a sweep", "contact in", "and in", "step of 1 sweep", "step of 10 sweeps");
  std::printf("%-8s %-30s %5s %8s %8s %11s %10s\n", "", "", "", "", "of links", "each sweep",
              "each step");
  for (const ContactRow& row : rows)
    std::printf("%-8s %-30s %5d %7.0f%% %8.2f %11.2f %10.2f  %-20s %-20s\n", row.scene.c_str(),
                row.setting.c_str(), row.steps, 100 * row.touching, median(row.sweep),
                median(row.each_sweep), median(row.each_step), in_sweeps(row.ratio(1)).c_str(),
                in_sweeps(row.ratio(10)).c_str());
  std::fflush(stdout);
}

std::function<int()> bind(Arguments& arguments) {
  const auto o = std::make_shared<Options>();
  arguments.option("--sizes", o->sizes, "Vertices along a side (default: 128)")
      .separated_by(',')
      .range(8, 1024);
  arguments.option("--rounds", o->rounds, "Interleaved rounds forth and back (default: 11)")
      .range(1, 1000);
  arguments.option("--seconds", o->seconds, "Of one sample (default: 0.01)").positive();
  return [o] {
    for (const int side : o->sizes)
      print(bench_contact({.side = side, .rounds = o->rounds, .seconds = o->seconds}), side);
    return kPass;
  };
}

}  // namespace
}  // namespace taut::verb::contact

TAUT_VERB(bench_contact) = {
    .name = "bench-contact",
    .summary = "Measures contact and self-collision against structural sweeps of the same cloth",
    .example = "taut bench contact\n  taut bench contact --sizes 32,128,256",
    .bind = taut::verb::contact::bind};
