// Files of positions: written positions are read back up to the format's rounding, and a malicious
// file only causes a message with its place.
#include "core/io/positions/positions.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "tests/support/bytes.hpp"

namespace taut::positions_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormats[] = {"a.npy", "a.pc2", "a.obj"};

class Positions : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("taut_positions_" + std::to_string(getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static constexpr std::size_t kVertices = 6;
  static constexpr int kFrames = 4;
  static std::vector<Vec3> frame(int k) {
    std::vector<Vec3> x;
    for (std::size_t i = 0; i < kVertices; ++i)
      x.emplace_back(1.0 / 3 + k, -1e-7 * static_cast<double>(i), std::pow(10, k) / 7);
    return x;
  }
  fs::path written(const char* name) const {
    const Mesh mesh = make_sheet({.nu = 2, .nv = 3, .width = 1, .height = 1, .mass = 1});
    const auto writer = create_positions(folder_ / name, mesh);
    for (int k = 0; k < kFrames; ++k) writer->append(k / 64.0, frame(k));
    return folder_ / name;
  }
  fs::path file(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  static std::vector<std::vector<Vec3>> all_of(const fs::path& path) {
    const auto reader = open_positions(path);
    std::vector<std::vector<Vec3>> all;
    for (int k = 0; k < reader->header().frames; ++k) all.push_back(reader->read(k));
    return all;
  }
  static std::string message(const fs::path& path) {
    try {
      all_of(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  fs::path folder_;
};

TEST_F(Positions, ComeBackToTheRoundingOfTheFormat) {
  for (const std::string name : kFormats) {
    const fs::path path = written(name.c_str());
    const auto reader = open_positions(path);
    const PositionsHeader& header = reader->header();
    EXPECT_EQ(header.vertices, static_cast<int>(kVertices)) << name;
    ASSERT_EQ(header.frames, kFrames) << name;
    const bool single = name == "a.pc2";
    EXPECT_EQ(header.rounding, single            ? Rounding::binary32
                               : name == "a.obj" ? Rounding::decimal
                                                 : Rounding::binary64);
    for (const int k : {3, 0, 2, 1}) {
      const std::vector<Vec3> x = reader->read(k);
      for (std::size_t i = 0; i < kVertices; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const double exact = frame(k)[i][axis];
          const double kept = single ? static_cast<double>(static_cast<float>(exact)) : exact;
          EXPECT_EQ(x[i][axis], kept) << name << " frame " << k;
        }
    }
  }
}

TEST_F(Positions, WhatIsNotFiniteIsData) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : kFormats) {
    const auto writer = create_positions(folder_ / name, {});
    writer->append(0, {Vec3(nan, 1, -std::numeric_limits<double>::infinity())});
    const Vec3 x = all_of(folder_ / name).at(0).at(0);
    EXPECT_TRUE(std::isnan(x.x()) && x.y() == 1 &&
                x.z() == -std::numeric_limits<double>::infinity())
        << name;
  }
}

/// Every prefix of a file, and a file with any byte changed, is read or refused.
TEST_F(Positions, DamagedFilesAreRefused) {
  std::mt19937 random(7);
  for (const char* name : kFormats) {
    const fs::path path = written(name);
    const fs::path first = fs::exists(path) ? path : open_positions(path)->header().files.at(0);
    const std::string whole = read_text(first);
    int refused = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      file(first.filename(), whole.substr(0, size));
      const std::string said = message(path);
      refused += said != "no error";
      EXPECT_TRUE(path != first || said != "no error") << name << " cut at byte " << size;
      EXPECT_TRUE(said == "no error" || said.find(first.filename()) != said.npos) << said;
    }
    EXPECT_GT(refused, static_cast<int>(whole.size() / 4)) << name;
    for (int k = 0; k < 200; ++k) {
      std::string damaged = whole;
      damaged[random() % std::min<std::size_t>(whole.size(), 200)] = static_cast<char>(random());
      file(first.filename(), damaged);
      message(path);  // any message will do: no crash, no unbounded memory
    }
    file(first.filename(), whole + "x");
    EXPECT_TRUE(path != first || message(path).find("bytes") != std::string::npos) << message(path);
  }
}

std::string npy(const std::string& dictionary, std::size_t body) {
  std::string bytes("\x93NUMPY\1\0", 8);
  bytes += static_cast<char>(dictionary.size());
  bytes += '\0';
  return bytes + dictionary + std::string(body, '\0');
}

TEST_F(Positions, SayWhatIsWrongAndWhere) {
  const auto says = [&](const std::string& name, const std::string& bytes, const char* what) {
    const std::string said = message(file(name, bytes));
    EXPECT_NE(said.find(name), said.npos) << said;
    EXPECT_NE(said.find(what), said.npos) << said;
  };
  const std::string good = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2, 3), }";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(message(file("good.npy", npy(good, 48))), "no error");
  says("b.npy", npy(good, 47), "ends at byte 119, after 0 whole frames");
  says("b.npy", npy(with("<f8", "<i8"), 48), "byte 10: the type is <i8");
  says("b.npy", npy(with("False", "True"), 48), "numpy.ascontiguousarray");
  says("b.npy", npy(with("(1, 2, 3)", "(2, 3)"), 48), "[frames, vertices, 3]");
  says("b.npy", npy(with("(1, 2, 3)", "(1, 2, 4)"), 48), "[frames, vertices, 3]");
  says("b.npy", npy(with("(1, 2,", "(4294967296, 4294967296,"), 48), "1 to 2147483647 of each");
  says("b.npy", npy(with("(1, 2,", "(2147483647, 2147483647,"), 48), "ends at byte");
  says("b.npy", npy(with("(1, 2,", "(0, 2,"), 48), "0 frames of 2 vertices");
  says("b.npy", npy(with("(1, 2,", "(-1, 2,"), 48), "[frames, vertices, 3]");

  std::string pc2 = read_text(written("a.pc2"));
  says("b.pc2", "POINTCACHE1" + pc2.substr(11), "byte 0");
  says("b.pc2", std::string(pc2).replace(28, 4, "\xff\xff\xff\x7f"), "2147483647 frames of 6");
  says("b.pc2", std::string(pc2).replace(28, 4, "\xff\xff\xff\xff"), "byte 28: -1 is no number");
  says("b.pc2", std::string(pc2).replace(16, 4, std::string(4, '\0')), "byte 16: 0 is no number");
  says("b.pc2", std::string(pc2).replace(24, 4, std::string(4, '\0')), "byte 24");

  says("b.obj", "v 1 2 3\nv 1 2\n", "b.obj:2:1: a vertex needs three numbers");
  says("b.obj", "v 1 2 3\n\nv 1 2 x\n", "b.obj:3:1");
  says("b.obj", "# nothing\n", "has no vertices");
  says("b.abc", "", ".npy, .pc2 or .obj");
  EXPECT_NE(message(folder_ / "none.pc2").find("No such file"), std::string::npos);
  EXPECT_NE(message(folder_ / "none.obj").find("no such file"), std::string::npos);
}

TEST_F(Positions, BothByteOrdersAndBothWidths) {
  const std::string array =
      npy("{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1, 3), }", 0) +
      std::string("\x3f\x80\0\0\x40\0\0\0\x40\x40\0\0", 12);
  EXPECT_EQ(all_of(file("a.npy", array)).at(0).at(0), Vec3(1, 2, 3));
}

TEST_F(Positions, ASequenceHasAllItsFramesInOrder) {
  for (const int k : {8, 9, 10, 11})
    file("cloth" + std::to_string(k) + ".obj", "v " + std::to_string(k) + " 0 0\n");
  file("cloth_rest.obj", "v 0 0 0\nv 0 0 0\n");  // does not belong to the sequence
  for (const char* name : {"cloth.obj", "cloth9.obj"}) {
    const auto all = all_of(folder_ / name);
    ASSERT_EQ(all.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(all[k].at(0).x(), 8 + static_cast<double>(k));
  }
  file("cloth011.obj", "v 0 0 0\n");
  EXPECT_NE(message(folder_ / "cloth.obj").find("is the same frame as"), std::string::npos);
  fs::remove(folder_ / "cloth011.obj");
  fs::remove(folder_ / "cloth10.obj");
  EXPECT_NE(message(folder_ / "cloth.obj")
                .find("cloth11.obj: the frame before it is missing: "
                      "number 10"),
            std::string::npos);
  file("cloth10.obj", "v 0 0 0\nv 0 0 0\n");
  EXPECT_NE(message(folder_ / "cloth.obj").find("cloth10.obj: has 2 vertices"), std::string::npos);
}

// A modelling program gets a sheet's material coordinates and faces, and a chain as a line.
TEST_F(Positions, ObjHoldsWhatAModellingProgramWants) {
  const auto written = [&](const SheetShape& shape) {
    const Mesh mesh = make_sheet(shape);
    create_positions(folder_ / "w.obj", mesh)->append(0.5, mesh.rest);
    return read_text(folder_ / "w_00000.obj");
  };
  const std::string sheet = written({.nu = 2, .nv = 2, .width = 1, .height = 1, .mass = 1});
  EXPECT_NE(sheet.find("# t = 0.5 s"), std::string::npos);
  EXPECT_NE(sheet.find("vt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\nf "), std::string::npos) << sheet;
  EXPECT_NE(sheet.find("f 1/1 "), std::string::npos) << sheet;
  EXPECT_EQ(sheet.find("\nl "), std::string::npos) << sheet;
  const std::string chain = written({.nu = 3, .nv = 1, .width = 1, .height = 0, .mass = 1});
  EXPECT_NE(chain.find("\nl 1 2 3\n"), std::string::npos) << chain;
  EXPECT_EQ(chain.find("vt "), std::string::npos) << chain;
}

// Two frames at 0 s and 0.5 s. The first is a face with corners at 1 2 3, 0 0 0 and 0 0 -4, the
// second is twice that.
TEST_F(Positions, AreWrittenAsTheFormatsSay) {
  Mesh mesh;
  mesh.triangles = {{0, 2, 1}};
  const std::vector<Vec3> one{{1, 2, 3}, {0, 0, 0}, {0, 0, -4}},
      two{{2, 4, 6}, {0, 0, 0}, {0, 0, -8}};
  const auto text_of = [&](const std::string& name, const std::string& first) {
    const auto writer = create_positions(folder_ / name, mesh);
    writer->append(0, one);
    writer->append(0.5, two);
    return read_text(folder_ / first);
  };
  const std::string none4(8, '0'), none8(16, '0'), little_1 = "0000803f", little_2 = "00000040",
                                                   little_3 = "00004040", little_4 = "00008040";
  const std::string floats =
      little_1 + little_2 + little_3 + none4 + none4 + none4 + none4 + none4 + "000080c0" +  // -4
      little_2 + little_4 + "0000c040" + none4 + none4 + none4 + none4 + none4 + "000000c1";
  EXPECT_EQ(text_of("f.pc2", "f.pc2"),
            std::string("POINTCACHE2\0", 12) +
                bytes("01000000 03000000 00000000 0000803f 02000000" + floats));
  const std::string doubles_1 = "000000000000f03f 0000000000000040 0000000000000840" + none8 +
                                none8 + none8 + none8 + none8 + "00000000000010c0",
                    doubles_2 = "0000000000000040 0000000000001040 0000000000001840" + none8 +
                                none8 + none8 + none8 + none8 + "00000000000020c0";
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 3), }";
  header.resize(117, ' ');
  EXPECT_EQ(text_of("f.npy", "f.npy"), bytes("93") + "NUMPY" + bytes("0100 7600") + header + "\n" +
                                           bytes(doubles_1 + doubles_2));
  text_of("f.obj", "f_00000.obj");
  EXPECT_EQ(read_text(folder_ / "f_00001.obj"),
            "# t = 0.5 s, metres\nv 2 4 6\nv 0 0 0\nv 0 0 -8\nf 1 3 2\n");
  EXPECT_FALSE(fs::exists(folder_ / "f_00002.obj"));
}

// The name of a sequence reads back what was last written under it, and no frames of other
// sequences.
TEST_F(Positions, ASequenceIsReadByTheNameThatItWasWrittenBy) {
  const Mesh mesh = make_sheet({.nu = 2, .nv = 1, .width = 1, .height = 0, .mass = 1});
  for (const int frames : {3, 2})
    for (const char* name : {"run.obj", "run2.obj", "7.obj", "run_2.obj"}) {
      const auto writer = create_positions(folder_ / name, mesh);
      for (int k = 0; k < frames; ++k) writer->append(k, {Vec3(k, frames, 0), Vec3(1, 0, 0)});
    }
  file("run20.obj", "v 0 0 0\n");
  file("run3_00000.obj", "v 0 0 0\n");
  for (const char* name : {"run2.obj", "7.obj", "run_2.obj"}) {
    const auto all = all_of(folder_ / name);
    ASSERT_EQ(all.size(), 2u) << name;
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_EQ(all[k].at(0), Vec3(static_cast<double>(k), 2, 0)) << name;
  }
}

TEST_F(Positions, ArraysOfEveryVersionAndTheirErrors) {
  std::string dictionary = "{'shape': (1, 1, 3), 'fortran_order': False,   'descr':   '<f4', }";
  dictionary.resize(70, ' ');
  const std::string body = bytes("0000803f 00000040 00004040");
  const auto array = [&](char version, const std::string& length, const std::string& all) {
    return file("v.npy", bytes("93") + "NUMPY" + version + '\0' + bytes(length) + all);
  };
  for (const char version : {'\2', '\3'})
    EXPECT_EQ(all_of(array(version, "46000000", dictionary + body)).at(0).at(0), Vec3(1, 2, 3));
  EXPECT_EQ(all_of(array('\1', "4600", dictionary + body)).at(0).at(0), Vec3(1, 2, 3));
  EXPECT_EQ(open_positions(folder_ / "v.npy")->header().rounding, Rounding::binary32);
  const auto says = [&](const fs::path& path, const std::string& what) {
    EXPECT_EQ(message(path), path.string() + ": " + what);
  };
  for (const char version : {'\0', '\4'})
    says(array(version, "46000000", dictionary + body),
         "byte 6: version " + std::to_string(int{version}) + "; known are 1 to 3");
  says(array('\2', "ffff0000", dictionary),
       "byte 8: a header of 65535 bytes, but the file has 82, or no header is so long");
  says(
      array('\1', "4600", dictionary + body.substr(4)),
      "the header says 1 frames of 1 vertices from byte 80 on, but the file ends at byte 88, after "
      "0 whole frames");
  says(array('\1', "4600", dictionary + body + "x"),
       "the header says 1 frames of 1 vertices, which end at byte 92, but the file has 93 bytes");
  says(file("v.npy", bytes("93") + "NUMPY" + bytes("0100")),
       "byte 0: an array of NumPy begins with \\x93NUMPY and its version");
}

TEST_F(Positions, PointCachesOfOtherPrograms) {
  std::string pc2 = std::string("POINTCACHE2\0", 12) +
                    bytes("01000000 01000000 00000000 00002040 02000000") + std::string(24, '\0');
  EXPECT_EQ(open_positions(file("o.pc2", pc2))->header().spacing, 2.5);
  EXPECT_EQ(open_positions(file("o.pc2", pc2))->header().frames, 2);
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_EQ(message(file("o.pc2", text)), (folder_ / "o.pc2").string() + ": " + what);
  };
  says(pc2.substr(0, 31), "ends at byte 31, within its header");
  pc2[12] = 2;
  says(pc2, "byte 12: version 2; known is 1");
  pc2[12] = 1;
  says(
      pc2.substr(0, 55),
      "the header says 2 frames of 1 vertices from byte 32 on, but the file ends at byte 55, after "
      "1 whole frames");
  pc2.replace(24, 4, bytes("000020c0"));
  says(pc2, "byte 24: a frame every -2.5 frames; expected a number above 0");
  pc2.replace(24, 4, bytes("0000807f"));
  says(pc2, "byte 24: a frame every inf frames; expected a number above 0");
}

TEST_F(Positions, FramesMayCountInStepsAndBeSetApartByASign) {
  for (const char* sign : {"", "_", ".", "-"}) {
    const std::string name = std::string("s") + sign;
    for (const char* number : {"0100", "0105", "0110"})
      file(name + number + ".obj", std::string("v ") + number + " 0 0\n");
    EXPECT_EQ(all_of(folder_ / (name + "0105.obj")).size(), 3u) << sign;
    fs::remove(folder_ / (name + "0105.obj"));
    EXPECT_EQ(all_of(folder_ / (name + "0100.obj")).size(), 2u) << "ten apart";
    EXPECT_EQ(
        message(folder_ / (name + "0105.obj")),
        (folder_ / (name + "0105.obj")).string() + ": no such file, and no frames of that name");
    for (const char* number : {"0100", "0110"}) fs::remove(folder_ / (name + number + ".obj"));
  }
  file("7.obj", "v 7 0 0\n");
  file("8.obj", "v 8 0 0\n");
  file("one.obj", "v 1 0 0\n");
  EXPECT_EQ(all_of(folder_ / "8.obj").at(0).at(0).x(), 7) << "a number is name enough";
  EXPECT_EQ(all_of(folder_ / "one.obj").size(), 1u);
}

TEST_F(Positions, WhatCannotBeWrittenSaysWhy) {
  const Mesh mesh = make_sheet({.nu = 2, .nv = 3, .width = 1, .height = 1, .mass = 1});
  const auto says = [&](const fs::path& path, const std::string& why) {
    try {
      create_positions(path, mesh)->append(0, mesh.rest);
      ADD_FAILURE() << path;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), path.string() + ": cannot be written: " + why);
    }
  };
  for (const char* name : {"a.npy", "a.pc2"}) {
    says(folder_ / "none" / name, "No such file or directory");
    if (!fs::exists("/dev/full")) continue;
    fs::create_symlink("/dev/full", folder_ / name);
    says(folder_ / name, "No space left on device");
  }
}

TEST_F(Positions, TextFilesAreReadWholeUpToTheirLimitOrRefused) {
  const std::string text(70000, 'x');
  const fs::path path = file("t", text);
  errno = EINTR;  // left by an earlier call
  EXPECT_EQ(read_text(path, 70000), text);
  const auto says = [](const fs::path& file, std::size_t most, const std::string& what) {
    try {
      read_text(file, most);
      ADD_FAILURE() << file;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), file.string() + ": " + what);
    }
  };
  says(path, 69999, "is larger than 0 MiB");
  says(file("large", std::string((3 << 20) + 1, 'x')), 3 << 20, "is larger than 3 MiB");
  says(folder_, 100, "is a folder, not a file");
  says("/dev/null", 100, "is not a regular file");
  says(folder_ / "absent", 100, "cannot be read: No such file or directory");
  if (fs::exists("/proc/self/mem")) {  // address 0 is not mapped
    says("/proc/self/mem", 100, "cannot be read: Input/output error");
  }
}

}  // namespace
}  // namespace taut::positions_test
