// Frames, rules and labels around a picture, pixel by pixel.
#include "experiments/render/picture/figure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "experiments/render/image/colour.hpp"
#include "tests/render/render_scenes.hpp"

namespace taut::figure_test {
namespace {

using test::small;

constexpr Rgb8 kPaper = rgb(0xFFFFFF);

/// Number of pixels with the corner's colour from the left, right, top and bottom edge, along the
/// middle.
std::array<int, 4> border_of(const Image& panel) {
  const Rgb8 colour = panel.at(0, 0);
  std::array<int, 4> edges{};
  const int w = panel.width(), h = panel.height();
  while (edges[0] < w && panel.at(edges[0], h / 2) == colour) ++edges[0];
  while (edges[1] < w && panel.at(w - 1 - edges[1], h / 2) == colour) ++edges[1];
  while (edges[2] < h && panel.at(w / 2, edges[2]) == colour) ++edges[2];
  while (edges[3] < h && panel.at(w / 2, h - 1 - edges[3]) == colour) ++edges[3];
  return edges;
}

TEST(MarkOfAStop, IsAFrameOfFivePointsAndOfThreePixelsAtLeast) {
  for (const auto& [unit, edge] : {std::pair{2.0, 10}, {1.0, 5}, {0.4, 3}}) {
    Image panel(700, 500, kPaper);
    mark_stop(panel, {1.25, "exploded"}, unit);
    EXPECT_EQ(border_of(panel), (std::array<int, 4>{edge, edge, edge, edge})) << unit;
    EXPECT_FALSE(panel.at(0, 0) == kPaper);
    EXPECT_EQ(panel.at(edge, edge), kPaper);
    EXPECT_EQ(panel.at(699 - edge, edge), kPaper);
  }
}

/// Covered share of the sheet in pixels, and the centre of the covered part.
struct Ink {
  double area = 0, x = 0, y = 0;
  explicit Ink(const Image& image) {
    for (int y1 = 0; y1 < image.height(); ++y1)
      for (int x1 = 0; x1 < image.width(); ++x1) {
        const double dark = (255 - image.at(x1, y1).g) / 255.0;
        area += dark;
        x += dark * (x1 + 0.5);
        y += dark * (y1 + 0.5);
      }
    x /= area;
    y /= area;
  }
};

TEST(RoundedRectangles, HaveTheirAreaWithoutAnyRadiusToo) {
  for (const double radius : {0.0, 0.3, 4.0}) {
    Image image(40, 30, kPaper);
    Canvas(image).fill_rounded(8, 6, 20, 12, radius, rgb(0));
    const Ink ink(image);
    EXPECT_NEAR(ink.area, 20 * 12 - (4 - std::acos(-1.0)) * radius * radius, 1.0) << radius;
    EXPECT_NEAR(ink.x, 18, 1e-6);
    EXPECT_NEAR(ink.y, 12, 1e-6);
  }
  Image image(40, 30, kPaper);
  Canvas(image).fill_rounded(8, 6, 20, 12, 0, rgb(0));
  EXPECT_EQ(image.at(8, 6), rgb(0)) << "a sharp corner";
  EXPECT_EQ(image.at(27, 17), rgb(0));
  EXPECT_EQ(image.at(7, 6), kPaper);
  EXPECT_EQ(image.at(28, 17), kPaper);
  EXPECT_EQ(image.at(8, 5), kPaper);
  Image between(40, 30, kPaper);
  Canvas(between).fill_rounded(8.3, 6.2, 20.4, 12.6, 0, rgb(0));
  EXPECT_NEAR(Ink(between).area, 20.4 * 12.6, 0.8) << "edges between pixels";
  EXPECT_NEAR(between.at(8, 12).g, 0.3 * 255, 1);
  Image half(40, 30, kPaper);
  Canvas(half).fill_rounded(8, 6, 20, 12, 2, rgb(0), 0.5);
  EXPECT_NEAR(half.at(18, 12).g, 128, 1);
}

TEST(Figure, StrainsHaveThreeDigitsAndASignIfWanted) {
  for (const auto& [value, text] : {std::pair<double, std::string>{0.041, "4.10 %"},
                                    {0.0999, "9.99 %"},
                                    {0.09996, "10.0 %"},
                                    {0.1001, "10.0 %"},
                                    {0.274, "27.4 %"},
                                    {0.9994, "99.9 %"},
                                    {0.9996, "100 %"},
                                    {11.53, "1153 %"},
                                    {0, "0.00 %"}}) {
    EXPECT_EQ(strain_text(value, false), text);
  }
  EXPECT_EQ(strain_text(0.05, true), "+5.00 %");
  EXPECT_EQ(strain_text(-0.05, true), "\u22125.00 %");
  EXPECT_EQ(strain_text(-0.05, false), "5.00 %");
}

TEST(Figure, PanelsStandUpToThreeSideBySideFourInTwoRows) {
  struct Page {
    int width, height, panels, columns, rows;
    double unit;
    int header, footer, panel_width, panel_height;
  };
  for (const Page& page : {Page{1920, 1080, 1, 1, 1, 1, 66, 126, 1920, 888},
                           Page{1920, 1080, 2, 2, 1, 1, 66, 126, 958, 888},
                           Page{1920, 1080, 3, 3, 1, 1, 66, 126, 637, 888},
                           Page{1920, 1080, 4, 2, 2, 1, 66, 126, 958, 409},
                           Page{1920, 1080, 5, 3, 2, 1, 66, 126, 637, 409},
                           Page{1920, 1080, 9, 3, 3, 1, 66, 126, 637, 249},
                           Page{960, 1080, 2, 2, 1, 0.5, 33, 63, 479, 984},
                           Page{960, 1080, 1, 1, 1, 0.8, 53, 101, 960, 926},
                           Page{1920, 540, 1, 1, 1, 0.5, 33, 63, 1920, 444}}) {
    const auto is = PageLayout::page(page.width, page.height, page.panels);
    SCOPED_TRACE(page.panels);
    EXPECT_EQ(is.columns, page.columns);
    EXPECT_EQ(is.rows, page.rows);
    EXPECT_DOUBLE_EQ(is.unit, page.unit);
    EXPECT_EQ(is.header, page.header);
    EXPECT_EQ(is.footer, page.footer);
    EXPECT_EQ(is.panel_width, page.panel_width);
    EXPECT_EQ(is.panel_height, page.panel_height);
  }
}

TEST(Figure, WhatIsWrittenBelowIsInUnitsOfPeople) {
  LiveFigures live;
  live.max_strain = 0.0412;
  live.mean_strain = -0.0072;
  live.max_depth = 0.00152;
  live.max_speed = 2.5;
  using Lines = std::vector<std::string>;
  EXPECT_EQ(caption_of(ColourBy::strain, live),
            (Lines{"max |ε| = 4.12 %", "mean ε = \u22120.72 %"}));
  EXPECT_EQ(caption_of(ColourBy::penetration, live), Lines{"max depth = 1.52 mm"});
  EXPECT_EQ(caption_of(ColourBy::speed, live), Lines{"max |v| = 2.5 m/s"});
}

/// Whether a picture contains a panel with its upper left corner at this place; compares the
/// panel's middle, where no text is.
bool holds(const Image& picture, const Image& panel, int left, int top) {
  for (int y = panel.height() * 2 / 5; y < panel.height() * 9 / 10; ++y)
    for (int x = panel.width() / 20; x < panel.width() * 7 / 10; ++x)
      if (picture.at(left + x, top + y) != panel.at(x, y)) return false;
  return true;
}

TEST(Figure, EveryRunStandsInItsPanel) {
  const Scene scene = test::level_sheet(5);
  std::vector<RecordedRun> runs;
  for (const auto& [strain, colour] :
       {std::pair{-0.03, 0x0B6BCBu}, {0.0, 0xC8470Cu}, {0.02, 0x8250C4u}, {0.04, 0x0F7B5Du}}) {
    runs.push_back(test::stretched(scene, strain));
    runs.back().colour = rgb(colour);
  }
  for (const std::size_t count : {4u, 3u, 1u}) {
    runs.resize(count);
    const auto layout = PageLayout::page(640, 480, static_cast<int>(count));
    SceneRendererOptions options = small();
    options.width = layout.panel_width;
    options.height = layout.panel_height;
    options.view = parse_view("top");
    options.range = 0.05;
    const SceneRenderer renderer(scene, runs, options);
    const Image page = compose(renderer, layout, {0.5});
    EXPECT_EQ(std::pair(page.width(), page.height()), std::pair(640, 480));
    for (std::size_t k = 0; k < count; ++k) {
      const int column = count == 4 ? static_cast<int>(k % 2) : static_cast<int>(k),
                row = count == 4 ? static_cast<int>(k / 2) : 0,
                left = column * (layout.panel_width + layout.gap),
                top = row * (layout.header + layout.panel_height + layout.gap);
      EXPECT_TRUE(holds(page, renderer.panel(k, 0.5), left, top + layout.header)) << k;
      EXPECT_EQ(page.at(left + static_cast<int>(45 * layout.unit),
                        top + static_cast<int>(0.62 * layout.header - 9 * layout.unit)),
                runs[k].colour)
          << k;
    }
  }
}

TEST(Figure, ASheetHasAColumnForEachRun) {
  const Scene scene = test::sheet_over_ball(9);
  const std::vector<RecordedRun> runs{test::draped(scene, 5), test::stretched(scene, 0.02)};
  SceneRendererOptions options = small();
  options.width = 200;
  options.height = 160;
  const SceneRenderer renderer(scene, runs, options);
  const std::vector<double> times{0.25, 0.5, 1};
  const auto layout = PageLayout::sheet(200, 160, 2, 3);
  const Image page = compose(renderer, layout, times);
  const int head = layout.header, foot = layout.footer;
  EXPECT_EQ(std::pair(head, foot), std::pair(21, 39)) << "66 and 126 at a panel of 514";
  EXPECT_EQ(std::pair(page.width(), page.height()), std::pair(2 * 206 - 6, head + 3 * 166 + foot));
  for (int column = 0; column < 2; ++column) {
    const auto run = static_cast<std::size_t>(column);
    for (int row = 0; row < 3; ++row)
      EXPECT_TRUE(holds(page, renderer.panel(run, times[static_cast<std::size_t>(row)]),
                        column * 206, head + row * 166))
          << column << ' ' << row;
    EXPECT_EQ(page.at(column * 206 + static_cast<int>(45 * layout.unit),
                      static_cast<int>(0.62 * head - 9 * layout.unit)),
              runs[run].colour);
  }
}

TEST(Figure, TheSheetLaidFlatHidesNoCloth) {
  const Scene scene = test::level_sheet(9);
  const std::vector<RecordedRun> runs{test::stretched(scene, 0), test::stretched(scene, 0.01)};
  const auto layout = PageLayout::bare(400, 160, 2);
  for (const bool hides : {false, true}) {
    SceneRendererOptions options = small();
    options.width = layout.panel_width;
    options.height = layout.panel_height;
    options.view = parse_view("top");
    const double edge = hides ? 1 : 0.4;
    options.frame = {.left = -edge, .right = edge, .bottom = -edge, .top = edge};
    const Image picture = compose(SceneRenderer(scene, runs, options), layout, {0.5});
    // a fifth of the height wide, a 28th from the edges; counts its rim
    for (const int panel : {0, 1})
      EXPECT_EQ(picture.at(panel * 200 + 196, 20) == rgb(0x4A5361), !hides) << panel;
  }
}

TEST(ColourBar, TicksStandAtTheirPlaces) {
  for (const ColourBy by : {ColourBy::strain, ColourBy::speed}) {
    Image image(400, 90, rgb(0xFFFFFF));
    Canvas canvas(image);
    const ColourScale scale{by, 0.04};
    draw_colour_bar(canvas, scale, {50, 10, 300, 20}, 1);
    for (int x = 50; x < 350; ++x)
      EXPECT_EQ(image.at(x, 20), scale.map().at((x - 50) / 299.0)) << x;
    std::set<int> ticks, expected;
    for (int x = 40; x < 360; ++x)
      if (image.at(x, 34) != rgb(0xFFFFFF)) ticks.insert(x);
    for (const double value : scale.ticks()) {
      const double at = 50 + (value - scale.low()) / (scale.high - scale.low()) * 300;
      // covers half of each of the two pixels beside it
      const int middle = static_cast<int>(std::round(at));
      expected.insert({middle - 1, middle});
    }
    EXPECT_EQ(ticks, expected);
    EXPECT_EQ(image.at(354, 20), scale.colour(1)) << "beyond its high end";
    EXPECT_EQ(image.at(372, 20), rgb(0xFFFFFF));
    EXPECT_EQ(image.at(45, 20), by == ColourBy::strain ? scale.colour(-1) : rgb(0xFFFFFF));
  }
}

}  // namespace
}  // namespace taut::figure_test
