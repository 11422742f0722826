// Figures: failures are drawn, zeros stay, text is taken as it is, files appear whole or not at
// all.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/report/chart.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/gnuplot.hpp"
#include "experiments/report/palette.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report {
namespace {

namespace fs = std::filesystem;

class Figures : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove_all(dir_); }
  void TearDown() override {
    if (getenv("TAUT_KEEP") == nullptr) fs::remove_all(dir_);
  }
  Figure draw(FigureSpec spec, const std::vector<Record>& records) {
    if (spec.formats.size() == 2) spec.formats = {Format::svg};
    return make_figure(spec, {records, {}}, dir_);
  }
  static std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  }
  fs::path dir_ =
      fs::temp_directory_path() / ("taut_figures_" + std::to_string(getpid()) + "_" +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Figures, EveryFileIsThereAndNoTemporaryOne) {
  const auto records = synthetic::iterations("hang");
  const Figure figure =
      make_figure({.kind = "error-iterations", .title = "Stretch_of ~{hang}", .slope = -1},
                  {records, {}}, dir_);
  for (const fs::path& path : {figure.svg, figure.pdf, figure.gp, figure.csv})
    EXPECT_GT(fs::file_size(path), 500U) << path;
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_), fs::directory_iterator()), 4);
  const std::string svg = read_text(figure.svg);
  EXPECT_NE(svg.find(">Stretch_of ~{hang}<"), std::string::npos)
      << "markup must not be interpreted";
  EXPECT_NE(svg.find("theory: slope −1"), std::string::npos);
}

TEST_F(Figures, AFailedCaseIsAGlyphAndARowNeverAGap) {
  const auto records = synthetic::iterations("hang");
  const Figure figure = draw({.kind = "error-iterations"}, records);
  const std::string svg = read_text(figure.svg);
  EXPECT_EQ(count(svg, ">×<"), 1U);
  EXPECT_EQ(count(svg, ">failed<"), 1U);
  EXPECT_EQ(figure.table.rows.size(), records.size());
  EXPECT_EQ(count(read_text(figure.csv), "exploded,nonfinite"), 1U);
  EXPECT_NE(figure.description.find("1 failed"), std::string::npos);
}

TEST_F(Figures, ExactZerosStayOnTheFloorOfALogarithmicAxis) {
  const auto records = synthetic::iterations("ball");
  const Figure figure = draw({.kind = "penetration"}, records);
  // Three zeros of ours, two of Bullet's (its k = 128 exploded): open triangles, gnuplot's point 9.
  EXPECT_EQ(count(read_text(figure.svg), "xlink:href='#gpPt9'") - 1, 5U);
  EXPECT_NE(read_text(figure.csv).find(",0,"), std::string::npos);
}

TEST_F(Figures, AllZeroAllFailedAndNanDrawAllTheSame) {
  auto zeros = synthetic::iterations("ball");
  for (Record& r : zeros) r.values["penetration.max"] = 0;
  EXPECT_NO_THROW(draw({.kind = "penetration", .file = "zeros"}, zeros));
  auto failed = synthetic::iterations("ball");
  for (Record& r : failed) synthetic::fail(r, Status::Kind::timeout, "60 s");
  const Figure figure = draw({.kind = "error-iterations", .file = "failed", .slope = -1}, failed);
  EXPECT_EQ(count(read_text(figure.svg), ">T<"), failed.size());
  auto holes = synthetic::iterations("ball");
  for (std::size_t i = 0; i < holes.size(); i += 3)
    holes[i].values["stretch.rms"] = std::numeric_limits<double>::quiet_NaN();
  holes[1].values["stretch.rms"] = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(draw({.kind = "work-precision", .file = "holes"}, holes));
}

TEST_F(Figures, StabilityMapHasACellAndAGlyphForEachOutcome) {
  const auto records = synthetic::time_steps("hang");
  const Figure figure = draw({.kind = "stability", .title = "Where each stays stable"}, records);
  const std::string svg = read_text(figure.svg);
  std::map<Status::Kind, std::size_t> counts;
  for (const Record& r : records) ++counts[r.status.kind];
  for (const auto& [kind, n] : counts)
    if (const std::string glyph(status_style(kind).glyph); !glyph.empty()) {
      EXPECT_EQ(count(svg, ">" + glyph + "<"), n) << to_string(kind);
    }
  EXPECT_EQ(figure.table.rows.size(), records.size());
}

TEST_F(Figures, NamesWithQuotesCommasAndLineBreaksReachNobodysSyntax) {
  auto records = synthetic::iterations("hang");
  for (Record& r : records) {
    r.params["mode"] = r.params["iterations"] == "4" ? "it's, \"odd\"\n`date` $0 %d" : "plain";
    r.status.reason = "a,b\n\"c\"";
  }
  const Figure figure =
      draw({.kind = "error-iterations", .title = "'; system 'date `id` \\n"}, records);
  EXPECT_NE(read_text(figure.svg).find("'; system 'date `id` \\n"), std::string::npos);
}

TEST_F(Figures, WithoutGnuplotTheErrorSaysWhatToInstallAndDataAreThere) {
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

TEST_F(Figures, ABrokenScriptLeavesNoFile) {
  fs::create_directories(dir_);
  write_file(dir_ / "x.gp", "plot nonsense(\n");
  EXPECT_THROW(run_gnuplot(dir_ / "x.gp", "svg", dir_ / "x.svg"), PlotError);
  EXPECT_EQ(std::distance(fs::directory_iterator(dir_), fs::directory_iterator()), 1);
}

TEST_F(Figures, UnknownKindsAndValuesAreInputErrors) {
  const auto records = synthetic::iterations("hang");
  EXPECT_THROW(draw({.kind = "stabilty"}, records), InputError);
  EXPECT_THROW(draw({.kind = "penetration", .x = "no.such"}, records), InputError);
  EXPECT_THROW(draw({.kind = "series"}, records), InputError);
  EXPECT_THROW(draw({.kind = "stability"}, {}), InputError);
}

TEST(Curves, LabelsNameOnlyWhatVariesAndCurvesKeepTheirSolver) {
  auto records = synthetic::iterations("hang");
  auto more = records;
  for (Record& r : more) r.params["precision"] = "float";
  std::erase_if(more, [](const Record& r) { return r.solver == "bullet"; });
  records.insert(records.end(), more.begin(), more.end());
  const auto curves = make_curves(records, "iterations", "stretch.rms", "iterations");
  ASSERT_EQ(curves.size(), 3U);
  EXPECT_EQ(curves[0].label, "Jakobsen double");
  EXPECT_EQ(curves[1].label, "Jakobsen float");
  EXPECT_EQ(curves[2].label, "Bullet");
  EXPECT_EQ(curves[2].points.size(), 9U);
  EXPECT_NEAR(fitted_slope(curves[0], 1), -0.9, 1e-12);
}

TEST(Curves, AnExplodedCaseNeverEntersTheParetoFront) {
  auto records = synthetic::iterations("hang");
  records[0].values["stretch.rms"] = 1e-9;  // fast and accurate, but it blew up
  records[0].status.kind = Status::Kind::exploded;
  for (const Point& p :
       pareto_front(make_curves(records, "projections", "stretch.rms", "iterations")))
    EXPECT_NE(p.record, &records[0]);
}

TEST(Chart, EndLabelsKeepTheirOrderAndTheirDistance) {
  const auto at = spread_labels({100, 101, 99, 300}, 16, 0, 400);
  EXPECT_LT(at[2], at[0]);
  EXPECT_LT(at[0], at[1]);
  EXPECT_GE(at[0] - at[2], 15.9);
  EXPECT_GE(at[1] - at[0], 15.9);
  EXPECT_DOUBLE_EQ(at[3], 300);
}

TEST(Chart, ExactZerosShareNoPlaceWithATick) {
  const auto records = synthetic::iterations("ball");  // zero from 64 sweeps on
  const Chart chart = curves_chart(
      {.kind = "penetration", .x = "iterations", .y = "penetration.max", .along = "iterations"},
      records);
  for (const auto& [at, label] : chart.y.ticks) EXPECT_GT(chart.y.position(at), 0.12) << label;
}

TEST(Chart, FailuresAloneAreNoFigureOfAValueThatTheSceneLacks) {
  auto records = synthetic::iterations("ball");  // one case explodes, none has a reference
  FigureSpec spec{
      .kind = "error-iterations", .x = "iterations", .y = "reference.rms", .along = "iterations"};
  EXPECT_THROW(curves_chart(spec, records), InputError);
  for (Record& r : records) synthetic::fail(r, Status::Kind::exploded, "nonfinite");
  EXPECT_NO_THROW(curves_chart(spec, records)) << "that everything failed is worth a figure";
}

TEST(Chart, ANarrowOneGivesItsWidthToThePlot) {
  const auto records = synthetic::iterations("ball");
  FigureSpec spec{.kind = "error-iterations",
                  .x = "iterations",
                  .y = "stretch.rms",
                  .along = "iterations",
                  .width = 340,
                  .height = 330};
  const Drawing drawing = draw_chart(curves_chart(spec, records));
  EXPECT_GT(drawing.area.right - drawing.area.left, 0.75 * 340);
  EXPECT_NE(drawing.script.find("Bullet"), std::string::npos) << "its curves are named above it";
}

TEST(Format, SignsThatAKeyboardLacks) {
  EXPECT_EQ(typeset("z^2 - 2 mu z >= 2e-12 m"), "z² − 2 μ z ≥ 2×10⁻¹² m");
  EXPECT_EQ(typeset("0.0156 s x 1, +-mu, pi/2N"), "0.0156 s × 1, ±μ, π/2N");
  EXPECT_EQ(typeset("default: -10, 1e5 to x-2, re-1"), "default: −10, 1×10⁵ to x-2, re-1");
  EXPECT_EQ(typeset("much spins: shape-2, mu_s, box x"), "much spins: shape-2, mu_s, box x");
}

TEST(Palette, SixSettingsOfOneSolverHaveSixDashes) {
  for (const char* solver : {"jakobsen", "bullet", "xpbd", "mass-spring", "bullet-deformable"}) {
    std::set<std::string_view> dashes;
    for (int variant = 0; variant < 6; ++variant) dashes.insert(solver_style(solver, variant).dash);
    EXPECT_EQ(dashes.size(), 6U) << solver;
  }
}

TEST(Format, AnIntervalHasTheDigitsThatItCarries) {
  EXPECT_EQ(decimals_for(0.47), 1);   // 2.79 to 3.26: 3.2 (2.8-3.3)
  EXPECT_EQ(decimals_for(0.108), 2);  // 0.962 to 1.07: 1.00 (0.96-1.07)
  EXPECT_EQ(decimals_for(2.93), 1);   // 6.07 to 9.00: 7.4 (6.1-9.0)
  EXPECT_EQ(decimals_for(8.5), 0);
  EXPECT_EQ(decimals_for(62), 0);
  EXPECT_EQ(decimals_for(0), 6);
  EXPECT_EQ(fixed(-0.934, 2), "−0.93");
  EXPECT_EQ(fixed(-0.003, 2), "0.00");
  EXPECT_EQ(fixed(40.81, 0), "41");
}

TEST(Format, NumbersReadAsPeopleWriteThem) {
  EXPECT_EQ(significant(3.4e-13), "3.4×10⁻¹³");
  EXPECT_EQ(significant(-2e-12), "−2×10⁻¹²");
  EXPECT_EQ(significant(1e7), "10⁷");
  EXPECT_EQ(significant(0.01234), "0.012");
  EXPECT_EQ(significant(9.96), "10");
  EXPECT_EQ(significant(22.04), "22");
  EXPECT_EQ(significant(-1), "−1.0");
  EXPECT_EQ(significant(0), "0");
  EXPECT_EQ(significant(std::nan("")), "–");
  EXPECT_EQ(exact(0.1), "0.1");
  EXPECT_EQ(base64("Man"), "TWFu");
  EXPECT_EQ(base64("Ma"), "TWE=");
  EXPECT_EQ(base64("M"), "TQ==");
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(slug("../a b/ç"), "..-a-b");
}

}  // namespace
}  // namespace taut::report
