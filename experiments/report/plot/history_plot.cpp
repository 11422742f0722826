// A value over builds: a line for each case, a mark at each step.
#include <algorithm>
#include <cmath>

#include "experiments/history/history_answer.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/report/plot/sheet.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

namespace {

/// Ticks of the axis, which name at most kMost builds at equal intervals.
std::string build_ticks(const History& history) {
  constexpr std::size_t kMost = 10;
  const std::size_t each = (history.builds.size() + kMost - 1) / kMost;
  std::string ticks;
  for (std::size_t i = 0; i < history.builds.size(); i += each)
    ticks += (i ? ", " : "") + gnuplot_string(short_build(history.builds[i].id)) + " " +
             std::to_string(i);
  return ticks;
}

/// Rows for each case and build: the line, its position, and whether it stepped there.
std::string history_rows(const History& history, const std::string& value, double scale) {
  std::string csv = "case,line,build,at,value,stepped\n";
  for (std::size_t r = 0; r < history.rows.size(); ++r)
    for (std::size_t i = 0; i < history.builds.size(); ++i) {
      const HistoryRow& row = history.rows[r];
      double number = std::nan("");
      if (row.points[i] && row.points[i]->values.contains(value))
        number = scale * row.points[i]->values.at(value);
      const bool stepped = std::ranges::any_of(history.steps, [&](const HistoryStep& step) {
        return step.row == r && step.now == i && step.what == changing(value);
      });
      csv += csv_field(row.id) + "," + std::to_string(r) + "," +
             csv_field(short_build(history.builds[i].id)) + "," + std::to_string(i) + "," +
             exact(number) + "," + (stepped ? exact(number) : "") + "\n";
    }
  return csv;
}

}  // namespace

std::filesystem::path plot_history(const History& history, const std::string& value,
                                   const std::filesystem::path& folder, const std::string& stem) {
  constexpr std::size_t kMostLines = 24;
  const Quantity q = quantity(value);
  std::string plot;
  for (std::size_t r = 0; r < std::min(history.rows.size(), kMostLines); ++r) {
    const std::string rows = "'" + stem + ".csv' skip 1 using (column(2) == " + std::to_string(r) +
                             " ? column(4) : NaN):";
    const std::string colour = " lc rgb '" + colour_of(history.rows[r].solver) + "' ";
    const std::string dash = "dt " + gnuplot_dash(history.rows[r].solver, static_cast<int>(r % 6));
    plot += (plot.empty() ? "plot " : ", \\\n  ") + rows + "5 with linespoints pt 7 ps 0.4 " +
            dash + colour + "title " + gnuplot_string(history.rows[r].id) + ", \\\n  " + rows +
            "6 with points pt 6 ps 1.6 lw 2" + colour + "notitle";
  }
  const std::string script =
      "# " + value +
      " over builds; a circle where it stepped.\n# Again: gnuplot -e \"set terminal "
      "svg noenhanced; set output '" +
      stem + ".svg'\" " + stem +
      ".gp\nset encoding utf8\nset datafile separator ','\nset key outside right top\n"
      "set border 3\nset tics nomirror\nset grid y lc rgb '#E5E7EB'\nset xrange [-0.5:" +
      exact(static_cast<double>(history.builds.size()) - 0.5) + "]\nset xtics rotate by -35 (" +
      build_ticks(history) + ")\nset ylabel " +
      gnuplot_string(q.title +
                     (q.unit.shown.empty() ? "" : " [" + std::string(q.unit.shown) + "]")) +
      "\n" + plot + "\n";
  make_folder(folder);
  write_file(folder / (stem + ".csv"), history_rows(history, value, q.unit.scale));
  write_file(folder / (stem + ".gp"), script);
  const std::filesystem::path picture = folder / (stem + ".svg");
  run_gnuplot(folder / (stem + ".gp"),
              "svg noenhanced size 1100,460 font 'sans-serif,13' background '#ffffff'", picture);
  return picture;
}

}  // namespace taut::report
