// Files are complete or absent, temporary names are unique, and shipped data are found.
#include "experiments/system/files.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <ctime>
#include <regex>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/process.hpp"
#include "tests/support/environment.hpp"

namespace taut::files_test {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

template <class Do>
std::string refused(const Do& what) {
  try {
    what();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WrittenFiles, ReplaceTheOldOneAndLeaveNothingBeside) {
  const Scratch scratch;
  const fs::path file = scratch.path() / "a";
  for (const auto write : {write_file, write_durably}) {
    for (const std::string text : {"one\n", "", "longer than it was before"}) {
      write(file, text);
      EXPECT_EQ(read_text(file), text);
    }
    const mode_t mask = umask(0);
    umask(mask);
    EXPECT_EQ(static_cast<mode_t>(fs::status(file).permissions()), 0666 & ~mask);
    EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"a"});
    fs::remove(file);
  }
  const fs::path nowhere = scratch.path() / "none/a";
  EXPECT_EQ(refused([&] { write_file(nowhere, "x"); }),
            nowhere.string() + ": cannot write: No such file or directory");
  fs::create_directory(scratch.path() / "folder");
  EXPECT_NE(refused([&] { write_file(scratch.path() / "folder", "x"); }), "");
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"folder"});
}

TEST(WrittenFiles, ALinkStaysOneAndAPipeIsWrittenTo) {
  const Scratch scratch;
  write_file(scratch.path() / "target", "old");
  fs::create_symlink("target", scratch.path() / "link");
  write_durably(scratch.path() / "link", "new");
  EXPECT_TRUE(fs::is_symlink(scratch.path() / "link"));
  EXPECT_EQ(read_text(scratch.path() / "target"), "new");
  const fs::path pipe = scratch.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int end = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  write_file(pipe, "into it");
  char got[16] = {};
  EXPECT_EQ(read(end, got, sizeof got), 7);
  EXPECT_STREQ(got, "into it");
  close(end);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(WrittenFiles, GrowByLines) {
  const Scratch scratch;
  const fs::path file = scratch.path() / "a";
  append(file, "one\n");
  append(file, "two\n");
  append(file, "\n");
  append(file, "three\n");
  EXPECT_EQ(read_text(file), "one\ntwo\n\nthree\n");
  EXPECT_EQ(refused([&] { append(file / "b", "x"); }),
            (file / "b").string() + ": cannot write: Not a directory");
  EXPECT_EQ(refused([&] { make_folder(file / "b"); }),
            (file / "b").string() + ": cannot create: Not a directory");
  make_folder(scratch.path() / "b/c");
  make_folder(scratch.path() / "b/c");
  EXPECT_TRUE(fs::is_directory(scratch.path() / "b/c"));
  test_writable(scratch.path() / "d/e");
  EXPECT_TRUE(fs::is_empty(scratch.path() / "d"));
}

TEST(Scratches, AreBelowTmpdirAndGoWithAllThatIsInThem) {
  const Scratch outer;
  fs::path inner;
  {
    const Environment there("TMPDIR", outer.path().c_str());
    const Scratch one, another;
    inner = one.path();
    EXPECT_EQ(inner.parent_path(), outer.path());
    EXPECT_NE(inner, another.path());
    make_folder(inner / "a/b");
    write_file(inner / "a/b/c", "x");
    EXPECT_EQ(fs::status(inner).permissions(), fs::perms::owner_all);
  }
  EXPECT_TRUE(fs::is_empty(outer.path()));
  const Environment nowhere("TMPDIR", "/no/such/folder");
  EXPECT_EQ(Scratch().path().parent_path(), "/tmp");
}

TEST(Scratches, OfKilledProcessesAreRemovedByTheNext) {
  const std::string program = TAUT_BINARY_DIR "/taut";
  if (!fs::exists(program)) GTEST_SKIP() << "this build has the tests alone";
  const Scratch outer;
  const auto old = [&](const std::string& name) {
    const fs::path folder = outer.path() / name;
    make_folder(folder);
    write_file(folder / "x", "x");
    const timespec times[] = {{1000000000, 0}, {1000000000, 0}};
    utimensat(AT_FDCWD, folder.c_str(), times, 0);
    return folder;
  };
  const fs::path left = old("taut.aB3xYz"), held = old("taut.held00"),
                 other = old("taut-of-others"), longer = old("taut.somebodys"),
                 young = outer.path() / "taut.young0";
  make_folder(young);
  const int lock = open(held.c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(lock, LOCK_SH), 0);
  {
    const Environment there("TMPDIR", outer.path().c_str());
    Process({program, "external", "probe", "true"}).wait();
  }
  EXPECT_FALSE(fs::exists(left));
  for (const fs::path& stays : {held, other, longer, young})
    EXPECT_TRUE(fs::exists(stays)) << stays;
  close(lock);
}

TEST(Names, AreThoseOfTheHostTheProcessAndTheTime) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  EXPECT_EQ(host_name(), host);
  const std::string one = unique_suffix(),
                    begin = std::string(host) + "." + std::to_string(getpid()) + ".";
  EXPECT_TRUE(one.starts_with(begin)) << one;
  EXPECT_TRUE(std::regex_match(one.substr(begin.size()), std::regex("[0-9a-f]{8}"))) << one;
  EXPECT_NE(one, unique_suffix());
  const auto stamp = [](std::time_t t) {
    char text[32];
    std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", std::gmtime(&t));
    return std::string(text);
  };
  const std::string before = stamp(std::time(nullptr)), now = utc_stamp(),
                    after = stamp(std::time(nullptr));
  EXPECT_LE(before, now);
  EXPECT_LE(now, after);
}

TEST(ShippedData, AreFoundByNameAndFilesByPath) {
  const Scratch scratch;
  const fs::path data = scratch.path() / "data";
  for (const char* name :
       {"scenes/b.toml", "scenes/a.toml", "scenes/c.obj", "scenes/more/d.toml", "studies/s.toml"}) {
    make_folder((data / name).parent_path());
    write_file(data / name, "");
  }
  const Environment there("TAUT_DATA", data.c_str());
  EXPECT_EQ(data_folder(), data);
  EXPECT_EQ(shipped("scenes"), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(shipped("nothing").empty());
  EXPECT_EQ(find_scene("a"), data / "scenes/a.toml");
  EXPECT_EQ(find_scene("more/d"), data / "scenes/more/d.toml");
  EXPECT_EQ(find_study("s"), data / "studies/s.toml");
  EXPECT_EQ(find_scene((data / "studies/s.toml").string()), data / "studies/s.toml");
  const std::string from = ", seen from " + std::filesystem::current_path().string();
  EXPECT_EQ(refused([] { find_scene("more/../a"); }), "more/../a: no such scene file" + from);
  EXPECT_EQ(refused([] { find_study("none.toml"); }), "none.toml: no such study file" + from);
  EXPECT_EQ(refused([&] { find_scene((data / "scenes").string()); }),
            (data / "scenes").string() + " is a folder, not a scene file");
  EXPECT_EQ(refused([] { find_scene("aa"); }),
            "unknown scene 'aa'; did you mean 'a'? (`taut list scenes` names all; a path has a '/' "
            "or ends in .toml)");
  EXPECT_EQ(refused([] { find_scene("a:cloth.span=0.7"); }),
            "unknown scene 'a:cloth.span=0.7'; settings of a scene stand alone: a --set "
            "cloth.span=0.7");
  EXPECT_EQ(refused([] { find_study("s:x"); }),
            "unknown study 's:x'; did you mean 's'? (`taut list studies` names all; a path has a "
            "'/' or ends in .toml)");
  EXPECT_EQ(references_folder(), scratch.path() / "results/references") << "beside the tree";
  make_folder(data / "references");
  EXPECT_EQ(references_folder(), data / "references") << "installed";
  const Environment wrong("TAUT_DATA", (data / "scenes/a.toml").c_str());
  EXPECT_EQ(refused([] { data_folder(); }),
            "TAUT_DATA is '" + (data / "scenes/a.toml").string() + "', which is no folder");
}

TEST(ShippedData, AreThoseOfTheTreeOrOfTheEnvironment) {
  const Environment none("TAUT_DATA", "");
  EXPECT_TRUE(fs::equivalent(data_folder(), fs::path(TAUT_SOURCE_DIR) / "experiments"));
  {
    const Environment unset("TAUT_RESULTS", nullptr);
    EXPECT_EQ(results_folder(), "results");
    const Environment empty("TAUT_RESULTS", "");
    EXPECT_EQ(results_folder(), "results");
  }
  const Environment given("TAUT_RESULTS", "/else/where");
  EXPECT_EQ(results_folder(), "/else/where");
  EXPECT_EQ(this_program().filename(), "taut_tests");
  EXPECT_EQ(sibling_program(""), this_program());
  EXPECT_EQ(sibling_program("taut"), this_program().parent_path() / "taut");
}

}  // namespace
}  // namespace taut::files_test
