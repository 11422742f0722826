// The plot of frontiers: how many times harder each parameter can be made, and the predictions of
// theory.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "core/io/text_file.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/numbers.hpp"

namespace taut::report::frontier_plot_test {
namespace {

const double kNone = std::numeric_limits<double>::quiet_NaN();

ParameterFrontier frontier(const std::string& solver, const std::string& name, double from,
                           double good, double theory, bool downwards) {
  ParameterFrontier k;
  k.solver = solver;
  k.parameter = name;
  k.from = from;
  k.good = good;
  k.theory = theory;
  k.downwards = downwards;
  k.bad = downwards ? good / 2 : good * 2;
  k.symptom = "explodes";
  return k;
}

TEST(FrontierPlot, BarsAreHowMuchHarderAParameterMayBeMade) {
  std::vector<ParameterFrontier> all{frontier("jakobsen", "time step", 0.01, 0.08, 0.1, false),
                                     frontier("bullet", "time step", 0.01, 0.02, kNone, false),
                                     frontier("jakobsen", "size, down", 8, 0.5, 0.25, true),
                                     frontier("bullet", "size, down", 8, 2, kNone, true)};
  all[3].bad = kNone;
  const Scratch scratch;
  try {
    plot_frontiers(all, scratch.path(), "frontiers");
  } catch (const InputError&) {
    GTEST_SKIP() << "no gnuplot";
  }
  std::istringstream csv(read_text(scratch.path() / "frontiers.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "solver,parameter,y,half,headroom,theory,end");
  std::vector<std::vector<double>> rows;
  std::vector<std::string> ends;
  while (std::getline(csv, line)) {
    // the name of the parameter may contain a comma and is then quoted
    const std::size_t name =
        line.find('"') == std::string::npos ? line.find(',', 2) : line.find('"', 3) + 1;
    std::istringstream rest(line.substr(name + 1));
    std::vector<double> row{number_at(line)};
    for (std::string cell; std::getline(rest, cell, ',');)
      if (row.size() < 5)
        row.push_back(cell.empty() || cell == "nan" || cell == "NaN" ? kNone : number_at(cell));
      else
        ends.push_back(cell);
    rows.push_back(row);
  }
  ASSERT_EQ(rows.size(), 4u);
  ASSERT_EQ(ends.size(), 4u);
  const double headroom[] = {8, 2, 16, 4}, theory[] = {10, kNone, 32, kNone};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(rows[k][0], static_cast<double>(k % 2)) << "its solver";
    EXPECT_NEAR(rows[k][3], headroom[k], 1e-12);
    if (std::isnan(theory[k])) {
      EXPECT_TRUE(std::isnan(rows[k][4]));
    } else {
      EXPECT_NEAR(rows[k][4], theory[k], 1e-12);
    }
    // bars of a parameter lie side by side within its row
    EXPECT_GT(rows[k][1] - rows[k][2], static_cast<double>(k / 2) - 0.5);
    EXPECT_LT(rows[k][1] + rows[k][2], static_cast<double>(k / 2) + 0.5);
  }
  EXPECT_LE(rows[0][1] + rows[0][2], rows[1][1] - rows[1][2]);
  EXPECT_EQ(ends[0], "explodes");
  EXPECT_EQ(ends[3], "the end of the range");
}

}  // namespace
}  // namespace taut::report::frontier_plot_test
