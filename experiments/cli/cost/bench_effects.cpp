#include <algorithm>
#include <iostream>

#include "experiments/command_line/options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/bench/effects.hpp"
#include "experiments/timing/bench/kernels.hpp"

namespace taut::verb::effects {

namespace {

constexpr const char* kUnit = "hang";  ///< the scene of links alone that the others are held to

struct Options {
  std::vector<std::string> scenes;
  std::string solver = "jakobsen:iterations=1,substeps=15";
  std::vector<int> sizes{0};
  int rounds = 11, copies = 0;
  double seconds = 0.01;
  bool two_threads = false, json = false;
};

void print_refused(const std::vector<EffectRow>& rows) {
  for (const EffectRow& row : rows)
    if (!row.refused.empty()) std::cout << row.scene << " not timed: " << row.refused << '\n';
  std::cout << std::flush;
}

void print_heading(const Options& options, int side) {
  std::cout << '\n' << options.solver;
  if (side > 0) std::cout << ", " << side << " x " << side;
}

void print(const std::vector<EffectRow>& rows, const Options& options, int side) {
  print_heading(options, side);
  std::cout << "; ns a vertex and step, " << (options.copies > 0 ? "wall" : "CPU")
            << " time; times hang's, a step and a simulated second, times the same cloth's links "
               "alone, and times hang's if the colliders are too far away to be touched, 95 %\n";
  std::vector<Row> table{{"scene", "effects", "vertices", "ns", "x hang, a step", "a second",
                          "x links alone", "x hang, touching nothing"}};
  const double half = options.copies / 2.0;
  if (options.copies > 0)
    table[0].push_back(std::to_string(options.copies) + " on two threads / " + number_text(half) +
                       " of one");
  const EffectRow& unit = rows.front();
  for (const EffectRow& row : rows) {
    Row& line = table.emplace_back(Row{row.scene, row.effects, std::to_string(row.vertices)});
    if (row.refused.empty()) {
      const Interval times = row.times(unit);
      line.insert(
          line.end(),
          {number_text(row.cost().mid), interval_text(times),
           number_text(times.mid * unit.dt / row.dt), interval_text(row.times_links_alone()),
           row.touching_nothing.empty() ? "-" : interval_text(row.touching_nothing_times(unit))});
      if (options.copies > 0) line.push_back(interval_text(row.times_one(), half));
    }
    line.resize(table[0].size(), "-");
  }
  print_columns(table, 2);
  for (const EffectRow& row : rows) {
    if (!row.traffic.empty())
      std::cout << row.scene << ": to load and store the ends of its links alone would cost "
                << interval_text(row.traffic_times(unit)) << " x hang\n";
  }
  print_refused(rows);
}

void print_two_cores(const std::vector<EffectRow>& rows, const Options& options, int side) {
  print_heading(options, side);
  std::cout << "; wall time; two threads on one sheet, and two unrelated sheets at once, as fast "
               "as so many single threads, 95 %; both cores were free in the rounds in which "
               "unrelated sheets reached "
            << TwoCores::kFree << "; a word takes " << number_text(1e9 * seconds_per_handover())
            << " ns from one thread to the other, at its fastest\n";
  std::vector<Row> table{{"scene", "effects", "vertices", "two threads", "unrelated sheets",
                          "two / unrelated", "two, cores free", "free rounds"}};
  for (const EffectRow& row : rows) {
    Row& line = table.emplace_back(Row{row.scene, row.effects, std::to_string(row.vertices)});
    const TwoCores& cores = row.two_cores;
    if (row.refused.empty())
      line.insert(line.end(),
                  {interval_text(cores.threads()), interval_text(cores.unrelated()),
                   interval_text(cores.share()), interval_text(cores.threads_while_free()),
                   std::to_string(cores.free_rounds()) + " of " + std::to_string(cores.rounds())});
    line.resize(table[0].size(), "-");
  }
  print_columns(table, 2);
  print_refused(rows);
}

Json json_of(const std::vector<EffectRow>& rows, int side) {
  Json all = Json::array();
  for (const EffectRow& row : rows)
    all.push_back({{"scene", row.scene},
                   {"effects", row.effects},
                   {"side", side},
                   {"vertices", row.vertices},
                   {"dt", row.dt},
                   {"refused", row.refused},
                   {"ns", row.whole},
                   {"links_alone_ns", row.links_alone},
                   {"touching_nothing_ns", row.touching_nothing},
                   {"link_traffic_ns", row.traffic},
                   {"copies_ns", row.copies},
                   {"two_threads", row.two_cores.thread_samples()},
                   {"unrelated_sheets", row.two_cores.unrelated_samples()}});
  return all;
}

int run(const Options& o) {
  std::vector<std::string> scenes = o.scenes.empty() ? shipped("scenes") : o.scenes;
  std::erase(scenes, kUnit);
  scenes.insert(scenes.begin(), kUnit);
  Json all = Json::array();
  for (const int side : o.sizes) {
    const auto rows = bench_effects({.scenes = scenes,
                                     .solver = o.solver,
                                     .side = side,
                                     .copies = o.copies,
                                     .two_threads = o.two_threads,
                                     .rounds = o.rounds,
                                     .seconds = o.seconds,
                                     .progress = Countdown("timing round")});
    if (o.json)
      for (Json& row : json_of(rows, side)) all.push_back(std::move(row));
    else
      (o.two_threads ? print_two_cores : print)(rows, o, side);
  }
  if (o.json) print_json(all);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("SCENE", o.scenes, "Scenes beside hang (default: all that are shipped)");
  app.add_option("--solver", o.solver, "The solver (default: jakobsen:iterations=1,substeps=15)");
  app.add_option("--sizes", o.sizes,
                 "Sheets of so many vertices along each side; 0: as they are (default: 0)")
      ->delimiter(',')
      ->check(CLI::Range(0, 1024));
  add_samples(app, o.rounds, o.seconds);
  CLI::Option* const copies =
      app.add_option("--copies", o.copies,
                     "Also so many sheets of each scene at once on two threads; in wall time")
          ->check(CLI::Range(1, 4096));
  app.add_flag(
         "--two-threads", o.two_threads,
         "Instead what two threads are worth beside two unrelated sheets, in wall time; fewer "
         "than 8192 vertices take one thread and are refused")
      ->excludes(copies);
  add_json(app, o.json, "Every row with its samples");
}

}  // namespace
}  // namespace taut::verb::effects

TAUT_VERB(bench_effects) = {
    .name = "bench effects",
    .group = VerbGroup::cost,
    .summary = "Measures what wind, contact and self-collision cost beside links alone",
    .example =
        "taut bench effects\n  taut bench effects ball box --sizes 64,128\n  "
        "taut bench effects flag plane crumple --sizes 128 --two-threads --rounds 30\n  "
        "taut bench effects hang --copies 16",
    .bind = taut::bind_verb<taut::verb::effects::add_options, taut::verb::effects::run>};
