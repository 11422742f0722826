#include "core/reference/fit.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/timing/bench/contact.hpp"

namespace taut::verb::contact {

namespace {

struct Options {
  std::vector<int> sizes{128};
  int rounds = 11;
  double seconds = 0.01;
  std::string output;
  bool json = false;
};

using Rows = std::vector<ContactRow>;

double seconds(const ContactRow& row, double ns_per_particle) {
  return 1e-9 * static_cast<double>(row.particles) * ns_per_particle;
}
/// Contact of a step with one sweep [s].
double seconds_per_step(const ContactRow& row) {
  return seconds(row, median(row.each_step) + median(row.each_sweep));
}

void print(const std::vector<ContactRow>& rows, int side) {
  std::cout
      << '\n'
      << side << " x " << side << ", " << rows.front().particles
      << " particles; CPU ns per particle of a sweep of links, of contact in each sweep and of "
         "contact in each step besides; contact of a step in structural sweeps, 95 %\n";
  std::vector<Row> table{{"scene", "setting", "steps", "touching", "a sweep", "in each sweep",
                          "in each step", "step of 1 sweep", "step of 10 sweeps"}};
  for (const ContactRow& row : rows)
    table.push_back({row.scene, row.setting, std::to_string(row.steps),
                     number_text(100 * row.touching) + " %", number_text(median(row.sweep)),
                     number_text(median(row.each_sweep)), number_text(median(row.each_step)),
                     interval_text(row.ratio(1)), interval_text(row.ratio(10))});
  print_columns(table, 2);
  std::cout << std::flush;
}

/// Contact's cost of a step over the number of particles, as a power law, setting by setting.
void print_exponents(const std::vector<Rows>& sizes) {
  std::cout << "\nexponent of contact's cost over particles, 95 %\n";
  std::vector<Row> table;
  for (std::size_t i = 0; i < sizes.front().size(); ++i) {
    std::vector<double> n, cost;
    for (const Rows& rows : sizes)
      if (const double seconds = seconds_per_step(rows[i]); seconds > 0)
        n.push_back(static_cast<double>(rows[i].particles)), cost.push_back(seconds);
    if (n.size() < 3) continue;
    const PowerLaw law = fit_power_law(n, cost);
    const ContactRow& row = sizes.front()[i];
    table.push_back({row.scene, row.setting, std::to_string(row.steps),
                     number_text(law.exponent) + " +- " + number_text(2 * law.error)});
  }
  if (!table.empty()) print_columns(table, 2);
}

Record plotted(const ContactRow& row, const std::string& self, double seconds_per_step) {
  Record record;
  record.scene = "crumple", record.solver = "jakobsen";
  record.params = {{"self", self}};
  record.vertices = static_cast<int>(row.particles);
  record.values = {{"cpu.per_step", seconds_per_step}};
  return record;
}

/// A whole step over the number of particles: without self-collision, by octree and by grid.
void plot(const std::vector<Rows>& sizes, const std::string& folder) {
  std::vector<Record> records;
  for (const Rows& rows : sizes)
    for (const ContactRow& row : rows) {
      if (row.scene != "crumple, 0.3 s" || row.steps != 1 ||
          row.setting.find("order=mesh") == std::string::npos)
        continue;
      const std::string self = row.setting.substr(5, row.setting.find(',') - 5);
      const double bare = seconds(row, median(row.bare));
      records.push_back(plotted(row, self, bare + seconds_per_step(row)));
      if (self == "grid") records.push_back(plotted(row, "off", bare));
    }
  const report::PlotFiles files =
      report::make_plot({.kind = "scaling",
                         .title = "A step of one sweep, by what keeps the cloth from itself",
                         .file = "self-collision-scaling",
                         .slope = 1},
                        records, {}, folder);
  std::cout << files.svg.string() << '\n' << files.pdf.string() << '\n';
}

Json json_of(const std::vector<Rows>& sizes) {
  Json all = Json::array();
  for (const Rows& rows : sizes)
    for (const ContactRow& row : rows)
      all.push_back({{"scene", row.scene},
                     {"setting", row.setting},
                     {"particles", row.particles},
                     {"steps", row.steps},
                     {"touching", row.touching},
                     {"sweep_ns", row.sweep},
                     {"each_sweep_ns", row.each_sweep},
                     {"each_step_ns", row.each_step}});
  return all;
}

int run(const Options& o) {
  std::vector<Rows> sizes;
  for (const int side : o.sizes) {
    sizes.push_back(bench_contact({.side = side,
                                   .rounds = o.rounds,
                                   .seconds = o.seconds,
                                   .progress = Countdown("timing round")}));
    if (!o.json) print(sizes.back(), side);
  }
  if (o.json)
    print_json(json_of(sizes));
  else if (sizes.size() > 2)
    print_exponents(sizes);
  if (!o.output.empty()) plot(sizes, o.output);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("--sizes", o.sizes, "Vertices along a side (default: 128)")
      ->delimiter(',')
      ->check(CLI::Range(8, 1024));
  add_samples(app, o.rounds, o.seconds);
  add_output(app, o.output, "Folder for a figure of a step over particles: off, octree and grid");
  add_json(app, o.json, "Every row with its samples");
}

}  // namespace
}  // namespace taut::verb::contact

TAUT_VERB(bench_contact) = {
    .name = "bench contact",
    .summary = "Measures contact and self-collision against structural sweeps of the same cloth",
    .example = "taut bench contact\n  taut bench contact --sizes 16,32,64,128,317 -o figures",
    .bind = taut::bind_verb<taut::verb::contact::add_options, taut::verb::contact::run>};
