// Texts of a chart: none lies on another or on a marker, whatever the data.
#include "experiments/report/labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/report/chart.hpp"
#include "experiments/report/format.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report {
namespace {

TEST(Box, TurnedOnesMeetWhereTheirSidesDo) {
  const Box level{0, 0, 100, 10};
  EXPECT_TRUE(level.meets({40, 8, 100, 10}));
  EXPECT_FALSE(level.meets({40, 10, 100, 10})) << "an edge is no area";
  // A bar at 45 degrees: its upright bounding box covers this one, the bar itself does not.
  const Box slanted{0, 0, 100, 10, std::numbers::pi / 4};
  EXPECT_FALSE(slanted.meets({25, 25, 20, 10}));
  EXPECT_TRUE(slanted.meets({25, -25, 20, 10})) << "anticlockwise is up on the right";
  EXPECT_FALSE(Box({25, 25, 20, 10}).meets(slanted));
}

TEST(Labels, TextsAreAsWideAsTheWidestFont) {
  // DejaVu Sans at 100 px: an i, an m, a multiplication sign.
  EXPECT_NEAR(text_width("i", 100), 27.8, 0.1);
  EXPECT_NEAR(text_width("m", 100), 97.4, 0.1);
  EXPECT_NEAR(text_width("×", 100), 83.8, 0.1);
  EXPECT_DOUBLE_EQ(text_width("im×", 12), text_width("i") + text_width("m") + text_width("×"));
}

TEST(Labels, ATextMovesOffALineAndIsLeftOutWhereNothingIsFree) {
  Labels labels(200, 100);
  const Label above{"64", 100, 40, Anchor::center, "#000000"},
      below{"64", 100, 60, Anchor::center, "#000000"};
  labels.line(0, 40, 200, 40);
  ASSERT_TRUE(labels.place({above, below}));
  EXPECT_EQ(labels.all().back().y, 60);
  labels.mark({100, 40, 8, 8});
  EXPECT_FALSE(labels.place({above, below})) << "a marker here, a text there";
  EXPECT_EQ(labels.all().size(), 1U);
  EXPECT_FALSE(labels.place({{"64", 4, 20, Anchor::center, "#000000"}})) << "it would be cut off";
}

/// Many settings at nearly the same cost and error, failures beside each other, one far away.
std::vector<Record> crowd(int solvers) {
  const std::string names[] = {"jakobsen", "bullet", "xpbd", "mass-spring", "bullet-deformable"};
  std::vector<Record> all;
  for (int s = 0; s < solvers; ++s)
    for (int i = 0; i < 24; ++i) {
      const int sweeps = 1 << (i % 5), substeps = 1 + i / 5 * (s + 1);
      Record r = synthetic::record("hang", names[s], sweeps, 1.0 / 64);
      r.params["substeps"] = std::to_string(substeps);
      r.params["order"] = i % 3 == 0 ? "coloured" : "mesh";
      r.params["tethers"] = i % 4 == 0 ? "on" : "off";
      r.id += std::to_string(i);
      r.values["stretch.rms"] = 0.01 * (1 + 0.2 * std::sin(7.0 * i + s));
      r.values["cpu.per_second"] = 0.02 * (1 + 0.15 * std::cos(5.0 * i + s));
      r.values["reference.strain"] = 0.0095;
      if (i == 7) r.values["cpu.per_second"] = 3;
      if (i > 17) synthetic::fail(r, i % 2 ? Status::Kind::exploded : Status::Kind::timeout, "x");
      all.push_back(r);
    }
  return all;
}

void expect_no_overlap(const Drawing& drawing, const std::string& which) {
  ASSERT_FALSE(drawing.texts.empty());
  for (std::size_t i = 0; i < drawing.texts.size(); ++i) {
    const Label& a = drawing.texts[i];
    for (std::size_t j = i + 1; j < drawing.texts.size(); ++j)
      EXPECT_FALSE(a.box().meets(drawing.texts[j].box()))
          << which << ": '" << a.text << "' and '" << drawing.texts[j].text << "'";
    for (const Box& mark : drawing.marks)
      EXPECT_FALSE(a.box().meets(mark)) << which << ": '" << a.text << "' on a marker";
  }
}

TEST(Labels, NoTextOfAChartLiesOnAnotherOrOnAMarker) {
  for (const char* kind : {"work-precision", "error-iterations", "penetration"})
    for (const char* x : {"cpu.per_second", "projections", "iterations"})
      for (const int width : {340, 540, 760})
        for (const int solvers : {1, 2, 5})
          for (const char* title : {"", "Stretch over work, hang"}) {
            FigureSpec spec{.kind = kind, .x = x, .y = "stretch.rms", .along = "iterations"};
            spec.title = title, spec.slope = -1, spec.width = width;
            spec.height = width == 340 ? 330 : 380;
            if (spec.kind == "work-precision") spec.along = "setting";
            const std::vector<Record> records = crowd(solvers);
            expect_no_overlap(find_figure(kind).draw(spec, {records, {}}),
                              std::string(kind) + " over " + x + ", " + std::to_string(width) +
                                  " px, " + std::to_string(solvers) + " solvers");
          }
}

TEST(Labels, WhatNamesACurveIsNeverLeftOutAndSettingsAreWhereThereIsRoom) {
  FigureSpec spec{
      .kind = "work-precision", .x = "projections", .y = "stretch.rms", .along = "setting"};
  spec.width = 540, spec.height = 380;
  const auto records = synthetic::iterations("hang");
  const Drawing drawing = find_figure(spec.kind).draw(spec, {records, {}});
  const auto shown = [&](const std::string& text) {
    return std::ranges::count(drawing.texts, text, &Label::text);
  };
  for (const char* text : {"Jakobsen", "Bullet", "failed", "×"}) EXPECT_EQ(shown(text), 1) << text;
  for (const char* sweeps : {"1", "4", "16", "64", "256"}) EXPECT_GE(shown(sweeps), 1) << sweeps;
}

TEST(Labels, FailuresThatWouldLieOnEachOtherAreCounted) {
  auto records = crowd(1);
  for (std::size_t i = 18; i < records.size(); ++i)
    synthetic::fail(records[i], Status::Kind::exploded, "x");
  FigureSpec spec{
      .kind = "work-precision", .x = "cpu.per_second", .y = "stretch.rms", .along = "setting"};
  const Drawing drawing = find_figure(spec.kind).draw(spec, {records, {}});
  EXPECT_EQ(std::ranges::count(drawing.texts, "6×", &Label::text), 1)
      << "without a cost all stand at the edge";
}

}  // namespace
}  // namespace taut::report
