// Motions in the format in which results store them.
#include "experiments/case/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/model/input_error.hpp"
#include "tests/support/bytes.hpp"

namespace taut::trajectory_test {
namespace {

Frame frame(double t, double scale) {
  return {t, {{Vec3(scale, -1 / 3.0, 1e-9), Vec3(0, 2 * scale, 3)}, {}}};
}

TEST(Frames, ComeBackAsTheNearestFloats) {
  std::string all;
  for (int k = 0; k < 3; ++k) all += frame_bytes(frame(k / 64.0, k + 0.1));
  const std::vector<Frame> read = frames_in(all, 2);
  ASSERT_EQ(read.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const Frame& one = read[static_cast<std::size_t>(k)];
    EXPECT_EQ(one.t, k / 64.0);
    EXPECT_TRUE(one.state.v.empty());
    for (std::size_t i = 0; i < 2; ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(one.state.x[i][axis],
                  static_cast<double>(static_cast<float>(frame(0, k + 0.1).state.x[i][axis])));
  }
  Frame bad = frame(0, 1);
  bad.state.x[1][2] = std::nan("");
  EXPECT_TRUE(std::isnan(frames_in(frame_bytes(bad), 2)[0].state.x[1][2])) << "is data";
}

TEST(Frames, AreWrittenAsDocumented) {
  EXPECT_EQ(frame_bytes({0.5, {{Vec3(1, 2, 3)}, {}}}),
            bytes("000000000000e03f 0000803f 00000040 00004040"));
}

// A killed writer may leave any part of the last frames: only whole frames are read.
TEST(Frames, OfAnyPartTheWholeOnesAreRead) {
  const std::string all = frame_bytes(frame(0, 1)) + frame_bytes(frame(1, 1));
  for (std::size_t size = 0; size <= all.size(); ++size)
    if (size < 32)
      EXPECT_THROW(frames_in(all.substr(0, size), 2), InputError) << size;
    else
      EXPECT_EQ(frames_in(all.substr(0, size), 2).size(), size / 32) << size;
}

TEST(Frames, TimesDoNotGoBack) {
  const auto read = [](std::initializer_list<double> times) {
    std::string all;
    for (const double t : times) all += frame_bytes(frame(t, 1));
    return frames_in(all, 2).size();
  };
  EXPECT_EQ(read({-1, 0, 0, 2}), 4u);
  EXPECT_THROW(read({0, 2, 1}), InputError);
  EXPECT_THROW(read({std::numeric_limits<double>::infinity()}), InputError);
}

}  // namespace
}  // namespace taut::trajectory_test
