#include "experiments/case/trajectory.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>

#include "core/model/input_error.hpp"
#include "tests/support/bytes.hpp"

namespace taut::trajectory_test {
namespace {

namespace fs = std::filesystem;

class TrajectoryTest : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("taut_trajectory_" + std::to_string(getpid()) + ".traj");
  }
  void TearDown() override { fs::remove(path_); }

  static TrajectoryHeader header() {
    return {"hang", "jakobsen:iterations=3", 1.0 / 64, 3, {{0, 1, 2}}};
  }
  static State state(double scale) {
    const auto at = [&](double a) { return Vec3(a * scale, -a / 3, 1e-9 * a); };
    return {{at(1), at(2), at(3)}, {at(4), at(5), at(6)}};
  }
  void write(const TrajectoryHeader& h, int frames) {
    TrajectoryWriter writer(path_, h);
    for (int k = 0; k < frames; ++k) writer.append(k * h.frame_dt, state(k + 1));
    EXPECT_EQ(writer.frames(), frames);
  }
  std::string message_of_reading() const {
    try {
      read_trajectory(path_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  void overwrite(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  fs::path path_;
};

TEST_F(TrajectoryTest, FramesComeBackAsTheNearestFloats) {
  write(header(), 4);
  const Trajectory read = read_trajectory(path_);
  EXPECT_EQ(read.header.scene, "hang");
  EXPECT_EQ(read.header.solver, "jakobsen:iterations=3");
  EXPECT_EQ(read.header.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(read.header.frame_dt, 1.0 / 64);
  ASSERT_EQ(read.frames.size(), 4u);
  for (int k = 0; k < 4; ++k) {
    const auto& frame = read.frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.t, k / 64.0);
    EXPECT_TRUE(frame.state.v.empty());
    for (std::size_t i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(frame.state.x[i][axis],
                  static_cast<double>(static_cast<float>(state(k + 1).x[i][axis])));
  }
}

TEST_F(TrajectoryTest, NonFiniteStatesAreData) {
  State bad = state(1);
  bad.x[1][2] = std::numeric_limits<double>::quiet_NaN();
  TrajectoryWriter(path_, header()).append(0, bad);
  EXPECT_TRUE(std::isnan(read_trajectory(path_).frames[0].state.x[1][2]));
}

// A writer that is killed leaves any prefix of the file: whole frames survive, the rest is dropped.
TEST_F(TrajectoryTest, EveryPrefixReadsItsWholeFramesOrSaysWhy) {
  write(header(), 3);
  const auto whole = fs::file_size(path_);
  const std::uint64_t frame = 8 + 3 * 3 * 4, first = whole - 3 * frame;
  for (std::uint64_t size = whole; size-- > 0;) {
    fs::resize_file(path_, size);
    if (size < first) {
      EXPECT_THROW(TrajectoryReader{path_}, InputError) << size;
      continue;
    }
    TrajectoryReader reader(path_);
    EXPECT_EQ(static_cast<std::uint64_t>(reader.frames()), (size - first) / frame) << size;
    EXPECT_EQ(reader.dropped_bytes(), (size - first) % frame) << size;
  }
}

TEST_F(TrajectoryTest, BadFilesSayWhatIsWrong) {
  EXPECT_NE(message_of_reading().find("cannot read"), std::string::npos);
  overwrite("");
  EXPECT_NE(message_of_reading().find("empty file"), std::string::npos);
  overwrite("solid cube\n");
  EXPECT_NE(message_of_reading().find("not a trajectory"), std::string::npos);
  overwrite("TAUTTR");
  EXPECT_NE(message_of_reading().find("truncated within its header"), std::string::npos);
  write(header(), 0);
  EXPECT_NE(message_of_reading().find("without a whole frame"), std::string::npos);
  std::fstream(path_, std::ios::in | std::ios::out | std::ios::binary).seekp(8).put(2);
  EXPECT_NE(message_of_reading().find("version 2"), std::string::npos);
  fs::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_NE(message_of_reading().find("is no regular file"), std::string::npos);
  EXPECT_THROW(TrajectoryWriter("/nowhere/x.traj", header()), InputError);
}

// The reader that the header file prints, run as printed.
TEST_F(TrajectoryTest, TheDocumentedPythonReadsIt) {
  if (std::system("python3 -c pass >/dev/null 2>&1") != 0) GTEST_SKIP() << "no python3";
  write(header(), 2);
  std::ifstream documentation(TAUT_SOURCE_DIR "/experiments/case/trajectory.hpp");
  std::string script, line;
  const std::string prefix = "///     ";
  for (bool inside = false; std::getline(documentation, line);) {
    if (line == prefix + "import struct") inside = true;
    if (inside && line.compare(0, prefix.size(), prefix) != 0) break;
    if (inside) script += line.substr(prefix.size()) + '\n';
  }
  script.replace(script.find("run.traj"), 8, path_.string());
  script += "print(version, n, triangles, k + 1, t, x[2][0])\n";
  const fs::path file = path_.string() + ".py";
  std::ofstream(file) << script;
  std::string output(256, '\0');
  FILE* python = popen(("python3 '" + file.string() + "'").c_str(), "r");
  ASSERT_NE(python, nullptr);
  output.resize(std::fread(output.data(), 1, output.size(), python));
  EXPECT_EQ(pclose(python), 0);
  fs::remove(file);
  EXPECT_EQ(output, "1 3 [(0, 1, 2)] 2 0.015625 6.0\n");
}

/// A trajectory of three vertices and one triangle, of "ab" by "xyz", as the format has it.
std::string by_hand() {
  return "TAUTTRAJ" +
         bytes(
             "01000000 44000000 03000000 01000000 04000000 01000000 02000000 03000000"
             "000000000000d03f") +
         "abxyz" + std::string(3, '\0') + bytes("00000000 02000000 01000000") +
         bytes("000000000000e03f 0000803f 00000040 00004040") + std::string(24, '\0');
}

TEST_F(TrajectoryTest, IsWrittenAsItIsDocumented) {
  const TrajectoryHeader h{"ab", "xyz", 0.25, 3, {{0, 2, 1}}};
  const std::vector<Vec3> zero(3, Vec3::Zero());
  State one{zero, zero};
  one.x[0] = {1, 2, 3};
  TrajectoryWriter(path_, h).append(0.5, one);
  std::ifstream in(path_, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), by_hand());
  overwrite(by_hand());
  const Trajectory read = read_trajectory(path_);
  EXPECT_EQ(read.header.scene, "ab");
  EXPECT_EQ(read.header.solver, "xyz");
  EXPECT_EQ(read.header.frame_dt, 0.25);
  EXPECT_EQ(read.header.triangles, (std::vector<Triangle>{{0, 2, 1}}));
  ASSERT_EQ(read.frames.size(), 1u);
  EXPECT_EQ(read.frames[0].t, 0.5);
  EXPECT_EQ(read.frames[0].state.x, one.x);
}

TEST_F(TrajectoryTest, EachNumberOfTheHeaderIsJudged) {
  const auto says = [&](std::size_t at, const char* four, const std::string& what) {
    overwrite(by_hand().replace(at, 4, bytes(four)));
    EXPECT_EQ(message_of_reading(), path_.string() + ": " + what) << at;
  };
  says(8, "00000000", "version 0; this program reads version 1");
  for (const auto& [at, four] : std::vector<std::pair<std::size_t, const char*>>{{12, "45000000"},
                                                                                 {16, "00000000"},
                                                                                 {16, "00000080"},
                                                                                 {20, "02000000"},
                                                                                 {24, "08000000"},
                                                                                 {24, "00000000"},
                                                                                 {28, "02000000"},
                                                                                 {28, "00000000"},
                                                                                 {32, "06000000"},
                                                                                 {36, "ffffffff"}})
    says(at, four, "inconsistent header");
  for (const char* vertex : {"03000000", "ffffffff"})
    says(60, vertex, "a triangle names a vertex that is absent");
  overwrite(by_hand().substr(0, 67));
  EXPECT_EQ(message_of_reading(),
            path_.string() + ": truncated within its header: it ends at byte 67 of 68");
  overwrite(by_hand().substr(0, 47));
  EXPECT_EQ(message_of_reading(),
            path_.string() + ": truncated within its header: it ends at byte 47 of 48");
  overwrite(by_hand().substr(0, 111));
  EXPECT_EQ(message_of_reading(),
            path_.string() +
                ": a trajectory without a whole frame: it ends at byte 111, the first "
                "frame would end at byte 112");
}

TEST_F(TrajectoryTest, WhyItCannotBeWrittenIsSaid) {
  const auto why = [](const char* path) -> std::string {
    try {
      TrajectoryWriter(path, {.scene = "hang", .solver = "xpbd", .vertices = 3});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why("/dev/full"), "/dev/full: cannot write the trajectory: No space left on device");
  const std::string absent = why("/dev/null/absent");
  EXPECT_TRUE(absent.starts_with("/dev/null/absent: cannot write the trajectory: ")) << absent;
}

TEST_F(TrajectoryTest, TimesDoNotGoBack) {
  const auto times = [&](const std::vector<double>& all) {
    TrajectoryWriter writer(path_, header());
    for (const double t : all) writer.append(t, state(1));
    return message_of_reading();
  };
  const std::string why = " is at no time, or at an earlier one than the frame before it";
  EXPECT_EQ(times({-1, 0, 0, 2}), "no error");
  EXPECT_EQ(times({0, 2, 1}), path_.string() + ": frame 2" + why);
  EXPECT_EQ(times({std::numeric_limits<double>::infinity()}), path_.string() + ": frame 0" + why);
}

TEST_F(TrajectoryTest, OnlyATailThatIsDroppedIsSaid) {
  write(header(), 3);
  const auto whole = fs::file_size(path_);
  const auto said = [&] {
    std::ostringstream text;
    std::streambuf* const before = std::cerr.rdbuf(text.rdbuf());
    EXPECT_EQ(message_of_reading(), "no error");
    std::cerr.rdbuf(before);
    return text.str();
  };
  EXPECT_EQ(said(), "");
  fs::resize_file(path_, whole - 1);
  const auto frame = 8 + 3 * 3 * 4;
  EXPECT_EQ(said(), path_.string() + ": the writer was interrupted; dropped the last " +
                        std::to_string(frame - 1) + " bytes, an unfinished frame from byte " +
                        std::to_string(whole - frame) + " on, after 2 whole ones\n");
}

}  // namespace
}  // namespace taut::trajectory_test
