// Videos, media for the report, and export to other tools.
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "core/model/text.hpp"
#include "experiments/case/case.hpp"
#include "experiments/render/film/film_plan.hpp"
#include "experiments/render/picture/media.hpp"
#include "experiments/report/input.hpp"
#include "experiments/system/files.hpp"
#include "tests/render/render_scenes.hpp"

namespace taut::video_test {
namespace {

namespace fs = std::filesystem;

class VideoTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("taut_video_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string output_of(const std::string& command) {
    std::string out;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 512> piece{};
    while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), pipe))
      out.append(piece.data(), got);
    pclose(pipe);
    return out;
  }
  fs::path folder_;
};

MediaOptions quick() {
  MediaOptions options;
  options.width = 480;
  options.height = 200;
  options.duration = 0.25;
  options.fps = 22;
  options.quality = RenderQuality::draft();
  return options;
}

TEST(FrameRateTest, IsExactForFractionsOfASecond) {
  EXPECT_EQ(frame_rate(2.0 / 64).numerator, 32);
  EXPECT_EQ(frame_rate(3.0 / 64).numerator, 64);
  EXPECT_EQ(frame_rate(3.0 / 64).denominator, 3);
  EXPECT_EQ(frame_rate(1001.0 / 30000).denominator, 1001);
}

TEST_F(VideoTest, ADecodedFrameMatchesItsStill) {
  if (!on_path("ffmpeg")) GTEST_SKIP() << "no ffmpeg";
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 5), test::draped(scene, 8)};
  const auto layout = PageLayout::page(640, 360, 2);
  SceneRendererOptions look;
  look.width = layout.panel_width;
  look.height = layout.panel_height;
  look.quality = RenderQuality::draft();
  const SceneRenderer renderer(scene, runs, look);
  const Image still = compose(renderer, layout, {1});
  VideoWriter video(folder_ / "v.mp4", {640, 360, {32, 1}, 22});
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(video.write(still));
  ASSERT_EQ(video.finish(), "");
  const std::string mp4 = (folder_ / "v.mp4").string();
  const std::string raw =
      output_of("ffmpeg -v error -ss 0.15 -i " + mp4 +
                " -frames:v 1 -vf scale=in_color_matrix=bt709:flags=accurate_rnd+full_chroma_int"
                " -pix_fmt rgb24 -f rawvideo -");
  Image decoded(640, 360);
  ASSERT_EQ(raw.size(), decoded.pixels().size() * sizeof(Rgb8));
  std::memcpy(&decoded.at(0, 0), raw.data(), raw.size());
  const test::Difference d = test::difference(still, decoded);
  EXPECT_LT(d.mean, 1.7);  // chroma 4:2:0 and crf 22; a wrong colour matrix would exceed this
  const std::string tags = output_of(
      "ffprobe -v error -select_streams v -show_entries "
      "stream=codec_name,pix_fmt,color_space,color_transfer,color_primaries,color_range -of csv " +
      mp4);
  EXPECT_EQ(tags, "stream,h264,yuv420p,tv,bt709,bt709,bt709\n");
}

TEST_F(VideoTest, MediaHasAVideoForEveryMomentTheSameBytesAgain) {
  if (!on_path("ffmpeg")) GTEST_SKIP() << "no ffmpeg";
  const Scene scene = test::sheet_over_ball(17);
  const std::vector<RecordedRun> runs{test::draped(scene, 5), test::draped(scene, 8)};
  const Media media = render_media(scene, runs, quick());
  EXPECT_EQ(media.mp4.substr(4, 4), "ftyp");
  EXPECT_EQ(media.poster.substr(0, 2), "\xFF\xD8");
  EXPECT_EQ(media.rms_strain.size(), 2u);
  EXPECT_EQ(media.rms_strain[0].size(), media.t.size());
  EXPECT_EQ(media.mp4, render_media(scene, runs, quick()).mp4);
  MediaOptions still = quick();
  still.still = true;
  const Media picture = render_media(scene, runs, still);
  EXPECT_EQ(picture.mp4, "");
  EXPECT_EQ(picture.poster, media.poster);
  // the cloth moves throughout, so that all frames differ
  std::ofstream(folder_ / "film.mp4", std::ios::binary) << media.mp4;
  std::istringstream frames(output_of("ffmpeg -v error -i " + (folder_ / "film.mp4").string() +
                                      " -f framemd5 - | grep -v '^#'"));
  std::set<std::string> pictures;
  std::size_t count = 0;
  for (std::string line; std::getline(frames, line); ++count)
    pictures.insert(line.substr(line.rfind(',')));
  EXPECT_EQ(count, media.t.size());
  EXPECT_EQ(pictures.size(), media.t.size());
  EXPECT_EQ(
      output_of("ffprobe -v error -show_entries stream=width,height,r_frame_rate -of csv=p=0 " +
                (folder_ / "film.mp4").string()),
      "480,200,64/3\n")
      << "a frame each three steps of 1/64 s";
}

TEST_F(VideoTest, WithoutFfmpegThereIsAPoster) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  VideoWriter video(folder_ / "v.mp4", {64, 64, {32, 1}, 22});
  for (int k = 0; k < 200 && video.write(Image(64, 64)); ++k) usleep(1000);
  EXPECT_EQ(video.finish(), "ffmpeg is not installed");
  EXPECT_FALSE(fs::exists(folder_ / "v.mp4"));
  const Scene scene = test::level_sheet(5);
  const std::vector<RecordedRun> runs{test::stretched(scene, 0.01)};
  const Media media = render_media(scene, runs, quick());
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(media.mp4, "");
  EXPECT_EQ(media.poster_type, "image/png");
  EXPECT_EQ(media.poster.substr(1, 3), "PNG");
}

/// Without ffmpeg a film is its poster; choosing it needs no encoder.
class Posters : public testing::Test {
 protected:
  void SetUp() override { setenv("PATH", "/nowhere", 1); }
  void TearDown() override { setenv("PATH", path_.c_str(), 1); }
  static Media media_of(const Scene& scene, const std::vector<RecordedRun>& runs, double duration,
                        double speed = 1) {
    MediaOptions options = quick();
    options.duration = duration;
    options.speed = speed;
    options.width = 240;
    options.height = 100;
    return render_media(scene, runs, options);
  }
  const std::string path_ = std::getenv("PATH");
};

/// Level sheet with the strain `strain`(t), moved along x by `way`(t) [m].
RecordedRun moving(
    const Scene& scene, const std::function<double(double)>& strain,
    const std::function<double(double)>& way = [](double) { return 0.0; }) {
  Trajectory trajectory = test::empty_trajectory(scene);
  for (int k = 0; k <= scene.steps; ++k) {
    const double t = k * scene.dt;
    State state = scene.start;
    for (Vec3& x : state.x) x = (1 + strain(t)) * x + Vec3(way(t), 0, 0);
    trajectory.frames.push_back({t, state});
  }
  RecordedRun run = recorded_run(scene, trajectory);
  run.title = "Analytic";
  return run;
}

Image decoded(const std::string& bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()));
  png.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, &image.at(0, 0), 0, nullptr));
  return image;
}

TEST_F(Posters, FramesAreWholeStepsAtAboutTheRateOfTheFilm) {
  const Scene scene = test::level_sheet(3);  // 64 steps of 1/64 s
  const std::vector<RecordedRun> runs{moving(scene, [](double t) { return 0.02 * t; })};
  const auto steps = [&](double duration, double speed, const std::vector<RecordedRun>& of) {
    std::vector<double> all;
    const Media media = media_of(scene, of, duration, speed);
    for (const double t : media.t) all.push_back(t * 64);
    for (std::size_t k = 0; k < media.t.size(); ++k)
      EXPECT_NEAR(media.rms_strain[0][k], 0.02 * std::min(1.0, media.t[k]), 1e-12);
    return all;
  };
  using Steps = std::vector<double>;
  EXPECT_EQ(steps(0.25, 1, runs), (Steps{0, 3, 6, 9, 12, 15})) << "22 a second: 64 / 22 = 2.9";
  EXPECT_EQ(steps(0.25, 4, runs), (Steps{0, 12}));
  EXPECT_EQ(steps(3 / 64.0, 0.3, runs), (Steps{0, 1, 2, 3})) << "no finer than the steps are";
  EXPECT_EQ(steps(0.01, 1, runs), (Steps{0, 3})) << "two at least";
  EXPECT_EQ(steps(9, 8, runs), (Steps{0, 23, 46})) << "to the scene's end";
  std::vector<RecordedRun> coarse = runs;
  coarse[0].trajectory.frame_dt = 4.0 / 64;
  EXPECT_EQ(steps(0.25, 1, coarse), (Steps{0, 4, 8, 12, 16}));
}

TEST_F(Posters, ShowWhereTheRunsDifferMost) {
  const Scene scene = test::level_sheet(3);
  const auto poster = [&](const std::vector<RecordedRun>& runs) {
    return media_of(scene, runs, 1).poster_t * 64 / 3;  // number of the frame at 22 frames a second
  };
  const auto none = [](double) { return 0.0; };
  /// `much` in frame k, otherwise little.
  const auto at = [](int k, double much, double little) {
    return [=](double t) { return std::lround(t * 64) == 3 * k ? much : little; };
  };
  const auto early_and = [](int k) {
    return [=](double t) {
      const auto step = std::lround(t * 64);
      return step == 3 ? 0.5 : step == 3 * k ? 0.1 : 0.01;
    };
  };
  EXPECT_EQ(poster({moving(scene, none), moving(scene, early_and(7))}), 7);
  EXPECT_EQ(poster({moving(scene, early_and(2)), moving(scene, none)}), 2);
  EXPECT_EQ(poster({moving(scene, early_and(21)), moving(scene, none)}), 21);
  EXPECT_EQ(poster({moving(scene, at(9, 0.21, 0.1)), moving(scene, at(5, 0.2, 0.1)),
                    moving(scene, at(5, 0.17, 0.1))}),
            9)
      << "between the least and the largest";
  EXPECT_EQ(poster({moving(scene, at(6, 0.3, 0.2))}), 6) << "of one alone its own";
  const double size = extent(scene);
  const auto little = at(5, 9e-4, 0);  // strain too small to see
  EXPECT_EQ(poster({moving(scene, none), moving(scene, little, at(11, 0.011 * size, 0))}), 11);
  EXPECT_EQ(poster({moving(scene, none), moving(scene, little, at(11, 0.009 * size, 0))}), 14)
      << "two thirds on the way";
  EXPECT_EQ(poster({moving(scene, none), moving(scene, at(5, 1.1e-3, 0), at(11, size, 0))}), 5)
      << "strain before place";
}

TEST_F(Posters, HaveTheRunsAndTheirClothLaidFlat) {
  Scene scene = test::level_sheet(5);
  scene.mesh = make_sheet({.nu = 5,
                           .nv = 3,
                           .width = 1,
                           .height = 0.5,
                           .origin = Vec3(-0.5, 0, 0.5),
                           .v = -Vec3::UnitZ(),
                           .mass = 1});
  scene.links = grid_links(scene.mesh, {});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(15, Vec3::Zero())};
  const RecordedRun one = moving(scene, [](double t) { return 0.02 * t; }),
                    two = moving(scene, [](double t) { return -0.01 * t; });
  const Media first = media_of(scene, {one, two}, 1), second = media_of(scene, {two, one}, 1);
  const Image left = decoded(first.poster), right = decoded(second.poster);
  ASSERT_EQ(std::pair(left.width(), left.height()), std::pair(240, 100));
  std::size_t differ = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 120; ++x) {
      ASSERT_EQ(left.at(x, y), right.at(x + 120, y)) << x << ' ' << y;
      ASSERT_EQ(left.at(x + 120, y), right.at(x, y));
      differ += left.at(x, y) != left.at(x + 120, y);
    }
  EXPECT_GT(differ, 100u);
}

Record ran(const std::string& scene, const std::string& solver, const Status& status = {}) {
  Record r = unfinished(make_case({scene, {}, solver}), status);
  r.values = {{"stretch.rms", 0.01}};
  return r;
}

/// Callback for the news of each film; checks the progress numbers.
auto teller(const std::function<void(const std::string&)>& hear) {
  return [=](const std::string& news, std::size_t done, std::size_t all) {
    EXPECT_LE(done, all);
    hear(news);
  };
}

TEST_F(Posters, AFilmShowsTheQuotedCasesAndWhoRefuses) {
  const Scratch scratch;
  const std::string cloth = "[cloth]\ngrid = [4, 3]\nsize = [1, 0.5]\nmass = 0.1\n",
                    small = (scratch.path() / "small.toml").string();
  write_file(small, cloth + "pins = [0]\n[time]\ndt = \"1/64\"\nduration = 0.25\n");
  const double size = extent(*make_case({small, {}, "jakobsen"}).scene);
  /// Speeds [sizes of the cloth per second] and expected speeds of the film, in which the cloth
  /// needs at least half a second to cross its own size: at this limit, and just above it.
  const std::pair<double, double> thrown[] = {{4, 0.5}, {2, 1}, {4.01, 0.25}, {8.01, 0.125}};
  std::vector<OtherScene> others;
  for (const auto& [speed, expected] : thrown) {
    others.push_back({(scratch.path() / ("thrown" + shortest(speed) + ".toml")).string()});
    write_file(others.back().name, cloth + "velocity = [0, 0, " + shortest(speed * size) +
                                       "]\n[time]\ndt = \"1/16\"\nduration = 4\n");
  }
  report::ReportInput input;
  input.studies = {{"one", "?", {}, 0, {}}};
  const char* solvers[] = {"xpbd:substeps=1,iterations=2",
                           "jakobsen:substeps=1,iterations=2,order=mesh"};
  for (const char* solver : solvers) input.studies[0].records.push_back(ran(small, solver));
  input.studies[0].records.push_back(
      ran(small, "mass-spring:substeps=1", {Status::Kind::unsupported, "no reason", -1, -1}));
  std::multiset<std::string> news;
  add_films(input, others, scratch.path() / "films",
            teller([&](const std::string& said) { news.insert(said); }));
  EXPECT_EQ(news, (std::multiset<std::string>{"small filmed", "thrown2 filmed", "thrown4 filmed",
                                              "thrown4.01 filmed", "thrown8.01 filmed"}));
  ASSERT_EQ(input.media.size(), 5u);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(input.media[k + 1].footage.speed, thrown[k].second) << k;
  const report::SceneMedia &first = input.media[0], &other = input.media[1];
  EXPECT_EQ(first.scene, "small");
  const report::Footage& clip = first.footage;
  ASSERT_EQ(first.panels.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(first.panels[k].key, input.studies[0].records[k].key);
  EXPECT_EQ(first.panels[0].solver + first.panels[1].solver, "xpbdjakobsen");
  EXPECT_EQ(first.panels[0].settings, "1 × 2");
  EXPECT_EQ(first.panels[1].settings, "1 × 2, order=mesh");
  EXPECT_TRUE(clip.alt.starts_with(
      "small: XPBD (1 × 2) and Jakobsen (1 × 2, order=mesh) side by side from the left, coloured "
      "by mean edge strain ε at each vertex, full red at +"))
      << clip.alt;
  EXPECT_EQ(clip.type + clip.poster_type, "image/pngimage/png");
  const Image poster = decoded(clip.bytes);
  EXPECT_EQ(std::pair(poster.width(), poster.height()), std::pair(640, 400))
      << "two of three thirds of 960";
  using Refused = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(first.refused, (Refused{{"mass-spring", "no reason"}}));
  EXPECT_EQ(clip.duration, 16 / 64.0);
  EXPECT_EQ(clip.frame, 4 / 64.0);
  EXPECT_EQ(clip.speed, 1);
  ASSERT_EQ(clip.bar.stops.size(), 17u);
  for (const auto& [stop, at] : {std::pair{0, 0.0}, {4, 0.25}, {8, 0.5}, {16, 1.0}}) {
    const Rgb8 c = ColourMap::diverging().at(at);
    char text[8];
    std::snprintf(text, sizeof text, "#%02X%02X%02X", c.r, c.g, c.b);
    EXPECT_EQ(clip.bar.stops[static_cast<std::size_t>(stop)], text);
  }
  const auto &left = clip.bar.ticks.front(), &right = clip.bar.ticks.back();
  EXPECT_EQ(left.first, 0);
  EXPECT_EQ(right.first, 1);
  EXPECT_TRUE(left.second.starts_with("\u2212"));
  EXPECT_TRUE(right.second.starts_with("+"));
  EXPECT_EQ(other.scene, "thrown4");
  EXPECT_TRUE(other.refused.empty());
  EXPECT_EQ(other.panels.size(), 3u) << "whoever can";
  EXPECT_EQ(other.footage.columns, 3);
  EXPECT_EQ(other.panels[0].key, "") << "no study ran it";
  EXPECT_EQ(other.footage.duration, 1.5) << "three seconds of film";
  const Image wide = decoded(other.footage.bytes);
  EXPECT_EQ(std::pair(wide.width(), wide.height()), std::pair(702, 320));
  ASSERT_FALSE(input.series.empty());
  for (const report::TimeSeries& series : input.series)
    EXPECT_TRUE(series.scene.starts_with("thrown")) << "a study has its own";
  // Films are made once: the second report uses those that the first one stored.
  report::ReportInput again;
  again.studies = input.studies;
  add_films(again, others, scratch.path() / "films",
            teller([](const std::string& said) { ADD_FAILURE() << said; }));
  ASSERT_EQ(again.media.size(), input.media.size());
  for (std::size_t k = 0; k < again.media.size(); ++k) {
    const report::SceneMedia &a = input.media[k], &b = again.media[k];
    EXPECT_EQ(std::tie(a.scene, a.summary, a.footage.duration, a.footage.speed, a.footage.frame,
                       a.footage.poster_t, a.footage.bar.stops, a.footage.bar.ticks, a.refused),
              std::tie(b.scene, b.summary, b.footage.duration, b.footage.speed, b.footage.frame,
                       b.footage.poster_t, b.footage.bar.stops, b.footage.bar.ticks, b.refused));
    EXPECT_EQ(a.footage.bytes, b.footage.bytes);
    EXPECT_EQ(a.footage.alt, b.footage.alt);
    EXPECT_EQ(a.panels.size(), b.panels.size());
  }
  ASSERT_EQ(again.series.size(), input.series.size());
  for (std::size_t k = 0; k < again.series.size(); ++k)
    EXPECT_EQ(again.series[k].t, input.series[k].t);
  // Damaged files are made again.
  for (const auto& entry : fs::directory_iterator(scratch.path() / "films"))
    if (entry.path().string().ends_with("-poster.jpg") ||
        entry.path().string().ends_with("-poster.png")) {
      std::ofstream(entry.path()) << "cut";
      break;
    }
  std::vector<std::string> mended;
  again.media.clear();
  again.series.clear();
  add_films(again, others, scratch.path() / "films",
            teller([&](const std::string& said) { mended.push_back(said); }));
  EXPECT_EQ(mended.size(), 1u);
  ASSERT_EQ(again.media.size(), input.media.size());
  EXPECT_EQ(again.media[0].footage.poster, input.media[0].footage.poster);
  // Another case gets another film.
  again.studies[0].records[0] = ran(small, "xpbd:substeps=1,iterations=3");
  std::vector<std::string> made;
  add_films(again, {}, scratch.path() / "films",
            teller([&](const std::string& said) { made.push_back(said); }));
  EXPECT_EQ(made, (std::vector<std::string>{"small filmed"}));
}

}  // namespace
}  // namespace taut::video_test
