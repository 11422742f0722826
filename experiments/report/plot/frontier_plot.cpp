// Bars that show how far each parameter goes.
#include <algorithm>
#include <cmath>

#include "core/model/solver.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

std::string symptom_text(const ParameterFrontier& one) {
  if (!one.lacks.empty()) return "";
  return std::isnan(one.bad) ? "the end of the range" : one.symptom;
}

double theory_headroom(const ParameterFrontier& one) {
  return one.downwards ? one.from / one.theory : one.theory / one.from;
}

/// Rows for each frontier: place and length of its bar. `most` grows to the longest.
std::string frontier_rows(const std::vector<ParameterFrontier>& all,
                          const std::vector<std::string>& parameters,
                          const std::vector<std::string>& solvers, double& most) {
  const double height = 0.8 / static_cast<double>(std::max<std::size_t>(solvers.size(), 1));
  std::string csv = "solver,parameter,y,half,headroom,theory,end\n";
  for (const ParameterFrontier& one : all) {
    const auto row = std::ranges::find(parameters, one.parameter) - parameters.begin(),
               place = std::ranges::find(solvers, one.solver) - solvers.begin();
    const double y = static_cast<double>(row) - 0.4 + (static_cast<double>(place) + 0.5) * height;
    const double headroom = std::isnan(one.headroom()) ? 1 : one.headroom();
    const double theory = theory_headroom(one);
    most = std::max({most, headroom, std::isnan(theory) ? 1 : theory});
    csv += std::to_string(place) + "," + csv_field(one.parameter) + "," + exact(y) + "," +
           exact(0.45 * height) + "," + exact(headroom) + "," + exact(theory) + "," +
           csv_field(symptom_text(one)) + "\n";
  }
  return csv;
}

/// Bars for the rows of each solver, the names of their ends, and the ends according to theory.
std::string frontier_bars(const std::vector<std::string>& solvers, const std::string& stem) {
  std::string plot;
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    const std::string name = parse_solver(solvers[i]).entry->name.data();
    const std::string rows = "'" + stem + ".csv' skip 1 using (column(1) == " + std::to_string(i);
    // Two settings of one solver share its colour; the second is paler.
    const bool again = i > 0 && parse_solver(solvers[i - 1]).entry->name == name;
    plot += (plot.empty() ? "plot " : ", \\\n  ") + rows +
            " ? 1 : NaN):3:(1):5:($3-$4):($3+$4) with boxxyerror fs solid " +
            (again ? "0.5" : "1") + " noborder lc rgb '" +
            std::string(solver_style(name).colour.light) + "' title " + gnuplot_string(solvers[i]) +
            ", \\\n  " + rows + " ? column(5) : NaN):3:(' '.strcol(7)) with labels left notitle" +
            ", \\\n  " + rows + " ? column(6) : NaN):3 with points pt 2 lc rgb '#111827' " +
            (i == 0 ? "title 'theory'" : "notitle");
  }
  return plot;
}

}  // namespace

std::filesystem::path plot_frontiers(const std::vector<ParameterFrontier>& all,
                                     const std::filesystem::path& folder, const std::string& stem) {
  std::vector<std::string> parameters, solvers;
  for (const ParameterFrontier& one : all) {
    push_unique(parameters, one.parameter);
    push_unique(solvers, one.solver);
  }
  double most = 10;
  std::string ticks;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    ticks += (k ? ", " : "") + gnuplot_string(parameters[k]) + " " + std::to_string(k);
  const std::string csv = frontier_rows(all, parameters, solvers, most);
  const std::string script =
      "# How far each parameter goes on the standard scene.\n# Again: gnuplot -e \"set terminal "
      "svg noenhanced; set output '" +
      stem + ".svg'\" " + stem +
      ".gp\nset encoding utf8\nset datafile separator ','\nset key outside top center horizontal\n"
      "set border 3\nset tics nomirror\nset grid x lc rgb '#E5E7EB'\nset logscale x\n"
      "set format x '%g'\nset xlabel 'times harder than where it starts'\nset xrange [1:" +
      exact(most * 300) + "]\nset yrange [" + std::to_string(parameters.size()) + "-0.5:-0.5]\n" +
      "set ytics (" + ticks + ")\n" + frontier_bars(solvers, stem) + "\n";
  make_folder(folder);
  write_file(folder / (stem + ".csv"), csv);
  write_file(folder / (stem + ".gp"), script);
  const std::filesystem::path picture = folder / (stem + ".svg");
  run_gnuplot(folder / (stem + ".gp"),
              "svg noenhanced size 900," + std::to_string(140 + 22 * all.size()) +
                  " font 'sans-serif,13' background '#ffffff'",
              picture);
  return picture;
}

}  // namespace taut::report
