#include <algorithm>
#include <tuple>

#include "core/model/text.hpp"
#include "experiments/command_line/options.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/bench/effects.hpp"

namespace taut::verb::effects {

namespace {

/// The scene of links alone with which the others are compared.
constexpr const char* kUnit = "hang";

struct Options {
  std::vector<std::string> scenes;
  std::string solver = "jakobsen:iterations=1,substeps=15";
  std::vector<int> sizes{0};
  int rounds = 11, copies = 0;
  double seconds = 0.01;
  Format format;
};

constexpr Unit kNs = kNanoseconds;

/// The cell of interval(); empty without samples.
template <class MakeInterval>
Cell of(const std::vector<double>& samples, const MakeInterval& interval) {
  return samples.empty() ? Cell() : Cell(interval());
}

/// "as shipped", "64 x 64".
std::string size_text(int side) {
  return side > 0 ? std::to_string(side) + " x " + std::to_string(side) : "as shipped";
}

Table table_of(const std::vector<EffectRow>& rows, const Options& options, int side) {
  const double half = options.copies / 2.0;
  Table table{"effects_" + std::to_string(side),
              size_text(side) + ": " + (options.copies > 0 ? "wall" : "CPU") +
                  " time a vertex and step, 95 %",
              {{"scene"},
               {"effects"},
               {"vertices"},
               {"cost", "cost", kNs},
               {"times_hang", "x hang, a step"},
               {"times_hang_per_second", "x hang, a second"},
               {"times_links_alone", "x its links alone"},
               {"times_hang_touching_nothing", "x hang, touching nothing"},
               {"times_one_copy", "copies on two threads, x half as many on one"}}};
  const EffectRow& unit = rows.front();
  for (const EffectRow& row : rows) {
    auto& line = table.rows.emplace_back();
    line = {row.scene, row.effects, row.vertices};
    if (row.refused.empty())
      line.insert(line.end(),
                  {row.cost() * 1e-9, row.times(unit), row.times(unit).mid * unit.dt / row.dt,
                   row.times_links_alone(),
                   of(row.touching_nothing, [&] { return row.touching_nothing_times(unit); }),
                   of(row.copies, [&] { return row.times_one() * (1 / half); })});
    else
      line.push_back(Cell().with("not timed: " + row.refused));
    line.resize(table.columns.size());
  }
  table.caption = "touching nothing: with its colliders out of reach";
  return table;
}

/// Adds every sample, two for each round.
void add_samples_of(const std::vector<EffectRow>& rows, int side, Table& table) {
  for (const EffectRow& row : rows)
    for (const auto& [what, scale, samples] :
         {std::tuple("whole", 1e-9, row.whole), std::tuple("links alone", 1e-9, row.links_alone),
          std::tuple("touching nothing", 1e-9, row.touching_nothing),
          std::tuple("copies", 1e-9, row.copies)})
      for (const double sample : samples)
        table.rows.push_back({row.scene, side, what, scale * sample});
}

int run(const Options& o) {
  std::vector<std::string> scenes = o.scenes.empty() ? shipped("scenes") : o.scenes;
  std::erase(scenes, kUnit);
  scenes.insert(scenes.begin(), kUnit);
  Answer answer{"bench effects", o.solver};
  Table samples{
      "samples", "samples: SI, of a vertex and step", {{"scene"}, {"side"}, {"what"}, {"value"}}};
  for (const int side : o.sizes) {
    const auto rows = bench_effects({.scenes = scenes,
                                     .solver = o.solver,
                                     .side = side,
                                     .copies = o.copies,
                                     .rounds = o.rounds,
                                     .seconds = o.seconds,
                                     .progress = Countdown("timing round")});
    answer.add(table_of(rows, o, side));
    add_samples_of(rows, side, samples);
  }
  samples.detail = true;
  answer.add(std::move(samples));
  print(answer, o.format);
  return kPass;
}

void add_options(Arguments& args, Options& o) {
  args.add_option("SCENE", o.scenes,
                  std::string("Scenes beside ") + kUnit + " (default: all that are shipped)");
  args.add_option("--solver", o.solver, "The solver (default: " + o.solver + ")");
  args.add_option("--sizes", o.sizes,
                  "Sheets with this many vertices along each side; 0: as shipped (default: " +
                      join(o.sizes, ",", [](int side) { return std::to_string(side); }) + ")")
      .delimiter(',')
      .check(in_range(0, 1024));
  add_samples(args, o.rounds, o.seconds);
  args.add_option("--copies", o.copies,
                  "Also run this many sheets of each scene at once on two threads, in wall time")
      .check(in_range(1, 4096));
  add_format(args, o.format, "Print every sample, too");
}

}  // namespace
}  // namespace taut::verb::effects

TAUT_VERB(bench_effects) = {
    .name = "bench effects",
    .group = VerbGroup::cost,
    .summary = "Measures what wind, contact and self-collision cost beside links alone",
    .example =
        "taut bench effects\n  taut bench effects ball box --sizes 64,128\n  "
        "taut bench effects hang --copies 16",
    .answer = {{"effects_N",
                "scene effects vertices cost times_hang times_hang_per_second times_links_alone "
                "times_hang_touching_nothing times_one_copy"},
               {"samples", "scene side what value"}},
    .bind = taut::bind_verb<taut::verb::effects::add_options, taut::verb::effects::run>};
