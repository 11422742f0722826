// Video, media for the report, and export to other tools.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "experiments/render/picture/media.hpp"
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
  options.width = 480, options.height = 200, options.duration = 0.25;
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
  const PageLayout layout(640, 360, 2);
  SceneRendererOptions look;
  look.width = layout.panel_width, look.height = layout.panel_height;
  look.quality = RenderQuality::draft();
  const SceneRenderer renderer(scene, runs, look);
  const Image still = compose(renderer, layout, 1);
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
  EXPECT_LT(d.mean, 1.7);  // 4:2:0 chroma and crf 22; a wrong colour matrix gives more
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
  int told = 0;
  const Media media = render_media(scene, runs, quick(), [&](int done, int) { told = done; });
  EXPECT_EQ(media.mp4.substr(4, 4), "ftyp");
  EXPECT_EQ(media.poster.substr(0, 2), "\xFF\xD8");
  EXPECT_EQ(media.rms_strain.size(), 2u);
  EXPECT_EQ(media.rms_strain[0].size(), media.t.size());
  EXPECT_EQ(told, static_cast<int>(media.t.size()));
  ASSERT_EQ(media.material.size(), media.rms_strain.size());
  EXPECT_EQ(media.material[0].size(), 4u);
  EXPECT_EQ(media.mp4, render_media(scene, runs, quick()).mp4);
  // the cloth moves all the time: each frame is another picture
  std::ofstream(folder_ / "film.mp4", std::ios::binary) << media.mp4;
  std::istringstream frames(output_of("ffmpeg -v error -i " + (folder_ / "film.mp4").string() +
                                      " -f framemd5 - | grep -v '^#'"));
  std::set<std::string> pictures;
  std::size_t count = 0;
  for (std::string line; std::getline(frames, line); ++count)
    pictures.insert(line.substr(line.rfind(',')));
  EXPECT_EQ(count, media.t.size());
  EXPECT_EQ(pictures.size(), media.t.size());
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

}  // namespace
}  // namespace taut::video_test
