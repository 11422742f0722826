// Properties that panels share: scales, ends, labels on the axis, dashes; and the points on the
// front.

#include "experiments/report/chart/frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "tests/support/synthetic_records.hpp"

namespace taut::report::frame_test {
namespace {

/// Charts of curves over sweeps; owns the curves that they point to.
class Charts {
 public:
  Chart of(const std::string& scene, const std::vector<std::pair<double, double>>& points,
           const std::string& label = "Jakobsen") {
    Chart chart{
        .id = scene, .scene = scene, .x = quantity("iterations"), .y = quantity("drift.max")};
    Curve curve{label, "jakobsen", 0, {}};
    for (const auto& [x, y] : points) {
      Record& r = records_.emplace_back(synthetic::record(scene, "jakobsen", 1, 0.01));
      r.key = std::to_string(records_.size());
      curve.points.push_back({x, y, x, &r});
    }
    chart.curves.push_back(std::move(curve));
    return chart;
  }
  Record& last() { return records_.back(); }

 private:
  std::deque<Record> records_;
};

TEST(Scales, HaveAirAndNoMoreThanTheirValues) {
  const Scale log = scale_of(true, {-1, 0, 1, 100, std::nan("")});
  EXPECT_TRUE(log.logarithmic);
  EXPECT_NEAR(log.low, std::pow(100, -0.06), 1e-12);
  EXPECT_NEAR(log.high, 100 * std::pow(100, 0.06), 1e-9);
  EXPECT_NEAR(scale_of(true, {5}).high, 5 * 1.12, 1e-12) << "of one value";
  EXPECT_EQ(scale_of(true, {0}).low, 0.1) << "of none";
  const Scale linear = scale_of(false, {8, 10});
  EXPECT_NEAR(linear.low, 8 - 0.12, 1e-12);
  EXPECT_NEAR(linear.high, 10 + 0.12, 1e-12);
  EXPECT_EQ(scale_of(false, {4.9, 10}).low, 0) << "zero is near";
  EXPECT_LT(scale_of(false, {-1, 10}).low, -1);
  EXPECT_EQ(scale_of(false, {0, 0}).low, 0);
  EXPECT_GT(scale_of(false, {0, 0}).high, 1);
}

TEST(Frames, SpanAllPanelsInShownUnits) {
  Charts charts;
  const std::vector<Chart> both{charts.of("hang", {{1, 0.1}, {4, 0.01}}),
                                charts.of("ball", {{64, 0.5}, {8, 0}})};
  ASSERT_EQ(both[0].y.unit.scale, 1000) << "millimetres";
  const Frame log = frame_of(both, true);
  EXPECT_TRUE(log.x.logarithmic);
  EXPECT_LT(log.x.low, 1);
  EXPECT_GT(log.x.high, 64);
  EXPECT_LT(log.y.low, 10);
  EXPECT_GT(log.y.low, 5);
  EXPECT_GT(log.y.high, 500);
  EXPECT_NEAR(log.least, 500 / 1e8, 1e-12);
  EXPECT_EQ(frame_of(both, false).y.low, 0);
  EXPECT_TRUE(on_axis(both[1].curves[0].points[1], both[1].y.unit, log));
  EXPECT_FALSE(on_axis(both[1].curves[0].points[0], both[1].y.unit, log));
  EXPECT_FALSE(on_axis(both[1].curves[0].points[1], both[1].y.unit, frame_of(both, false)));
}

TEST(Frames, OneTinyValueDoesNotFlattenTheOthers) {
  Charts charts;
  const std::vector<Chart> one{charts.of("hang", {{1, 1}, {2, 1e-12}})};
  const Frame log = frame_of(one, true);
  EXPECT_GT(log.y.low, 100) << "of 1000 mm";
  EXPECT_TRUE(on_axis(one[0].curves[0].points[1], one[0].y.unit, log));
}

TEST(Frames, HaveTheIntervalsOfCosts) {
  Charts charts;
  Chart chart = charts.of("hang", {{1, 1}, {2, 1}});
  chart.cost[charts.last().key] = {1.5, 2, 30};
  EXPECT_GT(frame_of({&chart, 1}, true).x.high, 30);
}

TEST(Figures, CountVariantsOverAllPanelsAndDropFloorsFarBelow) {
  Charts charts;
  std::vector<Chart> all{charts.of("hang", {{1, 1}}, "Jakobsen mesh"),
                         charts.of("ball", {{1, 1}}, "Jakobsen coloured"),
                         charts.of("box", {{1, 1}}, "Jakobsen mesh")};
  all[0].floor = {1 / 31.0, "far below"};
  all[1].floor = {1 / 29.0, "near"};
  const Figure figure = figure_of(all);
  EXPECT_EQ(figure.charts[0].curves[0].variant, 0);
  EXPECT_EQ(figure.charts[1].curves[0].variant, 1);
  EXPECT_EQ(figure.charts[2].curves[0].variant, 0);
  EXPECT_FALSE(figure.charts[0].floor);
  EXPECT_TRUE(figure.charts[1].floor);
}

TEST(Figures, HaveChartsOfTheSameQuantities) {
  Charts charts;
  std::vector<Chart> all{charts.of("hang", {{1, 1}}), charts.of("hang", {{1, 1}}),
                         charts.of("ball", {{1, 1}})};
  all[1].y = quantity("stretch.rms");
  const std::vector<Figure> figures = figures_of(all);
  ASSERT_EQ(figures.size(), 2u);
  EXPECT_EQ(figures[0].charts.size(), 2u);
  EXPECT_EQ(figures[1].charts[0].y.name, "stretch.rms");
}

TEST(Fronts, LeaveOutWhatDoesNotCount) {
  Charts charts;
  Chart chart = charts.of("hang", {{4, 0.1}, {2, 0.01}});
  ASSERT_EQ(pareto_front(chart).size(), 1u);
  EXPECT_EQ(pareto_front(chart)[0].x, 2);
  chart.not_counted[charts.last().key] = "hardly moves";
  ASSERT_EQ(pareto_front(chart).size(), 1u);
  EXPECT_EQ(pareto_front(chart)[0].x, 4);
}

}  // namespace
}  // namespace taut::report::frame_test
