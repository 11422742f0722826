// Plots: failures are drawn, zeros stay, text is taken literally, and files appear whole or not at
// all.
#include "experiments/report/plot/plot.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "core/model/input_error.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/numbers.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::plot_test {
namespace {

namespace fs = std::filesystem;

class Plots : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove_all(dir_); }
  void TearDown() override { fs::remove_all(dir_); }
  PlotFiles draw(const PlotSpec& spec, const std::vector<Record>& records,
                 const std::vector<TimeSeries>& series = {}, std::optional<double> slope = {}) {
    return make_plot(spec, {{"", records, series, slope}}, dir_);
  }
  static std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  }
  static std::size_t fields(const std::string& line) {  // of a CSV file
    bool quoted = false;
    std::size_t n = 1;
    for (const char c : line) {
      quoted = quoted != (c == '"');
      n += !quoted && c == ',';
    }
    return n;
  }
  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(dir_), fs::directory_iterator());
  }
  fs::path dir_ =
      fs::temp_directory_path() / ("taut_plots_" + std::to_string(getpid()) + "_" +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Plots, EveryKindGivesFourFilesAndACsvWithOneHeader) {
  const auto records = synthetic::time_steps("ball");
  for (const PlotKind& kind : plot_kinds()) {
    if (kind.name == "series" || kind.name == "scaling" || kind.name == "profile")
      continue;  // these records lack its values
    const PlotFiles plot = draw({.kind = std::string(kind.name),
                                 .y = kind.name == "contact" ? "penetration.max" : "",
                                 .file = "one"},
                                records);
    for (const fs::path& path : {plot.svg, plot.pdf, plot.gp, plot.csv})
      EXPECT_GT(fs::file_size(path), 500U) << path;
    EXPECT_EQ(files(), 4) << kind.name;
    const std::string csv = read_text(plot.csv);
    EXPECT_EQ(csv.find("\n\n"), std::string::npos) << "a block";
    std::size_t lines = 0;
    for (std::size_t from = 0; from < csv.size(); from = csv.find('\n', from) + 1, ++lines)
      EXPECT_EQ(fields(csv.substr(from, csv.find('\n', from) - from)),
                fields(csv.substr(0, csv.find('\n'))));
    EXPECT_GT(lines, 50U) << kind.name;
  }
}

TEST_F(Plots, AFailedCaseIsAMarkAndARowNeverAGap) {
  const PlotFiles plot = draw({.kind = "convergence"}, synthetic::iterations("hang"));
  EXPECT_EQ(count(read_text(plot.csv), ",exploded,nonfinite,yes,"), 1U);
  EXPECT_NE(read_text(plot.svg).find("above: exploded"), std::string::npos);
}

// Nine solvers, each of which would need a row in every panel's key.
TEST_F(Plots, PanelsShareTheirAxesAndOneKey) {
  std::vector<PlotPanel> panels;
  std::vector<std::vector<Record>> all;
  for (const char* scene : {"hang", "ball", "box"}) {
    std::vector<Record>& records = all.emplace_back();
    for (const char* solver : {"a", "b", "c", "d", "e", "f", "g", "h", "i"})
      for (Record r : synthetic::iterations("hang"))
        if (r.solver == "jakobsen") {
          r.scene = scene;
          r.solver = solver;
          records.push_back(r);
        }
  }
  for (Record& r : all[1])
    if (r.status.kind == Status::Kind::ok) r.values["stretch.rms"] *= 100;
  all[2][3].values["stretch.rms"] = 1e-14;  // as far below the other values as rounding
  for (const std::vector<Record>& records : all) panels.push_back({records.front().scene, records});
  panels.push_back({"empty", {}});
  const PlotFiles plot = make_plot({.kind = "convergence", .file = "three"}, panels, dir_);
  EXPECT_EQ(plot.without,
            (std::vector<std::string>{"empty: no case has both 'iterations' and 'stretch.rms'"}));
  const std::string gp = read_text(plot.gp), key = gp.substr(gp.find("# The key"));
  const auto number = [&](const std::string& after) {
    return number_at(gp.substr(gp.find(after) + after.size()));
  };
  EXPECT_EQ(count(gp, "set yrange ["), 1U);
  EXPECT_EQ(count(gp, "set xrange ["), 1U);
  EXPECT_EQ(count(gp, "\nplot '"), 3U);
  for (const char* scene : {"hang", "ball", "box"})
    EXPECT_EQ(count(gp, "set title '" + std::string(scene) + "'\n"), 1U);
  for (const char* solver : {"A", "I"})
    EXPECT_EQ(count(key, " title '" + std::string(solver) + "'"), 1U) << "once for all panels";
  EXPECT_EQ(count(key, "keyentry"), 10U) << "nine, and what is too small";
  EXPECT_EQ(count(gp, " title '"), 3U + 10U) << "no panel has a key of its own";
  EXPECT_EQ(count(key, "below: zero, or less than "), 1U);
  EXPECT_GT(number("set yrange ["), 1e-10) << "one point does not flatten the others";
  // The key widens the figure: two panels side by side keep their width.
  const double left = number("margins screen ");
  const double right = number_at(gp.substr(gp.find(", screen ", gp.find("margins screen ")) + 9));
  EXPECT_GE((right - left) * number("svg noenhanced size "), 500);
  const std::string csv = read_text(plot.csv);
  for (const char* scene : {"hang", "ball", "box"})
    EXPECT_EQ(count(csv, "," + std::string(scene) + "\n"), all[0].size());
}

TEST_F(Plots, ExactZerosStayOnTheFloorOfALogarithmicAxis) {
  const PlotFiles plot =
      draw({.kind = "contact", .y = "penetration.max"}, synthetic::iterations("ball"));
  EXPECT_NE(read_text(plot.svg).find("exactly zero"), std::string::npos);
}

/// Plot commands of a script, one per curve.
std::vector<std::string> drawn_by(const std::string& script) {
  std::vector<std::string> all;
  std::string rest = script.substr(0, script.find("# The key"));
  rest = rest.substr(rest.find("\nplot ") + 6);
  for (std::size_t at; (at = rest.find(", \\\n  ")) != rest.npos; rest = rest.substr(at + 6))
    all.push_back(rest.substr(0, at));
  all.push_back(rest.substr(0, rest.find('\n')));
  return all;
}

/// The line of a script that starts with `begin`.
std::string line_of(const std::string& script, const std::string& begin) {
  const auto at = script.find("\n" + begin);
  return at == script.npos ? "" : script.substr(at + 1, script.find('\n', at + 1) - at - 1);
}

std::string look(const std::string& solver) {
  const SolverStyle style = solver_style(solver);
  std::string dash(style.dash);
  std::ranges::replace(dash, ' ', ',');
  return " lc rgb '" + std::string(style.colour.light) + "' dt " +
         (dash.empty() ? "solid" : "(" + dash + ")") + " pt " + std::string(style.marker);
}

/// Record of a case with this id, with or without a value of stretch.
Record made(const std::string& id, const std::string& solver, int sweeps, double stretch) {
  Record r = synthetic::record("hang", solver, sweeps, 1.0 / 64);
  r.id = r.key = id;
  r.values = {{"stretch.rms", stretch}};
  return r;
}

TEST_F(Plots, AScriptDrawsEveryRowAndFailuresAbove) {
  std::vector<Record> all{made("j1", "jakobsen", 1, 0.08), made("j4", "jakobsen", 4, 0.02),
                          made("j16", "jakobsen", 16, 0),  made("b1", "bullet", 1, 0.3),
                          made("b4", "bullet", 4, 0.1),    made("b,16", "bullet", 16, 0.05)};
  synthetic::fail(all[4], Status::Kind::exploded, Reason::energy);
  const PlotFiles plot = draw({.kind = "convergence", .title = "Two", .file = "one"}, all, {}, -1);
  EXPECT_EQ(read_text(plot.csv),
            "curve,solver,label,x,y,status,reason,failed,setting,case,scene\n"
            "0,jakobsen,Jakobsen,1,0.08,ok,,no,1 × 1,j1,hang\n"
            "0,jakobsen,Jakobsen,4,0.02,ok,,no,1 × 4,j4,hang\n"
            "0,jakobsen,Jakobsen,16,0,ok,,no,1 × 16,j16,hang\n"
            "1,bullet,Bullet,1,0.3,ok,,no,1 × 1,b1,hang\n"
            "1,bullet,Bullet,4,,exploded,energy,yes,1 × 4,b4,hang\n"
            "1,bullet,Bullet,16,0.05,ok,,no,1 × 16,\"b,16\",hang\n");
  const std::string gp = read_text(plot.gp);
  EXPECT_TRUE(
      gp.starts_with("# convergence: stretch.rms over iterations\n# Again: gnuplot -e \"set "
                     "terminal svg noenhanced size "));
  EXPECT_NE(gp.find("; set output 'one.svg'\" one.gp\n"), std::string::npos);
  EXPECT_TRUE(line_of(gp, "set multiplot").starts_with("set multiplot layout 1,1 title 'Two' "));
  EXPECT_EQ(line_of(gp, "set xlabel"), "set xlabel 'sweeps per substep'");
  EXPECT_EQ(line_of(gp, "set ylabel"), "set ylabel 'RMS stretch [%]'");
  EXPECT_EQ(line_of(gp, "set logscale x"), "set logscale x");
  EXPECT_EQ(line_of(gp, "set logscale y"), "set logscale y");
  EXPECT_EQ(line_of(gp, "set xtics"), "set xtics ('1' 1, '4' 4, '16' 16)");
  const std::string range = line_of(gp, "set yrange");  // 2 to 30 %, with a margin
  const double air = std::pow(15, 0.06), top = 30 * air;
  EXPECT_NEAR(number_at(range.substr(12)), 2 / air, 1e-12);
  EXPECT_NEAR(number_at(range.substr(range.find(':') + 1)), top, 1e-9);
  const auto rows = [](int curve, const char* failed) {
    return "'one.csv' skip 1 using (column(1) == " + std::to_string(curve) + " && strcol(8) eq '" +
           failed + "' ? column(4)*1 : NaN):";
  };
  const auto drawn = drawn_by(gp);
  ASSERT_EQ(drawn.size(), 5u);
  const std::string shown = "column(5) > 0 && column(5)*100 >= 3e-07";  // 1e-8 of 30 %
  EXPECT_EQ(drawn[0], rows(0, "no") + "(" + shown + " ? column(5)*100 : NaN) with linespoints" +
                          look("jakobsen") + " notitle");
  const auto ink = [](const char* solver) {
    return " lc rgb '" + std::string(solver_style(solver).colour.light) + "' notitle";
  };
  const auto part = [](const std::string& text, const std::string& from, const std::string& to) {
    const auto at = text.find(from) + from.size();
    return text.substr(at, text.find(to, at) - at);
  };
  const std::string zero = "(column(5) >= 0 && !(" + shown + ") ? ";
  EXPECT_EQ(drawn[1].find(rows(0, "no") + zero), 0u);
  EXPECT_NEAR(number_at(part(drawn[1], zero, " :")), 2 / air, 1e-12) << "the floor";
  EXPECT_TRUE(drawn[1].ends_with(": NaN) with points pt 10 ps 1.2" + ink("jakobsen")));
  EXPECT_EQ(drawn[2], rows(1, "no") + "(" + shown + " ? column(5)*100 : NaN) with linespoints" +
                          look("bullet") + " notitle");
  EXPECT_TRUE(drawn[3].starts_with(rows(1, "yes") + "(")) << drawn[3];
  EXPECT_NEAR(number_at(drawn[3].substr(rows(1, "yes").size() + 1)), top, 1e-9);
  EXPECT_TRUE(drawn[3].ends_with(") with points pt 2 ps 1.2 lw 2" + ink("bullet")));
  // 0.6 of the smallest y x, 0.08, in per cent
  EXPECT_NEAR(number_at(drawn[4].substr(1)), std::pow(16, -0.06), 1e-12);
  EXPECT_NEAR(number_at(drawn[4].substr(drawn[4].find("] ") + 2)), 4.8, 1e-12);
  EXPECT_EQ(drawn[4].substr(drawn[4].find('*')),
            "*(x/1)**-1 with lines dt (4,4) lc rgb '#5B6472' notitle");
  const std::string grey = " lc rgb '#5B6472' title '";
  EXPECT_TRUE(
      gp.ends_with("plot [0:1][0:1] NaN notitle, \\\n  keyentry with linespoints" +
                   look("jakobsen") + " title 'Jakobsen', \\\n  keyentry with linespoints" +
                   look("bullet") + " title 'Bullet', \\\n  keyentry with lines dt (4,4)" + grey +
                   "theory of relaxation: 1/sweeps', \\\n  keyentry with points pt 10 ps 1.2" +
                   grey + "below: exactly zero', \\\n  keyentry with points pt 2 ps 1.2 lw 2" +
                   grey + "above: exploded'\nunset multiplot\n"));
}

// All of up to twelve settings are named in a single plot, up to eight in one of several panels.
TEST_F(Plots, EverySettingIsNamedOnTheAxisIfItFits) {
  const auto named = [&](std::size_t panels, int settings) {
    std::vector<std::vector<Record>> all(panels);
    std::vector<PlotPanel> shown;
    for (std::vector<Record>& records : all) {
      for (int k = 1; k <= settings; ++k) {
        records.push_back(synthetic::record("hang", "jakobsen", k, 1.0 / 64));
        records.back().values["stretch.rms"] = 0.1 / k;
      }
      shown.push_back({std::to_string(shown.size()), records});
    }
    const PlotFiles plot = make_plot({.kind = "convergence", .file = "ticks"}, shown, dir_);
    return count(read_text(plot.gp), "'" + std::to_string(settings) + "' ") > 0;
  };
  EXPECT_TRUE(named(1, 12));
  EXPECT_FALSE(named(1, 13));
  EXPECT_TRUE(named(2, 8));
  EXPECT_FALSE(named(2, 9));
}

TEST_F(Plots, AxesAreAsTheirUnitsSay) {
  std::vector<Record> all;
  for (const auto& [dt, y] : {std::pair{0.002, 0.05}, {0.004, 0.1}, {0.008, 0.25}}) {
    Record r = synthetic::record("hang", "jakobsen", 16, dt);
    r.id = r.key = std::to_string(dt);
    r.values = {{"reference.rms", y}, {"reference.floor", 0.004}, {"settle.time", 4 * y - 0.5}};
    r.projections = static_cast<std::size_t>(1 / dt);
    all.push_back(r);
  }
  const std::string gp = read_text(
      draw({.kind = "convergence", .x = "dt", .y = "reference.rms", .file = "floor"}, all, {}, 2)
          .gp);
  const Unit unit = quantity("reference.rms").unit;
  EXPECT_EQ(line_of(gp, "set xtics"), "set xtics ('2' 2, '4' 4, '8' 8)");
  EXPECT_EQ(line_of(gp, "set xlabel"), "set xlabel 'time step [ms]'");
  const auto drawn = drawn_by(gp);
  ASSERT_EQ(drawn.size(), 3u);
  EXPECT_NE(drawn[0].find("column(4)*1000 : NaN):"), std::string::npos) << drawn[0];
  const double factor = 0.6 * 0.25 / (0.008 * 0.008) * unit.scale;  // the smallest y / x^2
  EXPECT_NEAR(number_at(drawn[1].substr(1)), 2 / 1.12, 1e-12) << drawn[1];
  EXPECT_NEAR(number_at(drawn[1].substr(drawn[1].find("] ") + 2)), factor, 1e-9 * factor);
  EXPECT_NE(drawn[1].find("*(x/1000)**2 with"), std::string::npos);
  EXPECT_NEAR(number_at(drawn[2]), 0.004 * unit.scale, 1e-12);
  EXPECT_TRUE(line_of(gp, "set yrange").starts_with("set yrange ["));
  const double low = number_at(line_of(gp, "set yrange").substr(12));
  EXPECT_LT(low, 0.004 * unit.scale) << "the floor is in the picture";
  EXPECT_GT(low, 0.004 * unit.scale / 3);
  // Values of both signs are drawn on a linear axis that includes zero.
  const std::string linear =
      read_text(draw({.kind = "work-precision", .y = "settle.time", .file = "linear"}, all).gp);
  EXPECT_EQ(line_of(linear, "set logscale y"), "");
  const std::string range = line_of(linear, "set yrange");
  EXPECT_NEAR(number_at(range.substr(12)), -0.3 - 0.06 * 0.8, 1e-12);
  EXPECT_NEAR(number_at(range.substr(range.find(':') + 1)), 0.5 + 0.06 * 0.8, 1e-12);
  EXPECT_NE(linear.find("$front1 << EOD\n"), std::string::npos);
  const std::string front = linear.substr(linear.find("$front1 << EOD\n") + 15);
  EXPECT_TRUE(front.starts_with("125 0.5\n250 -0.09")) << front.substr(0, 40);
}

TEST_F(Plots, AMapHasTicksColoursAndGlyphsInEachPanel) {
  std::vector<Record> all;
  for (const char* solver : {"jakobsen", "bullet"})
    for (const double dt : {0.02, 0.01})
      for (const int sweeps : {4, 1, 16})
        all.push_back(synthetic::record("hang", solver, sweeps, dt));
  for (std::size_t i = 0; i < all.size(); ++i) all[i].id = "c" + std::to_string(i);
  synthetic::fail(all[1], Status::Kind::exploded, Reason::energy);
  for (Record& r : all) r.values.erase("stretch.rms");
  all[4].values["stretch.rms"] = 0.005;
  all[3].values["stretch.rms"] = 0.2;
  const PlotFiles plot = draw({.kind = "stability", .title = "Maps", .file = "map"}, all);
  const std::string csv = read_text(plot.csv), gp = read_text(plot.gp);
  EXPECT_TRUE(
      csv.starts_with("curve,solver,label,x,y,column,row,status,reason,case,stretch\n"
                      "0,jakobsen,Jakobsen,0.01,1,0,0,ok,,c4,0.005\n"
                      "0,jakobsen,Jakobsen,0.02,1,1,0,exploded,energy,c1,\n"
                      "0,jakobsen,Jakobsen,0.01,4,0,1,ok,,c3,0.2\n"))
      << csv;
  EXPECT_NE(csv.find("1,bullet,Bullet,0.02,16,1,2,ok,,c8,\n"), std::string::npos) << csv;
  EXPECT_TRUE(line_of(gp, "set multiplot").starts_with("set multiplot layout 1,2 title 'Maps' "));
  EXPECT_EQ(line_of(gp, "set xlabel"), "set xlabel 'time step [ms]'");
  EXPECT_EQ(line_of(gp, "set ylabel"), "set ylabel 'sweeps per substep'");
  EXPECT_EQ(count(gp, "set xtics ('10' 0, '20' 1)\nset xrange [-0.5:1.5]\n"), 2u);
  EXPECT_EQ(count(gp, "set ytics ('1' 0, '4' 1, '16' 2)\nset yrange [-0.5:2.5]\n"), 2u);
  for (const auto& [curve, title] : {std::pair{"0", "Jakobsen"}, {"1", "Bullet"}})
    for (const Status::Kind kind : {Status::Kind::ok, Status::Kind::exploded}) {
      const StatusStyle style = status_style(kind);
      const std::string name(to_string(kind)),
          cells = "'map.csv' skip 1 using (column(1) == " + std::string(curve) +
                  " && strcol(8) eq '" + name + "' ? column(6) : NaN):7:";
      EXPECT_EQ(count(gp, "set title '" + std::string(title) + "'"), 1u);
      EXPECT_EQ(count(gp, cells + "(0.45):(0.45) with boxxyerror fs solid 1 noborder lc rgb '" +
                              std::string(style.colour.light) + "' notitle"),
                1u);
      EXPECT_EQ(count(gp, "' title '" + name + "'"), 1u) << "in the key, once";
      EXPECT_EQ(count(gp, cells + "('" + std::string(style.glyph) + "') with labels tc rgb '" +
                              std::string(style.ink.light) + "' notitle"),
                1u);
    }
  // Completed runs are shaded by their stretch.
  for (const char* shade : {"RMS stretch up to 1 %", "up to 30 %"})
    EXPECT_EQ(count(gp, " title '" + std::string(shade) + "'"), 1u) << shade;
  EXPECT_EQ(count(gp, "up to 10 %"), 0u);
  EXPECT_EQ(count(gp, " && column(11) > "), 4u) << "a box and a glyph of each of two shades";
  EXPECT_EQ(count(gp, "(strcol(8) eq 'ok' ? '✓' : '~') with labels tc rgb '#1A1A19' notitle"), 1u);
}

// A key beside the figure is as wide as its longest text.
TEST_F(Plots, AFigureIsAsWideAsItIsAskedToBeWithItsKeyBelow) {
  std::vector<std::vector<Record>> all;
  std::vector<PlotPanel> panels;
  for (const char* scene : {"hang", "ball"}) {
    all.push_back(synthetic::iterations(scene));
  }
  for (const std::vector<Record>& records : all) panels.push_back({records.front().scene, records});
  for (const double width : {84.0, 174.0}) {
    const PlotFiles plot = make_plot({.kind = "convergence",
                                      .file = "w" + std::to_string(std::lround(width)),
                                      .size = {.width = width, .font = 8}},
                                     panels, dir_);
    const std::string gp = read_text(plot.gp);
    EXPECT_NE(gp.find("set multiplot layout " + std::string(width < 100 ? "2,1" : "1,2")),
              std::string::npos);
    EXPECT_NE(gp.find(" left top Left reverse vertical maxrows "), std::string::npos);
  }
  EXPECT_THROW(make_plot({.kind = "convergence", .file = "w", .size = {.width = 20}}, panels, dir_),
               InputError);
  EXPECT_THROW(make_plot({.kind = "convergence", .file = "w", .size = {.width = 84, .height = 30}},
                         panels, dir_),
               InputError);
}

TEST_F(Plots, SeriesAreDrawnAsTheyAre) {
  const std::vector<TimeSeries> series{
      {"hang", "jakobsen", "A", "stretch.rms", {0, 0.5, 1}, {0.01, std::nan(""), 0.02}, "k"},
      {"hang", "bullet", "B", "energy.mean", {0, 1}, {9, 9}},
      {"hang", "jakobsen", "C", "stretch.rms", {0, 1}, {0.03, 0.04}, "", 1e-7}};
  const PlotFiles plot = draw({.kind = "series", .file = "t"}, {}, series);
  EXPECT_EQ(read_text(plot.csv),
            "curve,solver,label,x,y,status,reason,failed,setting,case,scene\n"
            "0,jakobsen,A,0,0.01,ok,,no,,k,hang\n0,jakobsen,A,0.5,,ok,,no,,k,hang\n"
            "0,jakobsen,A,1,0.02,ok,,no,,k,hang\n1,jakobsen,C,0,0.03,ok,,no,,,hang\n"
            "1,jakobsen,C,1,0.04,ok,,no,,,hang\n");
  const auto drawn = drawn_by(read_text(plot.gp));
  ASSERT_EQ(drawn.size(), 3u);
  const std::string ink = "lc rgb '" + std::string(solver_style("jakobsen").colour.light) + "' dt ";
  EXPECT_NE(drawn[0].find("(column(5)*100) with lines lw 1.5 " + ink), std::string::npos);
  EXPECT_TRUE(drawn[1].ends_with(" dt (7,4) notitle")) << "another dash of the same solver";
  EXPECT_EQ(count(read_text(plot.gp), " dt (7,4) title 'C'"), 1u);
  EXPECT_NEAR(number_at(drawn[2]), 1e-5, 1e-18) << "the rounding of its file";

  StudyBench bench{"trade", "a machine", {{"hang", {0.99, 1, 1.01}, {}}}};
  bench.scenes[0].limits.emplace();
  for (const auto& [solver, seconds] : {std::pair{"jakobsen", 0.002}, {"bullet", 0.005}}) {
    BenchedCase c{made(solver, solver, 4, 0.005), {}};
    c.timing.samples.assign(4, seconds);
    c.timing.wall = c.timing.samples;
    bench.scenes[0].cases.push_back(c);
  }
  const PlotFiles profile =
      make_profile_plot({.kind = "profile", .title = "P", .file = "p"}, bench, dir_);
  std::istringstream rows(read_text(profile.csv));
  const std::pair<std::string, std::vector<double>> expected[] = {{"0,jakobsen,", {1, 1}},
                                                                  {"0,jakobsen,", {2.75, 1}},
                                                                  {"1,bullet,", {1, 0}},
                                                                  {"1,bullet,", {2.5, 1}},
                                                                  {"1,bullet,", {2.75, 1}}};
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "curve,solver,factor,share");
  for (const auto& [begin, numbers] : expected) {
    ASSERT_TRUE(std::getline(rows, row)) << begin;
    ASSERT_TRUE(row.starts_with(begin)) << row;
    EXPECT_NEAR(number_at(row.substr(begin.size())), numbers[0], 1e-9);
    EXPECT_EQ(number_at(row.substr(row.rfind(',') + 1)), numbers[1]);
  }
  EXPECT_FALSE(std::getline(rows, row));
  const std::string gp = read_text(profile.gp);
  EXPECT_NEAR(number_at(line_of(gp, "set xrange").substr(14)), 2.75, 1e-9);
  EXPECT_EQ(line_of(gp, "set xrange").substr(0, 14), "set xrange [1:");
  EXPECT_EQ(line_of(gp, "set yrange"), "set yrange [0:105]");
  const auto steps = drawn_by(gp);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[1].find("'p.csv' skip 1 using (column(1) == 1 ? column(3) : "
                          "NaN):(100*column(4)) with steps lw 2 lc rgb '" +
                          std::string(solver_style("bullet").colour.light) + "'"),
            0u);
  EXPECT_EQ(count(gp, " title 'Bullet'"), 1u);
}

TEST_F(Plots, AllZeroAllFailedAndNan) {
  auto records = synthetic::iterations("hang");
  for (Record& r : records)
    if (r.status.kind == Status::Kind::ok) r.values["stretch.rms"] = 0;
  EXPECT_NO_THROW(draw({.kind = "convergence"}, records));
  for (Record& r : records) r.values["stretch.rms"] = std::nan("");
  EXPECT_THROW(draw({.kind = "convergence"}, records), InputError);
  for (Record& r : records) synthetic::fail(r, Status::Kind::timeout, "60 s");
  EXPECT_THROW(draw({.kind = "convergence"}, records), InputError);
}

TEST_F(Plots, AMapHasARowForEveryCase) {
  const auto records = synthetic::time_steps("hang");
  const std::string csv = read_text(draw({.kind = "stability"}, records).csv);
  EXPECT_EQ(count(csv, "\n"), records.size() + 1);
}

TEST_F(Plots, NamesWithQuotesAndLineBreaksAreHarmless) {
  auto records = synthetic::iterations("hang");
  for (Record& r : records) {
    r.params["mode"] = r.params["iterations"] == "4" ? "it's, \"odd\"\n`date` $0 %d" : "plain";
    r.status.reason = "a,b\n\"c\"";
  }
  const PlotFiles plot =
      draw({.kind = "convergence", .title = "'; system 'date `id`\n~{x}_y @a"}, records);
  EXPECT_NE(read_text(plot.svg).find("'; system 'date `id` ~{x}_y @a"), std::string::npos);
}

TEST_F(Plots, WithoutGnuplotTheErrorSaysWhatToInstall) {
  fs::create_directories(dir_);
  write_file(dir_ / "x.gp", "plot x\n");
  try {
    run_gnuplot(dir_ / "x.gp", "svg", dir_ / "x.svg", "no-such-gnuplot");
    FAIL();
  } catch (const PlotError& error) {
    EXPECT_NE(std::string(error.what()).find("gnuplot-nox"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(dir_ / "x.svg"));
}

/// gnuplot does not notice a full disk and exits with success.
TEST_F(Plots, APictureWithoutItsEndIsNone) {
  fs::create_directories(dir_);
  write_file(dir_ / "x.gp", "");
  for (const char* written : {"", "<svg>half", "<svg></svg>"}) {
    const fs::path program = dir_ / "gnuplot";
    write_file(program, "#!/bin/bash\nout=${2#*output ?}\nprintf '" + std::string(written) +
                            "' >\"${out%?}\"\n");
    fs::permissions(program, fs::perms::owner_all);
    const auto draw_it = [&] {
      run_gnuplot(dir_ / "x.gp", "svg", dir_ / "x.svg", program.string());
    };
    if (std::string(written).ends_with("</svg>"))
      EXPECT_NO_THROW(draw_it());
    else
      EXPECT_THROW(draw_it(), FigureNotWritten) << written;
    EXPECT_EQ(fs::exists(dir_ / "x.svg"), std::string(written).ends_with("</svg>"));
    EXPECT_EQ(files(), fs::exists(dir_ / "x.svg") ? 3 : 2);
  }
}

TEST_F(Plots, ABrokenScriptLeavesNoFile) {
  fs::create_directories(dir_);
  write_file(dir_ / "x.gp", "plot nonsense(\n");
  EXPECT_THROW(run_gnuplot(dir_ / "x.gp", "svg", dir_ / "x.svg"), PlotError);
  EXPECT_EQ(files(), 1);
}

TEST_F(Plots, UnknownKindsAndValuesHaveASuggestion) {
  const auto records = synthetic::iterations("hang");
  EXPECT_THROW(draw({.kind = "stabilty"}, records), InputError);
  EXPECT_THROW(draw({.kind = "series"}, records), InputError);
  EXPECT_THROW(draw({.kind = "stability"}, {}), InputError);
  try {
    draw({.kind = "convergence", .y = "stretch.rsm"}, records);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'stretch.rms'"), std::string::npos);
  }
}

TEST(Curves, LabelsNameOnlyWhatVaries) {
  auto records = synthetic::iterations("hang");
  for (Record& r : records) r.params["projection"] = "exact";
  auto other = records;
  for (Record& r : other)
    if (r.solver == "jakobsen") r.params["projection"] = "sqrt-free";
  std::erase_if(other, [](const Record& r) { return r.solver == "bullet"; });
  records.insert(records.end(), other.begin(), other.end());
  const auto curves = make_curves(records, "iterations", "stretch.rms", "iterations");
  ASSERT_EQ(curves.size(), 3U);
  EXPECT_EQ(curves[0].label, "Jakobsen exact");
  EXPECT_EQ(curves[1].label, "Jakobsen sqrt-free");
  EXPECT_EQ(curves[2].label, "Bullet");
}

TEST(Curves, TwoTimeStepsAreTwoSetsOfCurves) {
  auto few = synthetic::time_steps("hang");
  std::erase_if(few, [](const Record& r) { return r.dt != 0.001 && r.dt != 0.002; });
  std::set<std::string> labels;
  for (const Curve& c : make_curves(few, "iterations", "stretch.rms", "iterations"))
    labels.insert(c.label);
  EXPECT_EQ(labels, (std::set<std::string>{"Jakobsen 1.00\u00A0ms", "Jakobsen 2.00\u00A0ms",
                                           "Bullet 1.00\u00A0ms", "Bullet 2.00\u00A0ms"}));
  const auto all = synthetic::time_steps("hang");
  const Slice one = hold(all, "dt", 1.0 / 64);
  EXPECT_EQ(make_curves(one.records, "iterations", "stretch.rms", "iterations").size(), 2U);
}

TEST(Curves, SweepsAreSaidInWords) {
  const auto records = synthetic::time_steps("hang");
  std::set<std::string> labels;
  for (const Curve& c : make_curves(records, "dt", "stretch.rms", "dt")) labels.insert(c.label);
  EXPECT_EQ(labels.size(), 14U);
  EXPECT_TRUE(labels.contains("Jakobsen 8 sweeps"));
  EXPECT_TRUE(labels.contains("Bullet 64 sweeps"));
}

TEST(PlotKinds, ContactShowsWhatAMetricDeclaresAsADepth) {
  EXPECT_EQ(find_plot_kind("contact").y, "penetration.peak");
  EXPECT_EQ(find_value(find_plot_kind("contact").y).second->role, Role::vertex_depth);
}

TEST(PlotKinds, HaveTheSlopesOfTheirTheories) {
  EXPECT_EQ(find_plot_kind("contact").slope, PlotKind::Slope::none);
  EXPECT_EQ(find_plot_kind("convergence").slope, PlotKind::Slope::of_scene);
  EXPECT_EQ(find_plot_kind("scaling").slope, PlotKind::Slope::one);
}

TEST(Curves, SolversStandAsTheRecordsHaveThem) {
  auto records = synthetic::iterations("hang");
  EXPECT_EQ(make_curves(records, "iterations", "stretch.rms", "iterations")[0].solver, "jakobsen");
  std::ranges::reverse(records);
  EXPECT_EQ(make_curves(records, "iterations", "stretch.rms", "iterations")[0].solver, "bullet");
}

TEST(Curves, AnExplodedCaseNeverEntersTheParetoFront) {
  auto records = synthetic::iterations("hang");
  for (Record& r : records)
    if (r.status.kind == Status::Kind::exploded) r.values["stretch.rms"] = 1e-9;
  const Chart chart = make_chart("work", records, "projections", "stretch.rms", "setting");
  const auto front = pareto_front(chart);
  ASSERT_GT(front.size(), 3U);
  for (const Point& p : front) EXPECT_EQ(p.record->status.kind, Status::Kind::ok);
  for (std::size_t i = 1; i < front.size(); ++i) {
    EXPECT_GT(front[i].x, front[i - 1].x);
    EXPECT_LT(front[i].y, front[i - 1].y);
  }
}

TEST(Format, SignsThatAKeyboardLacks) {
  EXPECT_EQ(typeset("z^2 - 2 mu z >= 2e-12 m"), "z² − 2 μ z ≥ 2×10⁻¹² m");
  EXPECT_EQ(typeset("0.0156 s x 1, +-mu, pi/2N"), "0.0156 s × 1, ±μ, π/2N");
  EXPECT_EQ(typeset("default: -10, 1e5 to x-2, re-1"), "default: −10, 1×10⁵ to x-2, re-1");
  EXPECT_EQ(typeset("much spins: shape-2, mu_s, box x"), "much spins: shape-2, mu_s, box x");
}

TEST(Format, AnIntervalHasTheDigitsThatItCarries) {
  EXPECT_EQ(decimals_for(0.47), 1);   // 2.79 to 3.26: 3.2 (2.8-3.3)
  EXPECT_EQ(decimals_for(0.108), 2);  // 0.962 to 1.07: 1.00 (0.96-1.07)
  EXPECT_EQ(decimals_for(62), 0);
  EXPECT_EQ(decimals_for(0), 6);
  EXPECT_EQ(fixed(-0.934, 2), "−0.93");
  EXPECT_EQ(fixed(-0.003, 2), "0.00");
}

TEST(Format, NumbersReadAsPeopleWriteThem) {
  EXPECT_EQ(significant(3.4e-13), "3.4×10⁻¹³");
  EXPECT_EQ(significant(-2e-12), "−2×10⁻¹²");
  EXPECT_EQ(significant(1e7), "10⁷");
  EXPECT_EQ(significant(0.01234), "0.012");
  EXPECT_EQ(significant(9.96), "10");
  EXPECT_EQ(significant(-1), "−1.0");
  EXPECT_EQ(significant(std::nan("")), "–");
  EXPECT_EQ(exact(0.1), "0.1");
  EXPECT_EQ(base64("Man"), "TWFu");
  EXPECT_EQ(base64("M"), "TQ==");
  EXPECT_EQ(slug("a-b_c.2"), "a-b_c.2");
  EXPECT_TRUE(slug("../a b/ç").starts_with("a-b-"));
  EXPECT_TRUE(slug("-o").starts_with("o-"));
  std::set<std::string> slugs;
  for (const char* name : {"a-b", "a b", "a_b", "a+b", "a--b", "a-b-", "-a-b", "ç", "é", ""})
    EXPECT_TRUE(slugs.insert(slug(name)).second) << name;
  EXPECT_EQ(slug(std::string(300, 'a') + "b").size(), 129U);
  EXPECT_NE(slug(std::string(300, 'a') + "b"), slug(std::string(300, 'a') + "c"));
  EXPECT_EQ(joined({"ball", "box", "hang"}), "ball, box and hang");
}

}  // namespace
}  // namespace taut::report::plot_test
