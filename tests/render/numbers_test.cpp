// Numbers in pictures: areas of shapes, projection of points, lightness of colours, values at
// vertices.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/model/index.hpp"
#include "experiments/render/picture/scene_renderer.hpp"
#include "tests/render/render_scenes.hpp"

namespace taut::numbers_test {
namespace {

/// Amount of ink on a white page, in pixels, and its centre.
struct Ink {
  double area = 0, x = 0, y = 0;
};

template <class Draw>
Ink ink(const Draw& draw) {
  Image image(60, 50, rgb(0xFFFFFF));
  Canvas canvas(image);
  draw(canvas);
  Ink all;
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x) {
      const double share = 1 - image.at(x, y).g / 255.0;
      all.area += share;
      all.x += share * (x + 0.5);
      all.y += share * (y + 0.5);
    }
  all.x /= all.area;
  all.y /= all.area;
  return all;
}

void expect_ink(const Ink& is, double area, double x, double y, double tolerance) {
  EXPECT_NEAR(is.area, area, tolerance * area);
  EXPECT_NEAR(is.x, x, 0.03);
  EXPECT_NEAR(is.y, y, 0.03);
}

TEST(CanvasInk, OfAShapeIsItsAreaAndLiesAtItsCentre) {
  const Rgb8 black = rgb(0);
  for (const double shift : {0.0, 0.25, 0.5, 0.8}) {
    const double x = 10 + shift, y = 20 - shift;
    expect_ink(ink([&](Canvas& c) { c.fill(x, y, 17.3, 11.6, black); }), 17.3 * 11.6, x + 8.65,
               y + 5.8, 0.003);
    EXPECT_NEAR(ink([&](Canvas& c) { c.fill(x, y, 0.4, 11.6, black); }).area, 0.4 * 11.6, 0.1)
        << "narrower than a pixel";
    expect_ink(ink([&](Canvas& c) {
                 c.disc({x + 9, y + 4}, 7.3, black);
               }),
               std::numbers::pi * 7.3 * 7.3, x + 9, y + 4, 0.003);
    // whole pixels: each rounded corner lacks (1 - pi/4) r^2 of its square
    expect_ink(ink([&](Canvas& c) { c.fill_rounded(10, 12, 24, 18, 6, black); }),
               24 * 18 - (4 - std::numbers::pi) * 36, 22, 21, 0.003);
    for (const bool turned : {false, true}) {
      const Point a{x, y}, b{x + 25, y + 3}, d{x + 8, y + 22};
      expect_ink(ink([&](Canvas& c) {
                   c.triangle(turned ? std::array{a, d, b} : std::array{a, b, d}, black);
                 }),
                 (25 * 22 - 8 * 3) / 2.0, x + 11, y + 25 / 3.0, 0.01);
    }
  }
  expect_ink(ink([&](Canvas& c) { c.fill_rounded(10, 12, 24, 18, 6, black, 0.4); }),
             0.4 * (24 * 18 - (4 - std::numbers::pi) * 36), 22, 21, 0.005);
  const auto two_corners = [&](Canvas& c) {
    c.fill(-5, -5, 15, 10, black);
    c.fill(55, 45, 50, 50, black);
  };
  EXPECT_NEAR(ink(two_corners).area, 10 * 5 + 5 * 5, 0.1) << "what is beyond the page is left out";
}

TEST(CanvasInk, OfTextLiesWhereItIsAligned) {
  const auto drawn = [](Align align, double x) {
    return ink([&](Canvas& c) {
      c.text({x, 30}, "nHn", {.size = 15, .colour = rgb(0), .align = align});
    });
  };
  const double width = text_width("nHn", 15);
  EXPECT_NEAR(text_width("nHn", 30), 2 * width, 1e-3);
  EXPECT_NEAR(text_width("nn", 15) + text_width("HH", 15) / 2, width, 0.5) << "but for kerning";
  EXPECT_GT(text_width("nHn", 15, Weight::bold), width);
  const Ink centre = drawn(Align::centre, 30);
  EXPECT_NEAR(centre.x, 30, 0.3);
  EXPECT_NEAR(drawn(Align::left, 30 - width / 2).x, centre.x, 0.3);
  EXPECT_NEAR(drawn(Align::right, 30 + width / 2).x, centre.x, 0.3);
  EXPECT_LT(centre.y, 30) << "it stands on its baseline";
  EXPECT_GT(centre.y, 30 - 15);
  EXPECT_EQ(text_width("\u03b5", 15), text_width("\u03b5", 15));
  EXPECT_NE(text_width("\u03b5", 15), text_width("\xce", 15))
      << "letters of two bytes are one letter";
  EXPECT_NEAR(text_width("\u03b5\u2212\u00b2", 15),
              text_width("\u03b5", 15) + text_width("\u2212", 15) + text_width("\u00b2", 15), 0.5);
  EXPECT_NEAR(text_width("\xff\xff", 15), 2 * text_width("\ufffd", 15), 1e-3);
}

TEST(ImageParts, ShrinkToTheirMeansAndAreCutAtTheEdges) {
  Image image(12, 6);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 12; ++x)
      image.at(x, y) = {static_cast<std::uint8_t>((x * 83 + y * 19) % 256),
                        static_cast<std::uint8_t>((x * 29 + y * 157) % 256),
                        static_cast<std::uint8_t>((x * x * 7 + y) % 256)};
  const Image small = shrunk(image, 3);
  ASSERT_EQ(small.width(), 4);
  ASSERT_EQ(small.height(), 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (const auto channel : {&Rgb8::r, &Rgb8::g, &Rgb8::b}) {
        double sum = 0;
        for (int k = 0; k < 9; ++k) sum += image.at(3 * x + k % 3, 3 * y + k / 3).*channel;
        EXPECT_LE(std::abs(small.at(x, y).*channel - sum / 9), 0.5);
      }
  EXPECT_EQ(shrunk(image, 1).pixels(), image.pixels());
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-5, -2}, {7, 4}}) {
    Image page(9, 5, rgb(0x102030));
    page.paste(image, dx, dy);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 9; ++x) {
        const bool covered = x >= dx && y >= dy && x < dx + 12 && y < dy + 6;
        EXPECT_EQ(page.at(x, y), covered ? image.at(x - dx, y - dy) : rgb(0x102030))
            << x << ' ' << y;
      }
  }
}

/// Lightness, chroma and hue [degrees] of an sRGB colour in OKLab (Ottosson 2020).
struct Seen {
  double lightness, chroma, hue;
};
Seen seen(Rgb8 c) {
  const double r = linear_of(c.r), g = linear_of(c.g), b = linear_of(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b),
               m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b),
               s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  const double x = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
               y = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
  const double hue = std::atan2(y, x) * 180 / std::numbers::pi;
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, std::hypot(x, y),
          hue < 0 ? hue + 360 : hue};
}

TEST(ColourMap, WhatIsNoNumberLooksAsBadAsTheLargest) {
  for (const double no_number : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_EQ(ColourMap::violet().at(no_number), ColourMap::violet().at(1)) << no_number;
  EXPECT_EQ(ColourMap::violet().at(7), ColourMap::violet().at(1));
  EXPECT_EQ(ColourMap::violet().at(-7), ColourMap::violet().at(0));
}

TEST(ColourMap, LightnessIsLinearInTheValue) {
  EXPECT_EQ(linear_of(0), 0);
  EXPECT_EQ(linear_of(255), 1);
  EXPECT_NEAR(linear_of(188), 0.5029, 1e-4);  // IEC 61966-2-1
  EXPECT_NEAR(linear_of(8), 8 / 255.0 / 12.92, 1e-9);
  const auto check = [](const ColourMap& map, double from, double to) {
    const Seen a = seen(map.at(from)), b = seen(map.at(to));
    EXPECT_GT(a.lightness - b.lightness, 0.4);
    for (int k = 1; k < 40; ++k) {
      const double share = k / 40.0;
      const Seen c = seen(map.at(from + share * (to - from)));
      EXPECT_NEAR(c.lightness, a.lightness + share * (b.lightness - a.lightness), 0.006) << share;
      if (share > 0.25) {
        const Seen half = seen(map.at((from + to) / 2));
        EXPECT_NEAR(c.hue, half.hue + (share - 0.5) * 2 * (b.hue - half.hue), 3) << share;
        EXPECT_GT(c.chroma, 0.03) << share;
      }
    }
  };
  check(ColourMap::diverging(), 0.5, 1);
  check(ColourMap::diverging(), 0.5, 0);
  check(ColourMap::violet(), 0, 1);
  check(ColourMap::teal(), 0, 1);
  const Rgb8 blue = ColourMap::diverging().at(0), red = ColourMap::diverging().at(1),
             violet = ColourMap::violet().at(1), teal = ColourMap::teal().at(1);
  EXPECT_GT(blue.b, blue.r + 80);
  EXPECT_GT(red.r, red.b + 80);
  EXPECT_GT(std::min(violet.r, violet.b), violet.g + 40);
  EXPECT_GT(std::min(teal.g, teal.b), teal.r + 40);
}

TEST(ColourMap, PositionsRunEvenlyFromLowestToHighest) {
  const ColourMap& map = ColourMap::teal();
  const auto& table = map.table();
  ASSERT_EQ(table.size(), static_cast<std::size_t>(ColourMap::kSize));
  for (std::size_t i = 0; i < table.size(); ++i)
    EXPECT_EQ(map.at(static_cast<double>(i) / 512), table[i]);
  EXPECT_EQ(map.at(-3), table.front());
  EXPECT_EQ(map.at(3), table.back());
  const ColourScale strain{ColourBy::strain, 0.2}, speed{ColourBy::speed, 4};
  EXPECT_EQ(strain.colour(-0.2), ColourMap::diverging().table().front());
  EXPECT_EQ(strain.colour(0.1), ColourMap::diverging().at(0.75));
  EXPECT_EQ(speed.colour(0), table.front());
  EXPECT_EQ(speed.colour(1), table[128]);
}

TEST(ColourScale, RoundsUpToTheNextRoundNumberAndHasRoundTicks) {
  const double round[] = {1, 1.5, 2, 3, 4, 5, 6, 8};
  for (const double power : {1e-4, 0.01, 1.0, 1000.0})
    for (std::size_t k = 0; k < 8; ++k) {
      const double below = round[k] * power, next = k < 7 ? round[k + 1] * power : 10 * power;
      EXPECT_DOUBLE_EQ(round_up(below, 1e-9), below);
      EXPECT_DOUBLE_EQ(round_up(below * 1.001, 1e-9), next);
      EXPECT_DOUBLE_EQ(round_up(next * 0.999, 1e-9), next);
      EXPECT_DOUBLE_EQ(round_up(1e-12, below), below);
      for (const ColourBy by : {ColourBy::strain, ColourBy::speed}) {
        const ColourScale scale{by, below};
        const auto ticks = scale.ticks();
        ASSERT_GE(ticks.size(), 4u);
        const double step = ticks[1] - ticks[0];
        const double leading = step / std::pow(10, std::floor(std::log10(step * 1.0000001)));
        EXPECT_LT(std::min({std::abs(leading - 1), std::abs(leading - 2), std::abs(leading - 2.5),
                            std::abs(leading - 3), std::abs(leading - 4), std::abs(leading - 5),
                            std::abs(leading - 7.5)}),
                  1e-6)
            << below << ": " << leading;
        for (std::size_t i = 1; i < ticks.size(); ++i)
          EXPECT_NEAR(ticks[i] - ticks[i - 1], step, 1e-9 * below);
        EXPECT_NEAR(ticks.front(), scale.low(), 1e-12 * below);
        EXPECT_NEAR(ticks.back(), below, 1e-12 * below);
      }
    }
  EXPECT_EQ((ColourScale{ColourBy::speed, 2}).text(0.8), "0.8 m/s");
  EXPECT_EQ((ColourScale{ColourBy::strain, 2}).text(0), "0");
  EXPECT_EQ((ColourScale{ColourBy::strain, 2}).text(0.02), "+2 %");
}

/// Projection by a pinhole camera: x and y over depth, in units of half the picture.
Vec3 pinhole(const Camera& c, const Vec3& p, double aspect) {
  const Vec3 from = p - c.eye.cast<double>();
  const double depth = -from.dot(c.back.cast<double>()),
               half = static_cast<double>(c.tan_half_height);
  return {from.dot(c.right.cast<double>()) / (depth * half * aspect),
          from.dot(c.up.cast<double>()) / (depth * half), depth};
}

TEST(Camera, IsTheNearestFromWhichThePointsFitTheFrame) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i)
    points.emplace_back(std::sin(i * 1.7), 0.7 * std::cos(i * 2.9), 1.3 * std::sin(i * 0.6 + 1));
  const FitRegion frame{-0.7, 0.6, -0.5, 0.8};
  for (const Vec3& up : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.3, 0.9, -0.2).normalized().eval()})
    for (const double aspect : {0.4, 1.0, 2.5})
      for (const View& view : {View{32, 20, false}, View{-90, 6, false}, View{170, -40, false}}) {
        const Camera camera = fit_camera(points, up, view, aspect, frame);
        const Vec3 right = camera.right.cast<double>(), top = camera.up.cast<double>(),
                   back = camera.back.cast<double>();
        EXPECT_NEAR(right.cross(top).dot(back), 1, 1e-5);
        EXPECT_NEAR(back.norm(), 1, 1e-5);
        EXPECT_NEAR(right.dot(up), 0, 1e-5) << "the horizon is level";
        EXPECT_NEAR(back.dot(up), std::sin(view.elevation * std::numbers::pi / 180), 1e-5);
        // azimuth runs from the horizontal part of +z (+x if up is z) towards up x ahead
        Vec3 ahead = std::abs(up.z()) > 0.99 ? Vec3::UnitX() : Vec3::UnitZ();
        ahead = (ahead - ahead.dot(up) * up).normalized();
        EXPECT_NEAR(std::atan2(back.dot(up.cross(ahead)), back.dot(ahead)),
                    view.azimuth * std::numbers::pi / 180, 1e-5);
        double slack[4] = {1e9, 1e9, 1e9, 1e9}, least = 1e9, most = 0;
        const Eigen::Matrix4d clip =
            camera.world_to_clip(static_cast<float>(aspect)).cast<double>();
        for (const Vec3& p : points) {
          const Vec3 at = pinhole(camera, p, aspect);
          const Eigen::Vector4d drawn = clip * p.homogeneous();
          EXPECT_NEAR(drawn.x() / drawn.w(), at.x(), 1e-4);
          EXPECT_NEAR(drawn.y() / drawn.w(), at.y(), 1e-4);
          EXPECT_LT(std::abs(drawn.z() / drawn.w()), 1);
          least = std::min(least, at.z());
          most = std::max(most, at.z());
          // half extents in metres at the point's distance
          const double tan = static_cast<double>(camera.tan_half_height),
                       across = at.z() * tan * aspect, along = at.z() * tan;
          slack[0] = std::min(slack[0], (frame.right - at.x()) * across);
          slack[1] = std::min(slack[1], (at.x() - frame.left) * across);
          slack[2] = std::min(slack[2], (frame.top - at.y()) * along);
          slack[3] = std::min(slack[3], (at.y() - frame.bottom) * along);
        }
        EXPECT_NEAR(slack[0], slack[1], 1e-4) << "centred";
        EXPECT_NEAR(slack[2], slack[3], 1e-4);
        EXPECT_NEAR(std::min(slack[0], slack[2]), 0, 1e-4) << "as near as it can be";
        EXPECT_LT(static_cast<double>(camera.near_plane), least);
        EXPECT_GT(static_cast<double>(camera.far_plane), most);
        // the near plane maps to -1, the far plane to 1
        for (const auto& [plane, depth] :
             {std::pair{camera.near_plane, -1.0}, {camera.far_plane, 1.0}}) {
          const Eigen::Vector4d drawn =
              clip *
              (camera.eye.cast<double>() - static_cast<double>(plane) * back).eval().homogeneous();
          EXPECT_NEAR(drawn.z() / drawn.w(), depth, 2e-3);
        }
      }
}

TEST(Camera, GoesBesideOrBelowTheInset) {
  int hidden = 0, below_it = 0;
  for (const double height : {0.05, 0.2, 0.5, 0.8, 1.0, 1.5, 2.0}) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
      corners.emplace_back(k & 1 ? 1 : -1, k & 2 ? height : -height, k & 4 ? 0.1 : -0.1);
    const FitRegion frame = FitRegion::beside_inset();
    FitRegion whole = frame;
    whole.inset_left = whole.inset_bottom = 2;  // hides nothing of the panel
    FitRegion below = whole, beside = whole;
    below.top = frame.inset_bottom;
    below.right = -frame.left;
    beside.right = frame.inset_left;
    const auto camera = [&](const FitRegion& region) {
      return fit_camera(corners, Vec3::UnitY(), {0, 0, false}, 1, region);
    };
    const bool hides = std::ranges::any_of(corners, [&](const Vec3& p) {
      const Vec3 at = pinhole(camera(whole), p, 1);
      return at.x() > frame.inset_left && at.y() > frame.inset_bottom;
    });
    const float one = camera(below).eye.z(), other = camera(beside).eye.z();
    EXPECT_FLOAT_EQ(camera(frame).eye.z(), hides ? std::min(one, other) : camera(whole).eye.z());
    hidden += hides;
    below_it += hides && one < other;
  }
  EXPECT_GT(hidden, below_it);
  EXPECT_GT(below_it, 0);
  EXPECT_LT(hidden, 7);
}

TEST(VertexValues, AreMeansOfLinksDepthsInCollidersAndSpeeds) {
  Scene scene = test::level_sheet(6);
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true});
  scene.pins = {0, 1, 5};
  scene.colliders = {{Ball{Vec3(0.1, 0.05, -0.1), 0.25}, {.velocity = {0, 0.1, 0}}, 0},
                     {Box{Vec3(-0.3, 0, 0.2), Vec3(0.2, 0.1, 0.3)}, {}, 0},
                     {Plane{Vec3(0.6, 0.8, 0), 0.02}, {}, 0}};
  State state = scene.start;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const auto n = static_cast<double>(i);
    state.x[i] += 0.07 * Vec3(std::sin(3 * n), std::cos(5 * n), std::sin(7 * n + 1));
    state.v[i] = Vec3(std::cos(n), 2 * std::sin(2 * n), 0.3);
  }
  const double t = 0.4;
  const auto strains = vertex_values(scene, ColourBy::strain, state, t),
             depths = vertex_values(scene, ColourBy::penetration, state, t),
             speeds = vertex_values(scene, ColourBy::speed, state, t);
  double deepest = 0, fastest = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    double sum = 0, count = 0, depth = 0;
    for (const Link& l : scene.links)
      if (l.family != Family::bend && (to_index(l.a) == i || to_index(l.b) == i)) {
        sum += (state.x[to_index(l.a)] - state.x[to_index(l.b)]).norm() / l.rest - 1;
        ++count;
      }
    for (const Collider& c : scene.colliders)
      depth = std::max(depth, -surface(shape_at(c, t), state.x[i]).distance);
    EXPECT_NEAR(strains[i], sum / count, 1e-12);
    EXPECT_NEAR(depths[i], depth, 1e-15);
    EXPECT_NEAR(speeds[i], std::sqrt(state.v[i].dot(state.v[i])), 1e-14);
    deepest = std::max(deepest, depth);
    fastest = std::max(fastest, speeds[i]);
  }
  EXPECT_GT(deepest, 0.05);
  double sum = 0, squares = 0, most = 0, count = 0;
  for (const Link& l : scene.links) {
    const bool pins = std::ranges::count(scene.pins, l.a) && std::ranges::count(scene.pins, l.b);
    if (l.family == Family::bend || pins) continue;
    const double e = (state.x[to_index(l.a)] - state.x[to_index(l.b)]).norm() / l.rest - 1;
    sum += e;
    squares += e * e;
    most = std::max(most, std::abs(e));
    ++count;
  }
  const LiveFigures live = live_figures(scene, state, t);
  EXPECT_NEAR(live.max_strain, most, 1e-12);
  EXPECT_NEAR(live.mean_strain, sum / count, 1e-12);
  EXPECT_NEAR(live.rms_strain, std::sqrt(squares / count), 1e-12);
  EXPECT_EQ(live.max_depth, deepest);
  EXPECT_EQ(live.max_speed, fastest);
}

TEST(RecordedRun, ShowsTheNearestFrameAndItsSpeeds) {
  const Scene scene = test::level_sheet(3);
  Trajectory trajectory = test::empty_trajectory(scene);
  for (const double t : {0.0, 0.1, 0.3, 0.4, 1.0}) {
    State state = scene.start;
    for (Vec3& x : state.x) x += Vec3(t * t, 2 * t, 0);
    state.v.clear();
    trajectory.frames.push_back({t, state});
  }
  const RecordedRun run = recorded_run(scene, trajectory);
  EXPECT_FALSE(run.stop.has_value());
  const std::pair<double, double> nearest[] = {{-1, 0},     {0.04, 0},   {0.06, 0.1}, {0.19, 0.1},
                                               {0.21, 0.3}, {0.69, 0.4}, {0.71, 1},   {5, 1}};
  for (const auto& [t, frame] : nearest) EXPECT_EQ(run.at(t).t, frame) << t;
  for (std::size_t k = 1; k < 5; ++k) {
    const double from = run.trajectory.frames[k - 1].t, to = run.trajectory.frames[k].t;
    for (const Vec3& v : run.trajectory.frames[k].state.v)
      EXPECT_LT((v - Vec3(from + to, 2, 0)).norm(), 1e-9);
  }
  EXPECT_EQ(run.trajectory.frames[0].state.v[0], scene.start.v[0]);
  trajectory.frames.pop_back();
  EXPECT_EQ(recorded_run(scene, trajectory).stop->why, "ended");
}

}  // namespace
}  // namespace taut::numbers_test
