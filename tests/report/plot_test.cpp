// Plots: failures are drawn, zeros stay, text is taken as it is, files appear whole or not at all.
#include "experiments/report/plot/plot.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::plot_test {
namespace {

namespace fs = std::filesystem;

class Plots : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove_all(dir_); }
  void TearDown() override { fs::remove_all(dir_); }
  PlotFiles draw(const PlotSpec& spec, const std::vector<Record>& records,
                 const std::vector<TimeSeries>& series = {}) {
    return make_plot(spec, records, series, dir_);
  }
  static std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  }
  static std::size_t fields(const std::string& line) {  // of CSV
    bool quoted = false;
    std::size_t n = 1;
    for (const char c : line) quoted = quoted != (c == '"'), n += !quoted && c == ',';
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
      continue;  // these records have no such
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
  EXPECT_NE(read_text(plot.svg).find("Bullet: failed"), std::string::npos);
  EXPECT_EQ(read_text(plot.svg).find("Jakobsen: failed"), std::string::npos);
}

TEST_F(Plots, ExactZerosStayOnTheFloorOfALogarithmicAxis) {
  const PlotFiles plot =
      draw({.kind = "contact", .y = "penetration.max"}, synthetic::iterations("ball"));
  EXPECT_NE(read_text(plot.svg).find("exactly zero"), std::string::npos);
}

TEST_F(Plots, OnlyASolverThatReachedZeroIsSaidToHave) {
  auto records = synthetic::iterations("ball");
  bool first = true;
  for (Record& r : records) {
    if (r.status.kind != Status::Kind::ok) continue;
    const bool ours = r.solver == "jakobsen";
    r.values["penetration.max"] = ours && first ? 0 : 0.01;
    first = first && !ours;
  }
  const PlotFiles plot = draw({.kind = "contact", .y = "penetration.max"}, records);
  EXPECT_NE(read_text(plot.svg).find("Jakobsen: exactly zero"), std::string::npos);
  EXPECT_EQ(read_text(plot.svg).find("Bullet: exactly zero"), std::string::npos);
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

TEST_F(Plots, NamesWithQuotesCommasAndLineBreaksReachNobodysSyntax) {
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

TEST_F(Plots, ABrokenScriptLeavesNoFile) {
  fs::create_directories(dir_);
  write_file(dir_ / "x.gp", "plot nonsense(\n");
  EXPECT_THROW(run_gnuplot(dir_ / "x.gp", "svg", dir_ / "x.svg"), PlotError);
  EXPECT_EQ(files(), 1);
}

TEST_F(Plots, UnknownKindsAndValuesAreInputErrorsWithASuggestion) {
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

TEST(Curves, LabelsNameOnlyWhatVariesAndCurvesKeepTheirSolver) {
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

TEST(Curves, TwoTimeStepsAreTwoSetsOfCurvesManyAreHeldAtOne) {
  const auto all = synthetic::time_steps("hang");
  auto few = all;
  std::erase_if(few, [](const Record& r) { return r.dt != 0.001 && r.dt != 0.002; });
  const Slice both = hold(few, "dt", 1.0 / 64), one = hold(all, "dt", 1.0 / 64);
  EXPECT_TRUE(std::isnan(both.value));
  EXPECT_EQ(one.value, 1.0 / 64);
  std::set<std::string> labels;
  for (const Curve& c : make_curves(both.records, "iterations", "stretch.rms", "iterations"))
    labels.insert(c.label);
  EXPECT_EQ(labels, (std::set<std::string>{"Jakobsen 1.00\u00A0ms", "Jakobsen 2.00\u00A0ms",
                                           "Bullet 1.00\u00A0ms", "Bullet 2.00\u00A0ms"}));
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
