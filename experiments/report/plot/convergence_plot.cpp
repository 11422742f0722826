#include "experiments/report/plot/convergence_plot.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/answer/answer.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

struct Drawn {
  const char* name;
  const char* label;
  double ConvergencePoint::*value;
};

constexpr Drawn kDrawn[] = {
    {"distance", "RMS distance from the exact step [m]", &ConvergencePoint::distance},
    {"gap", "(G - G*) / (G_0 - G*); of rigid links the share of the squared distance",
     &ConvergencePoint::gap},
    {"stretch", "RMS of length - rest length [m]", &ConvergencePoint::stretch},
    {"residual", "|gradient of G| [N]", &ConvergencePoint::residual}};

const Drawn& find_drawn(std::string_view kind) {
  for (const Drawn& one : kDrawn)
    if (one.name == kind) return one;
  throw InputError("unknown kind '" + std::string(kind) + "'" +
                   suggestion(std::string(kind), convergence_kinds()));
}

}  // namespace

std::vector<std::string> convergence_kinds() {
  std::vector<std::string> names;
  for (const Drawn& one : kDrawn) names.emplace_back(one.name);
  return names;
}

std::filesystem::path plot_convergence(const std::vector<Convergence>& all, std::string_view kind,
                                       const std::string& title,
                                       const std::filesystem::path& folder,
                                       const std::string& stem) {
  const Drawn& drawn = find_drawn(kind);
  std::string csv = "curve,solver,iterations,value\n", plot;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t before = csv.size();
    for (const ConvergencePoint& p : all[i].points)
      if (const double value = p.*drawn.value; value > 0)
        csv += std::to_string(i) + "," + csv_field(all[i].solver) + "," +
               std::to_string(p.iterations) + "," + exact(value) + "\n";
    if (csv.size() == before) continue;
    const bool ends = all[i].floor > 0;
    const SolverStyle style = solver_style(solver_name(all[i].solver));
    plot += (plot.empty() ? "plot " : ", \\\n  ") + ("'" + stem + ".csv'") +
            " skip 1 using (column(1) == " + std::to_string(i) +
            " ? column(3) : NaN):4 with linespoints lc rgb '" + std::string(style.colour.light) +
            "' pt " + std::to_string(style.marker) + " title " +
            gnuplot_string(all[i].solver + (ends ? ": ends at a point of its own" : ""));
  }
  if (plot.empty()) throw InputError("no solver has a " + std::string(kind) + " to draw");
  make_folder(folder);
  write_file(folder / (stem + ".csv"), csv);
  write_file(folder / (stem + ".gp"),
             "# Again: gnuplot -e \"set terminal svg noenhanced; set output '" + stem + ".svg'\" " +
                 stem +
                 ".gp\nset encoding utf8\nset datafile separator ','\nset key below\nset border 3\n"
                 "set tics nomirror\nset grid lc rgb '#E5E7EB'\nset logscale xy\n"
                 "set format y '%g'\nset xlabel 'iterations in one step'\nset title " +
                 gnuplot_string(title) + "\nset ylabel " + gnuplot_string(drawn.label) + "\n" +
                 plot + "\n");
  const std::filesystem::path picture = folder / (stem + ".svg");
  run_gnuplot(folder / (stem + ".gp"),
              "svg noenhanced size 760," + std::to_string(480 + 20 * all.size()) +
                  " font 'sans-serif,13' background '#ffffff'",
              picture);
  return picture;
}

}  // namespace taut::report
