// Pictures: faithful colours, reproducible bytes, golden images.
#include <gtest/gtest.h>
#include <png.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "core/model/input_error.hpp"
#include "tests/render/render_scenes.hpp"

namespace taut::render_test {
namespace {

using test::difference;
using test::small;
namespace fs = std::filesystem;

Image read_png(const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto fail = [&] { throw InputError({{path.string(), 0, 0, png.message}}); };
  if (!png_image_begin_read_from_file(&png, path.c_str())) fail();
  png.format = PNG_FORMAT_RGB;
  std::vector<Rgb8> pixels(std::size_t{png.width} * png.height);
  if (!png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr)) fail();
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  std::memcpy(&image.at(0, 0), pixels.data(), pixels.size() * sizeof(Rgb8));
  return image;
}

TEST(ColourMap, IsNeutralAtZeroAndEquallyDarkAtBothEnds) {
  const ColourMap& map = ColourMap::diverging();
  const auto luminance = [](Rgb8 c) {
    return 0.2126 * linear_of(c.r) + 0.7152 * linear_of(c.g) + 0.0722 * linear_of(c.b);
  };
  const Rgb8 zero = map.at(0.5);
  EXPECT_LE(std::max({zero.r, zero.g, zero.b}) - std::min({zero.r, zero.g, zero.b}), 3);
  for (const double s : {0.0, 0.1, 0.25, 0.4})
    EXPECT_NEAR(std::cbrt(luminance(map.at(s))), std::cbrt(luminance(map.at(1 - s))), 0.06) << s;
  // lightness rises towards the middle without turning back
  for (int i = 1; i < ColourMap::kSize / 2; ++i)
    EXPECT_GE(luminance(map.table()[static_cast<std::size_t>(i)]) + 2e-3,
              luminance(map.table()[static_cast<std::size_t>(i - 1)]));
}

TEST(ColourScale, TicksHoldBothEndsAndZero) {
  for (const double high : {0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.5, 5.0}) {
    const ColourScale scale{ColourBy::strain, high};
    const std::vector<double> ticks = scale.ticks();
    EXPECT_DOUBLE_EQ(ticks.front(), -high);
    EXPECT_DOUBLE_EQ(ticks.back(), high);
    EXPECT_EQ(std::ranges::count(ticks, 0.0), 1) << high;
    EXPECT_LE(ticks.size(), 7u);
  }
  EXPECT_EQ((ColourScale{ColourBy::strain, 0.05}).text(-0.025), "\u22122.5 %");
  EXPECT_EQ((ColourScale{ColourBy::penetration, 0.01}).text(0.0015), "1.5 mm");
}

TEST(ColourScale, RoundsUpToRoundNumbers) {
  EXPECT_DOUBLE_EQ(round_up(0.0117, 1e-3), 0.015);
  EXPECT_DOUBLE_EQ(round_up(0.015, 1e-3), 0.015);
  EXPECT_DOUBLE_EQ(round_up(9.1, 1e-3), 10);
  EXPECT_DOUBLE_EQ(round_up(0, 1e-3), 1e-3);
}

TEST(ColourBar, EndsAreTheEndsOfTheMap) {
  Image image(400, 80, rgb(0xFFFFFF));
  Canvas canvas(image);
  const ColourScale scale{ColourBy::strain, 0.05};
  draw_colour_bar(canvas, scale, {50, 10, 300, 20}, 1);
  EXPECT_EQ(image.at(50, 20), scale.colour(-0.05));
  EXPECT_EQ(image.at(349, 20), scale.colour(0.05));
  EXPECT_EQ(image.at(349, 20), scale.colour(7.0));  // the colour of the scale's end
}

/// Share of the panel's pixels that have this colour within two levels.
double share_of(const Image& panel, Rgb8 colour) {
  std::size_t same = 0;
  for (const Rgb8 p : panel.pixels())
    same += std::abs(p.r - colour.r) <= 2 && std::abs(p.g - colour.g) <= 2 &&
            std::abs(p.b - colour.b) <= 2;
  return static_cast<double>(same) / static_cast<double>(panel.pixels().size());
}

// Uncovered cloth that faces the sky has the colour of the bar, independently of light and shader.
TEST(SceneRenderer, OpenClothHasTheBarsColour) {
  const Scene scene = test::level_sheet(9);
  for (const double strain : {-0.05, 0.0, 0.05, 0.4}) {
    const std::vector<RecordedRun> runs{test::stretched(scene, strain)};
    SceneRendererOptions options = small();
    options.view = parse_view("top");
    options.range = 0.05;
    const SceneRenderer renderer(scene, runs, options);
    EXPECT_GT(share_of(renderer.panel(0, 0.5), renderer.scale().colour(strain)), 0.15) << strain;
  }
}

TEST(SceneRenderer, MaterialSpaceIsExact) {
  const Scene scene = test::level_sheet(5);
  const std::vector<RecordedRun> runs{test::stretched(scene, 0.02)};
  SceneRendererOptions options = small();
  options.range = 0.05;
  const SceneRenderer renderer(scene, runs, options);
  const Image flat = renderer.material_space(0, 0.5, 40);
  ASSERT_EQ(flat.pixels().size(), 40u * 40u);
  for (const Rgb8 pixel : flat.pixels()) EXPECT_EQ(pixel, renderer.scale().colour(0.02));
}

TEST(SceneRenderer, SameInputSameBytesFromEitherThread) {
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 7)};
  const auto draw = [&] { return SceneRenderer(scene, runs, small()).panel(0, 1); };
  const Image first = draw();
  Image other;
  std::thread([&] { other = draw(); }).join();
  EXPECT_EQ(first.pixels(), other.pixels());
}

/// Mesa's own threads free what the caller walks over (gl.cpp).
TEST(SceneRenderer, DrawsWithoutThreadsOfMesasRasteriser) {
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 7)};
  const SceneRenderer renderer(scene, runs, small());
  renderer.panel(0, 1);
  for (const auto& task : fs::directory_iterator("/proc/self/task")) {
    std::string name;
    std::ifstream(task.path() / "comm") >> name;
    EXPECT_FALSE(name.starts_with("llvmpipe")) << name;
  }
}

TEST(SceneRenderer, MovingTheClothMovesThePicture) {
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 7)};
  const SceneRenderer renderer(scene, runs, small());
  EXPECT_GT(difference(renderer.panel(0, 0), renderer.panel(0, 1)).mean, 2);
}

/// Run of the sheet at rest with prescribed speeds [m/s], by vertex and time.
RecordedRun with_speeds(const Scene& scene,
                        const std::function<double(std::size_t, double)>& speed) {
  Trajectory trajectory = test::empty_trajectory(scene);
  for (int k = 0; k <= scene.steps; ++k) {
    State state = scene.start;
    for (std::size_t i = 0; i < state.v.size(); ++i)
      state.v[i] = Vec3(0, 0, speed(i, k * scene.dt));
    trajectory.frames.push_back({k * scene.dt, state});
  }
  return recorded_run(scene, trajectory);
}

TEST(SceneRenderer, TheBarEndsWhere98Of100ValuesLie) {
  const Scene scene = test::level_sheet(10);
  const auto high = [&](const std::function<double(std::size_t, double)>& speed, double from = 0,
                        double to = 1e9) {
    const std::vector<RecordedRun> runs{with_speeds(scene, speed)};
    SceneRendererOptions options = small(ColourBy::speed);
    options.from = from;
    options.to = to;
    return SceneRenderer(scene, runs, options).scale().high;
  };
  const auto first = [](std::size_t n, double then) {  // n of 100 vertices move at 1 m/s
    return [=](std::size_t i, double) { return i < n ? 1 : i == n ? then : 50.0; };
  };
  EXPECT_EQ(high(first(97, 3)), 3) << "the 98th";
  EXPECT_EQ(high(first(98, 3)), 1);
  EXPECT_EQ(high(first(100, 3)), 1);
  // 25 moments from the first to the last, none before or after.
  const auto at = [](bool (*fast)(double)) {
    return [=](std::size_t, double t) { return fast(t) ? 5.0 : 2.0; };
  };
  EXPECT_EQ(high(at([](double t) { return t < 0.25 || t > 0.75; }), 0.25, 0.75), 2);
  EXPECT_EQ(high(at([](double t) { return t <= 0.25; }), 0.25, 0.75), 5);
  EXPECT_EQ(high(at([](double t) { return t >= 0.75; }), 0.25, 0.75), 5);
  EXPECT_EQ(high(at([](double t) { return t == 0.5; }), 0.5, 0.5), 5) << "one moment alone";
  EXPECT_EQ(high(at([](double t) { return t >= 1; })), 5) << "to the scene's end";
  // A bar exists even if all values are zero.
  const std::vector<RecordedRun> still{with_speeds(scene, [](std::size_t, double) { return 0; })};
  const auto least = [&](ColourBy by) {
    return SceneRenderer(scene, still, small(by)).scale().high;
  };
  EXPECT_DOUBLE_EQ(least(ColourBy::speed), 0.1);
  EXPECT_DOUBLE_EQ(least(ColourBy::strain), 1e-3);
  EXPECT_DOUBLE_EQ(least(ColourBy::penetration), round_up(1e-3 * extent(scene), 1e-9));
}

TEST(SceneRenderer, MaterialSpaceIsLinearBetweenTheVertices) {
  Scene scene = test::level_sheet(3);
  const auto flat_of = [&](int nu, int nv, double width, double height) {
    scene.mesh = make_sheet({.nu = nu, .nv = nv, .width = width, .height = height, .mass = 1});
    scene.links = grid_links(scene.mesh, {});
    scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
    const std::vector<RecordedRun> runs{with_speeds(scene, [=](std::size_t i, double) {
      const auto n = static_cast<std::size_t>(nu);
      return static_cast<double>(i % n) + 0.75 * static_cast<double>(i / n);
    })};
    SceneRendererOptions options = small(ColourBy::speed);
    options.range = 8;
    const SceneRenderer renderer(scene, runs, options);
    const Image flat = renderer.material_space(0, 0.5, 60);
    for (int y = 0; y < flat.height(); ++y)
      for (int x = 0; x < flat.width(); ++x) {
        const double u = (x + 0.5) / flat.width() * (nu - 1),
                     v = (y + 0.5) / flat.height() * (nv - 1);
        const Rgb8 is = flat.at(x, y), should = renderer.scale().colour(u + 0.75 * v);
        EXPECT_LE(std::max({std::abs(is.r - should.r), std::abs(is.g - should.g),
                            std::abs(is.b - should.b)}),
                  2)
            << x << ' ' << y;
      }
    return std::pair(flat.width(), flat.height());
  };
  EXPECT_EQ(flat_of(5, 3, 2, 1), std::pair(60, 30));
  EXPECT_EQ(flat_of(3, 6, 0.5, 2), std::pair(15, 60));
  EXPECT_EQ(flat_of(2, 5, 0.05, 2), std::pair(6, 60)) << "a ninth at least";
  scene.mesh.grid.reset();
  const std::vector<RecordedRun> runs{with_speeds(scene, [](std::size_t, double) { return 1; })};
  EXPECT_EQ(SceneRenderer(scene, runs, small()).material_space(0, 0, 60).width(), 0);
}

SceneRendererOptions from_above() {
  SceneRendererOptions options = small();
  options.view = parse_view("top");
  options.range = 0.05;
  return options;
}

/// Colour of the panel at this vertex.
Rgb8 seen_at(const SceneRenderer& renderer, const Image& panel, std::size_t vertex, double t) {
  const auto p = renderer.projected(0, t).at(vertex);
  return panel.at(static_cast<int>((p.x() + 1) / 2 * static_cast<float>(panel.width())),
                  static_cast<int>((1 - p.y()) / 2 * static_cast<float>(panel.height())));
}

TEST(SceneRenderer, PinsAreDarkBallsOnTheirVerticesAndNowhereElse) {
  Scene scene = test::level_sheet(9);
  const auto dark = [&](const std::vector<int>& pins) {
    scene.pins = pins;
    const std::vector<RecordedRun> runs{test::stretched(scene, 0)};
    const SceneRenderer renderer(scene, runs, from_above());
    const Image panel = renderer.panel(0, 0.5);
    std::vector<int> found;
    for (const int i : {20, 22, 40, 58, 60})
      if (seen_at(renderer, panel, static_cast<std::size_t>(i), 0.5).g < 150) found.push_back(i);
    return found;
  };
  EXPECT_EQ(dark({}), std::vector<int>{});
  EXPECT_EQ(dark({20}), std::vector<int>{20});
  EXPECT_EQ(dark({22, 40, 58}), (std::vector<int>{22, 40, 58}));
}

TEST(SceneRenderer, TheCameraFollowsClothThatNothingHolds) {
  const Scene scene = test::level_sheet(9);
  RecordedRun falls = test::stretched(scene, 0);
  for (auto& frame : falls.trajectory.frames)
    for (Vec3& x : frame.state.x) x += frame.t * Vec3(3, -50 * frame.t, 7);
  const std::vector<RecordedRun> runs{falls};
  SceneRendererOptions options = small();
  options.range = 0.05;
  const SceneRenderer renderer(scene, runs, options);
  const auto before = renderer.projected(0, 0), after = renderer.projected(0, 1);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_LT((before[i] - after[i]).norm(), 2e-3) << i;
  EXPECT_TRUE(renderer.in_sight(0, 1));
  const Rgb8 start = seen_at(renderer, renderer.panel(0, 0), 40, 0),
             end = seen_at(renderer, renderer.panel(0, 1), 40, 1);
  EXPECT_NEAR(start.g, end.g, 12);
  EXPECT_GT(end.g, 150) << "cloth";
}

// Cloth that fell through a thin plate is reported, or it would look as if it had never existed.
TEST(SceneRenderer, ClothThatLeavesThePictureIsMissedAndSaidSo) {
  Scene scene = test::sheet_over_ball(9);
  RecordedRun gone = test::draped(scene, 7);
  for (auto& frame : gone.trajectory.frames)
    if (frame.t > 0.5)
      for (Vec3& x : frame.state.x) x.y() -= 20;
  const std::vector<RecordedRun> runs{test::draped(scene, 7), gone};
  const auto layout = PageLayout::page(640, 360, 2);
  SceneRendererOptions options = small();
  options.width = layout.panel_width;
  options.height = layout.panel_height;
  const SceneRenderer renderer(scene, runs, options);
  EXPECT_TRUE(renderer.in_sight(0, 1));
  EXPECT_TRUE(renderer.in_sight(1, 0.25));
  EXPECT_FALSE(renderer.in_sight(1, 1));
  // Without the sheet both halves show the same ball; one of them has the label.
  Image empty = renderer.panel(1, 1), marked = empty;
  mark_absence(marked, renderer, 1, 1, layout.unit);
  EXPECT_GT(difference(empty, marked).largest, 100);
  const Image page = compose(renderer, layout, {1});
  const auto [left, top] = layout.corner(1, 0);
  const int x = static_cast<int>(24 * layout.unit) + 8,
            y = layout.panel_height - static_cast<int>(40 * layout.unit);
  EXPECT_EQ(page.at(left + x, top + y), marked.at(x, y));
}

TEST(SceneRenderer, VerticesAreProjectedToWhereTheyAreDrawn) {
  const Scene scene = test::level_sheet(9);
  const std::vector<RecordedRun> runs{test::stretched(scene, 0)};
  const SceneRenderer renderer(scene, runs, from_above());
  const Image panel = renderer.panel(0, 0.5);
  const auto points = renderer.projected(0, 0.5);
  ASSERT_EQ(points.size(), scene.mesh.rest.size());
  const auto middle = points[points.size() / 2];
  const Rgb8 there = panel.at(static_cast<int>((middle.x() + 1) / 2 * 240),
                              static_cast<int>((1 - middle.y()) / 2 * 180) + 3);
  EXPECT_GT(there.g, 120) << "cloth, not the floor around it";
  for (const auto& p : points) EXPECT_LT(std::max(std::abs(p.x()), std::abs(p.y())), 1);
}

// A thread that is a thousandth of a pixel wide contains no sample of any pixel.
TEST(SceneRenderer, AThreadOfClothIsSeenFromEndToEnd) {
  const Scene scene = test::level_sheet(9);
  RecordedRun thread = test::stretched(scene, 0);
  for (auto& frame : thread.trajectory.frames)
    for (Vec3& x : frame.state.x) x = Vec3(3 * x.x(), 0, 1e-5 * x.z());
  const std::vector<RecordedRun> runs{thread};
  SceneRendererOptions options = small();
  options.view = parse_view("front");
  options.range = 0.05;
  const SceneRenderer renderer(scene, runs, options);
  const Image panel = renderer.panel(0, 0.5);
  const auto ends =
      std::ranges::minmax(renderer.projected(0, 0.5), {}, [](const auto& p) { return p.x(); });
  const auto column = [](float x) { return static_cast<int>((x + 1) / 2 * 240); };
  int seen = 0;
  for (int x = column(ends.min.x()); x < column(ends.max.x()); ++x)
    for (int y = 0; y < 180; ++y)
      if (panel.at(x, y).r > panel.at(x, y).g + 20) {
        ++seen;
        break;
      }
  EXPECT_GT(column(ends.max.x()) - column(ends.min.x()), 150);
  EXPECT_GE(seen, column(ends.max.x()) - column(ends.min.x()) - 2);
}

// A ball that comes from far away is shown near the cloth; the cloth is not a speck on the ball's
// path.
TEST(Placing, FramesTheClothAndNotTheWholeWayOfACollider) {
  Scene scene = test::level_sheet(9);
  scene.colliders.push_back({Ball{Vec3(-10, 0, 0), 0.3}, {.velocity = Vec3(20, 0, 0)}, 0});
  const std::vector<RecordedRun> runs{test::stretched(scene, 0)};
  std::vector<double> times;
  for (int k = 0; k <= 24; ++k) times.push_back(k / 24.0);
  const Placing passing = place(scene, runs, times, View{}, FitRegion{}, 4.0 / 3, 0);
  EXPECT_LT(passing.radius, 1.5);
  EXPECT_GT(passing.radius, 0.8) << "the ball is seen while it passes";
}

TEST(Figure, WhatIsWrittenBelowIsTheQuantityThatIsShown) {
  const LiveFigures live{
      .max_strain = 0.041, .mean_strain = -0.002, .max_depth = 0.0015, .max_speed = 0.8};
  EXPECT_EQ(caption_of(ColourBy::penetration, live),
            std::vector<std::string>{"max depth = 1.5 mm"});
  EXPECT_EQ(caption_of(ColourBy::speed, live), std::vector<std::string>{"max |v| = 0.8 m/s"});
  EXPECT_EQ(caption_of(ColourBy::strain, live),
            (std::vector<std::string>{"max |ε| = 4.10 %", "mean ε = \u22120.20 %"}));
}

// Cloth that sank into a ball is drawn on its surface and marked by a hatch alone.
TEST(SceneRenderer, SunkenClothStaysVisible) {
  const Scene scene = test::sheet_over_ball(17);
  RecordedRun sunken = test::draped(scene, 7);
  for (auto& frame : sunken.trajectory.frames)
    for (Vec3& x : frame.state.x)
      if (x.y() > -0.31 && (x - Vec3(0, -0.31, 0)).norm() < 0.32)
        x = Vec3(0, -0.31, 0) + (x - Vec3(0, -0.31, 0)) * (0.29 / 0.305);
  const std::vector<RecordedRun> runs{test::draped(scene, 7), sunken};
  SceneRendererOptions options = small();
  options.range = 100;  // so wide that strain does not change the colour
  const SceneRenderer renderer(scene, runs, options);
  const Image stable = renderer.panel(0, 1), sank = renderer.panel(1, 1);
  EXPECT_LT(difference(stable, sank).mean, 4);
  EXPECT_GT(difference(stable, sank).largest, 20);  // the hatch
}

TEST(View, NamesAndAngles) {
  EXPECT_DOUBLE_EQ(parse_view("top").elevation, 89);
  EXPECT_DOUBLE_EQ(parse_view("-30,45").azimuth, -30);
  EXPECT_THROW(parse_view("frnt"), InputError);
  EXPECT_THROW(parse_view("0,90"), InputError);
  EXPECT_THROW(parse_colour_by("stress"), InputError);
}

TEST(Camera, TheInsetHidesNoneOfThePoints) {
  const FitRegion frame = FitRegion::beside_inset();
  for (const double aspect : {0.6, 1.15, 2.0})
    for (const Vec3& half : {Vec3(1, 0.3, 1), Vec3(0.3, 1, 0.3), Vec3(1, 1, 0.1)}) {
      std::vector<Vec3> corners;
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
          for (const double z : {-1.0, 1.0}) corners.push_back(half.cwiseProduct(Vec3(x, y, z)));
      const Camera camera = fit_camera(corners, Vec3::UnitY(), View{}, aspect, frame);
      const Eigen::Matrix4f clip = camera.world_to_clip(static_cast<float>(aspect));
      for (const Vec3& p : corners) {
        const Eigen::Vector4d seen = (clip * p.cast<float>().homogeneous()).cast<double>();
        const double x = seen.x() / seen.w(), y = seen.y() / seen.w();
        EXPECT_LT(std::max(std::abs(x), std::abs(y)), 0.9) << aspect << ": " << half.transpose();
        EXPECT_FALSE(x > frame.inset_left + 1e-5 && y > frame.inset_bottom + 1e-5)
            << aspect << ": " << half.transpose();
      }
    }
}

TEST(RecordedRun, EndsBeforeTheFirstUnsoundFrameAndSaysSo) {
  const Scene scene = test::level_sheet(5);
  Trajectory trajectory = test::stretched(scene, 0).trajectory;
  trajectory.frames[20].state.x[3][1] = std::nan("");
  const RecordedRun run = recorded_run(scene, trajectory);
  EXPECT_EQ(run.trajectory.frames.size(), 20u);
  ASSERT_TRUE(run.stop.has_value());
  EXPECT_EQ(run.stop->why, "exploded");
  EXPECT_DOUBLE_EQ(run.at(0.9).t, 19 * scene.dt);
  trajectory.frames[0].state.x[0] = Vec3::Constant(1e30);
  EXPECT_THROW(recorded_run(scene, trajectory), InputError);
}

TEST(SceneRenderer, ARunThatBlewUpLeavesTheOthersTheirColours) {
  const Scene scene = test::level_sheet(5);
  std::vector<RecordedRun> runs{test::stretched(scene, 0.06), test::stretched(scene, 40)};
  runs[1].stop = RecordedRun::Stop{0.5, "exploded"};
  EXPECT_DOUBLE_EQ(SceneRenderer(scene, runs, small()).scale().high, 0.06);
  runs.erase(runs.begin());
  EXPECT_DOUBLE_EQ(SceneRenderer(scene, runs, small()).scale().high, 1)
      << "none is stable: 100 % at most";
}

TEST(RecordedRun, AnExplodedPanelIsMarked) {
  const Scene scene = test::level_sheet(5);
  RecordedRun run = test::stretched(scene, 0);
  run.trajectory.frames.resize(30);
  run = recorded_run(scene, run.trajectory);
  run.title = "Analytic";
  run.stop->why = "exploded";
  const std::vector<RecordedRun> runs{run};
  const auto layout = PageLayout::page(480, 360, 1);
  SceneRendererOptions options = small();
  options.width = layout.panel_width;
  options.height = layout.panel_height;
  const SceneRenderer renderer(scene, runs, options);
  const Image before = compose(renderer, layout, {0.2}), after = compose(renderer, layout, {0.9});
  const Rgb8 alarm = rgb(0xB3261E);
  EXPECT_EQ(share_of(before, alarm), 0);
  EXPECT_GT(share_of(after, alarm), 0.01);
}

/// Compares with tests/render/golden/NAME.png; TAUT_UPDATE_GOLDEN=1 writes it anew. Another Mesa,
/// font hinting or CPU may change single pixels, so that the mean over the picture is compared.
void expect_golden(const std::string& name, const Image& picture) {
  const fs::path golden = fs::path(TAUT_SOURCE_DIR) / "tests/render/golden" / (name + ".png");
  if (std::getenv("TAUT_UPDATE_GOLDEN")) write_png(golden, picture);
  const test::Difference d = difference(picture, read_png(golden));
  EXPECT_LT(d.mean, 0.8) << name << ": largest " << d.largest;
  if (d.mean >= 0.8) write_png(fs::path(TAUT_BINARY_DIR) / (name + "-now.png"), picture);
}

TEST(Golden, FigureOfTwoRuns) {
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 5), test::draped(scene, 8)};
  const auto layout = PageLayout::page(640, 360, 2);
  SceneRendererOptions options = small();
  options.width = layout.panel_width;
  options.height = layout.panel_height;
  const SceneRenderer renderer(scene, runs, options);
  expect_golden("figure", compose(renderer, layout, {1}));
}

TEST(Golden, SheetOfSpeedsInTheDarkTheme) {
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 5)};
  SceneRendererOptions options = small(ColourBy::speed);
  options.theme = Theme::dark();
  const SceneRenderer renderer(scene, runs, options);
  const auto layout = PageLayout::sheet(options.width, options.height, 1, 3);
  expect_golden("sheet", compose(renderer, layout, {0, 0.5, 1}));
}

}  // namespace
}  // namespace taut::render_test
