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
  Format format;
};

using Rows = std::vector<ContactRow>;

double seconds(const ContactRow& row, double ns_per_particle) {
  return 1e-9 * static_cast<double>(row.particles) * ns_per_particle;
}
/// Contact of a step with one sweep [s].
double seconds_per_step(const ContactRow& row) {
  return seconds(row, median(row.each_step) + median(row.each_sweep));
}

constexpr Unit kNs = kNanoseconds;

Table table_of(const std::vector<Rows>& sizes) {
  Table table{"contact",
              "CPU time a particle; contact of a step in structural sweeps, 95 %",
              {{"particles"},
               {"scene"},
               {"setting"},
               {"steps"},
               {"touching", "touching", kShare},
               {"sweep", "a sweep of links", kNs},
               {"each_sweep", "contact in each sweep", kNs},
               {"each_step", "in each step besides", kNs},
               {"ratio_1", "step of 1 sweep"},
               {"ratio_10", "step of 10 sweeps"}}};
  for (const Rows& rows : sizes)
    for (const ContactRow& row : rows)
      table.rows.push_back({row.particles, row.scene, row.setting, row.steps, row.touching,
                            1e-9 * median(row.sweep), 1e-9 * median(row.each_sweep),
                            1e-9 * median(row.each_step), row.ratio(1), row.ratio(10)});
  return table;
}

Table samples_of(const std::vector<Rows>& sizes) {
  Table table{"samples",
              "samples",
              {{"particles"},
               {"scene"},
               {"setting"},
               {"steps"},
               {"sweep", "a sweep of links", kNs},
               {"each_sweep", "contact in each sweep", kNs},
               {"each_step", "in each step besides", kNs}}};
  for (const Rows& rows : sizes)
    for (const ContactRow& row : rows)
      for (std::size_t i = 0; i < row.sweep.size(); ++i)
        table.rows.push_back({row.particles, row.scene, row.setting, row.steps, 1e-9 * row.sweep[i],
                              1e-9 * row.each_sweep[i], 1e-9 * row.each_step[i]});
  table.detail = true;
  return table;
}

/// Contact's cost of a step over the number of particles, as a power law, setting by setting.
Table exponents(const std::vector<Rows>& sizes) {
  Table table{"exponents",
              "exponent of contact's cost over particles, 95 %",
              {{"scene"}, {"setting"}, {"steps"}, {"exponent"}}};
  for (std::size_t i = 0; i < sizes.front().size(); ++i) {
    std::vector<double> n, cost;
    for (const Rows& rows : sizes)
      if (const double seconds = seconds_per_step(rows[i]); seconds > 0)
        n.push_back(static_cast<double>(rows[i].particles)), cost.push_back(seconds);
    if (n.size() < 3) continue;
    const PowerLaw law = fit_power_law(n, cost);
    const ContactRow& row = sizes.front()[i];
    table.rows.push_back({row.scene, row.setting, row.steps, interval_of_exponent(law)});
  }
  return table;
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
  progress() << files.svg.string() << '\n' << files.pdf.string() << '\n';
}

int run(const Options& o) {
  std::vector<Rows> sizes;
  for (const int side : o.sizes)
    sizes.push_back(bench_contact({.side = side,
                                   .rounds = o.rounds,
                                   .seconds = o.seconds,
                                   .progress = Countdown("timing round")}));
  Answer answer{"bench contact"};
  answer.add(table_of(sizes));
  answer.add(exponents(sizes));
  answer.add(samples_of(sizes));
  print(answer, o.format);
  if (!o.output.empty()) plot(sizes, o.output);
  return kPass;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("--sizes", o.sizes, "Vertices along a side (default: 128)")
      ->delimiter(',')
      ->check(CLI::Range(8, 1024));
  add_samples(app, o.rounds, o.seconds);
  add_output(app, o.output, "Folder for a figure of a step over particles: off, octree and grid");
  add_format(app, o.format, "Print every sample, too");
}

}  // namespace
}  // namespace taut::verb::contact

TAUT_VERB(bench_contact) = {
    .name = "bench contact",
    .summary = "Measures contact and self-collision against structural sweeps of the same cloth",
    .example = "taut bench contact\n  taut bench contact --sizes 16,32,64,128,317 -o figures",
    .bind = taut::bind_verb<taut::verb::contact::add_options, taut::verb::contact::run>};
