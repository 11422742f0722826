// Values judged at the end of a run, and how quantities are summed up there.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/metrics/measured.hpp"
#include "tests/support/bodies.hpp"

namespace taut::windows_test {
namespace {

Scene run_of(int steps, double dt) {
  Scene scene;
  scene.steps = steps;
  scene.dt = dt;
  return scene;
}

TEST(LastSecond, IsASecondOfStepsOrWhatThereIs) {
  const auto first = [](int steps, double dt) {
    const LastSecond end(run_of(steps, dt));
    int step = 0;
    while (!end.contains(step)) ++step;
    EXPECT_TRUE(end.contains(steps));
    return step;
  };
  EXPECT_EQ(first(192, 1.0 / 64), 129);
  EXPECT_EQ(first(10, 0.3), 8) << "three steps are nearest to a second";
  EXPECT_EQ(first(10, 0.4), 8) << "2.5 are three";
  EXPECT_EQ(first(10, 5), 10) << "one at least";
  EXPECT_EQ(first(30, 1.0 / 64), 1) << "all but the start";
  EXPECT_EQ(first(1, 1.0 / 64), 1);
}

TEST(LastSecond, HasTenSamplesAtMostWithTheEndAmongThem) {
  const auto samples = [](int steps, double dt) {
    const LastSecond end(run_of(steps, dt));
    std::vector<int> all;
    for (int step = 0; step <= steps; ++step)
      if (end.samples(step)) all.push_back(step);
    return all;
  };
  EXPECT_EQ(samples(192, 1.0 / 64),
            (std::vector{138, 144, 150, 156, 162, 168, 174, 180, 186, 192}));
  EXPECT_EQ(samples(50, 1.0 / 20), (std::vector{32, 34, 36, 38, 40, 42, 44, 46, 48, 50}));
  EXPECT_EQ(samples(50, 1.0 / 19), (std::vector{41, 42, 43, 44, 45, 46, 47, 48, 49, 50}));
  EXPECT_EQ(samples(50, 0.25), (std::vector{47, 48, 49, 50}));
  EXPECT_EQ(samples(3, 1.0 / 64), (std::vector{1, 2, 3}));
}

TEST(Summary, LeavesTheStartOut) {
  Summary s;
  EXPECT_TRUE(std::isnan(s.mean()) && std::isnan(s.max()) && std::isnan(s.peak()));
  s.add(0, true, 100);
  EXPECT_TRUE(std::isnan(s.mean()) && std::isnan(s.peak()));
  s.add(1, false, -7);
  s.add(2, false, -9);
  EXPECT_EQ(s.peak(), -7);
  EXPECT_TRUE(std::isnan(s.max()));
  s.add(3, true, -8);
  s.add(4, true, -10);
  EXPECT_EQ(s.mean(), -9);
  EXPECT_EQ(s.max(), -8);
  EXPECT_EQ(s.peak(), -7);
}

// A value declared as recorded over time exists at every moment; no other value does.
TEST(Metrics, SayWhichValuesTheyHaveAtEveryMoment) {
  Scene scene = sheet(4);
  scene.pins = {0};
  scene.colliders = {{.shape = Plane{.offset = -1}},
                     {.shape = Ball{{0.5, 0.05, 0.5}, 0.3}},
                     {.shape = Box{{0.2, 0, 0.8}, {0.2, 0.3, 0.2}}},
                     {.shape = Capsule{{0.8, 0, 0.1}, {0.9, 0, 0.3}, 0.1}},
                     {.shape = MeshBody{pyramid(0.3, 0.2).mesh(), {0.2, -0.1, 0.2}}}};
  scene.self_collision = SelfCollision{.radius = 0.05};
  Scene slides = sheet(4);
  slides.colliders = {{.shape = Plane{.offset = -1}}};
  for (const MetricEntry* entry : metrics()) {
    auto metric = entry->make(scene);
    const Scene& seen = metric ? scene : slides;
    if (!metric) metric = entry->make(slides);
    if (!metric) continue;  // a metric of scenes with references
    for (const int step : {0, 1}) metric->observe({step, step * seen.dt, seen.start});
    const std::vector<double> now = metric->now({1, seen.dt, seen.start});
    for (std::size_t k = 0; k < now.size(); ++k)
      EXPECT_EQ(entry->values[k].in_series, !std::isnan(now[k])) << entry->values[k].name;
  }
}

TEST(Metrics, AreFoundByTheirValuesAndRolesInOrder) {
  const auto [metric, value] = find_value("stretch.max");
  ASSERT_TRUE(metric && value);
  EXPECT_EQ(metric->name, "stretch");
  EXPECT_EQ(value->name, "stretch.max");
  EXPECT_FALSE(find_value("stretch.most").first);
  EXPECT_EQ(std::ranges::count(value_names(), "penetration.box.mean"), 1);
  const auto with_role = values_with_role();
  EXPECT_EQ(with_role.size(), 11u);
  EXPECT_EQ(with_role.front()->name, "stretch.rms");
  EXPECT_EQ(with_role.back()->name, "slip.distance");
  EXPECT_TRUE(std::ranges::is_sorted(with_role, {}, &ValueSpec::role));
  EXPECT_EQ(to_string(Window::last_second), "last second");
  EXPECT_EQ(to_string(Window::run), "whole run");
  EXPECT_EQ(to_string(Window::end), "end of the run");
  EXPECT_EQ(to_string(Window::none), "");
}

}  // namespace
}  // namespace taut::windows_test
