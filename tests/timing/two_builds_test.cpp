#include "experiments/timing/two_builds.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

constexpr Interval kQuiet{0.99, 1, 1.01}, kNoisy{0.7, 1, 1.4}, kDearer{1.9, 2, 2.1},
    kCheaper{0.45, 0.5, 0.55};

TEST(TwoBuilds, ARatioBeyondIntervalAndControlIsADifference) {
  const TwoBuilds dearer{"a", "", kDearer, kQuiet, kDearer, kQuiet};
  EXPECT_TRUE(dearer.differs());
  EXPECT_TRUE(dearer.slower());
  EXPECT_FALSE(dearer.by_wall());
  const TwoBuilds cheaper{"a", "", kCheaper, kQuiet, kCheaper, kQuiet};
  EXPECT_TRUE(cheaper.differs());
  EXPECT_FALSE(cheaper.slower());
  EXPECT_FALSE((TwoBuilds{"a", "", {1.1, 1.2, 1.3}, kNoisy, kQuiet, kNoisy}.slower()));
}

// Recorded with fifteen processes on two cores: judge() calls it "likely", but it must raise no
// alarm.
TEST(TwoBuilds, WhatIdenticalCodeDidIsNoAlarm) {
  const TwoBuilds loaded{"a", "", {0.613, 0.676, 0.866}, {0.973, 1.35, 1.43}, kQuiet, kQuiet};
  EXPECT_TRUE(is_difference(judge(loaded.cpu, loaded.cpu_control)));
  EXPECT_FALSE(loaded.differs());
}

TEST(TwoBuilds, AProgramThatWaitsIsSlowerByTheWallsClockAlone) {
  const TwoBuilds waits{"a", "", kQuiet, kQuiet, kDearer, kQuiet};
  EXPECT_TRUE(waits.by_wall());
  EXPECT_TRUE(waits.slower());
  const TwoBuilds busy{"a", "", kQuiet, kQuiet, {1.1, 1.2, 1.3}, kNoisy};
  EXPECT_FALSE(busy.slower());
  const Table table = table_of({waits}, "against", "before");
  EXPECT_EQ(table.at(table.rows[0], "verdict").text(), "dearer in wall time alone");
}

TEST(TwoBuilds, WhatWasNotTimedSaysWhyAndIsNoDifference) {
  const TwoBuilds failed{"a", "now: it died", {}, {}, {}, {}};
  EXPECT_FALSE(failed.slower());
  EXPECT_TRUE(ratios_of({failed}, "x", "y").empty());
  const Table table = table_of({failed}, "against", "before");
  EXPECT_EQ(table.at(table.rows[0], "verdict").text(), "not timed: now: it died");
}

TEST(TwoBuilds, ABuildIsAFolderOrAKeptOne) {
  const Scratch scratch;
  const auto said = [&](const std::string& build) -> std::string {
    try {
      return folder_of_build(scratch.path(), build).string();
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_NE(said("before").find("--keep-build NAME"), std::string::npos);
  for (const std::filesystem::path& looked :
       {std::filesystem::absolute("before"), scratch.path() / "builds" / "before"})
    EXPECT_NE(said("before").find(looked.string()), std::string::npos) << said("before");
  const std::filesystem::path kept = keep_build(scratch.path(), "fast");
  EXPECT_NE(said("before").find("kept"), std::string::npos);
  std::filesystem::create_directories(scratch.path() / "tree");
  std::ofstream(scratch.path() / "tree" / "taut") << "#!/bin/sh\n";
  EXPECT_NE(said((scratch.path() / "tree").string()), (scratch.path() / "tree").string())
      << "it cannot be executed";
  std::filesystem::permissions(scratch.path() / "tree" / "taut", std::filesystem::perms::owner_all);
  EXPECT_EQ(said((scratch.path() / "tree").string()), (scratch.path() / "tree").string());
  EXPECT_THROW(keep_build(scratch.path(), "a b"), InputError);
  EXPECT_EQ(kept, scratch.path() / "builds" / "fast");
}

}  // namespace

}  // namespace taut
