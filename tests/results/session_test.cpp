// Shards, and what a session leaves: the cases that each machine ran, progress, and missing cases.
#include "experiments/results/session.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/model/input_error.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/damaged_results.hpp"

namespace taut::session_test {
namespace {

namespace fs = std::filesystem;

std::string key(const std::string& begin) { return begin + std::string(64 - begin.size(), 'f'); }

TEST(Shards, AreWhatIsAskedForOrWhatSlurmSays) {
  const auto both = [](const std::string& text) {
    const Shard shard = Shard::parse(text);
    return std::pair(shard.index, shard.count);
  };
  EXPECT_EQ(both("1/1"), std::pair(1, 1));
  EXPECT_EQ(both("2/7"), std::pair(2, 7));
  EXPECT_EQ(both("7/7"), std::pair(7, 7));
  for (const char* wrong : {"0/4", "5/4", "1/0", "-1/4", "1", "1/", "/4", "1-4", "1/4x", "one/4"})
    EXPECT_THROW(Shard::parse(wrong), InputError) << wrong;
  EXPECT_EQ(both(""), std::pair(1, 1));
  setenv("SLURM_ARRAY_TASK_ID", "7", 1);
  setenv("SLURM_ARRAY_TASK_MIN", "5", 1);
  setenv("SLURM_ARRAY_TASK_COUNT", "4", 1);
  EXPECT_EQ(both(""), std::pair(3, 4));
  EXPECT_EQ(both("1/2"), std::pair(1, 2)) << "said otherwise";
  unsetenv("SLURM_ARRAY_TASK_MIN");
  EXPECT_THROW(Shard::parse(""), InputError) << "the seventh of four";
  setenv("SLURM_ARRAY_TASK_ID", "2", 1);
  EXPECT_EQ(both(""), std::pair(2, 4)) << "from 1 on";
  unsetenv("SLURM_ARRAY_TASK_ID");
  unsetenv("SLURM_ARRAY_TASK_COUNT");
}

TEST(Shards, OfACaseFollowFromTheFirstEightDigitsOfItsKey) {
  const std::pair<const char*, int> remainder[] = {
      {"00000000", 0}, {"0000000a", 2}, {"0000000b", 3}, {"ffffffff", 3}, {"10000000", 0}};
  for (const auto& [begin, rest] : remainder)
    for (int index = 1; index <= 4; ++index)
      EXPECT_EQ((Shard{index, 4}.has(key(begin))), index == rest + 1) << begin;
  EXPECT_TRUE(Shard{}.has(key("12345678")));
}

/// Planned cases that are never run.
StudyCases planned(const std::string& study, std::initializer_list<const char*> keys) {
  StudyCases all{study, {}};
  const Case one = make_case({"hang", {"cloth.grid=[2, 2]"}, "jakobsen"});
  for (const char* begin : keys) {
    all.cases.push_back(one);
    all.cases.back().key = key(begin);
    all.cases.back().id = "case " + std::string(begin);
  }
  return all;
}

TEST(Sessions, LeaveWhoRanWhat) {
  const Scratch scratch;
  Store store(scratch.path() / "results");
  store.begin_session("taut run x", {planned("x", {"00000003", "00000004"})}, {2, 3});
  Database file(store.file(), Database::Access::read);
  Database::Rows row = file.rows(
      "SELECT command, host, toolchain, shard, shards, cases, started, session FROM sessions");
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.text(0), "taut run x");
  EXPECT_EQ(row.text(1), host_name());
  EXPECT_EQ(row.text(2), toolchain());
  EXPECT_EQ((std::tuple{row.integer(3), row.integer(4), row.integer(5)}), (std::tuple{2, 3, 2}));
  EXPECT_LE(row.text(6), utc_stamp());
  EXPECT_TRUE(row.text(7).starts_with(row.text(6).substr(0, 13)));
  EXPECT_FALSE(row.next());
}

TEST(Sessions, WhatTheyPlanIsThereOnceWithItsShard) {
  const Scratch scratch;
  Store store(scratch.path());
  EXPECT_TRUE(store.planned().empty());
  store.begin_session("", {planned("a", {"3", "1"}), planned("b", {"1"})}, {1, 4});
  store.begin_session("", {planned("a", {"2", "1"})}, {2, 4});
  std::string all;
  for (const PlannedKey& one : store.planned())
    all += one.study + " " + one.id + " " + std::to_string(one.shard) + "/" +
           std::to_string(one.shards) + ", ";
  // The last plan of a study counts: another build has other keys.
  EXPECT_EQ(all, "a case 1 " + std::to_string(Shard::of(key("1"), 4)) + "/4, a case 2 " +
                     std::to_string(Shard::of(key("2"), 4)) + "/4, ");
  store.begin_session("", {planned("", {"5"})});
  Database file(store.file(), Database::Access::read);
  EXPECT_EQ(file.number_of("SELECT count(*) FROM planned"), 3) << "study by study";
}

TEST(Sessions, AShardBeyondAnIntIsRefused) {
  const Scratch scratch;
  Store store(scratch.path());
  for (const char* damage : {"shard = 4294967297", "shards = 0", "shard = 'one'"}) {
    store.begin_session("", {planned("a", {"1"})}, {1, 4});
    change(store, std::string("UPDATE planned SET ") + damage);
    const std::string column = damage[5] == 's' ? "shards" : "shard";
    try {
      store.planned();
      ADD_FAILURE() << damage;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), store.file().string() + ": plan of case 1: " + column +
                                               ": expected a whole number from 1 to 2147483647");
    }
  }
}

TEST(MissingCases, AreNamedAsFarAsThereIsRoom) {
  Missing mark{"m", {}, 31};
  for (int n = 1; n <= 10; ++n) mark.ids.push_back(std::to_string(n));
  EXPECT_EQ(mark.sentence(),
            "m: merged although 31 planned cases were missing; 10 still are: 1, 2, 3, 4, 5, 6, 7, "
            "8, 9, 10");
  mark.ids.emplace_back("11");
  EXPECT_EQ(mark.sentence(),
            "m: merged although 31 planned cases were missing; 11 still are: 1, 2, 3, 4, 5, 6, 7, "
            "8, 9, 10, ...");
}

TEST(MissingCases, AreCountedStudyByStudyUntilTheyCome) {
  const Scratch scratch;
  Store store(scratch.path());
  EXPECT_TRUE(store.still_missing().empty());
  store.begin_session("", {planned("b", {"1", "2", "3", "5"})});
  store.mark_missing({{"b", key("1"), "one"}, {"b", key("2"), "two"}, {"b", key("3"), "three"}});
  store.mark_missing({{"a", key("4"), "four"}});
  auto marks = store.still_missing();
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].study, "a");
  EXPECT_EQ(marks[0].cases, 1u);
  EXPECT_EQ(marks[1].cases, 3u);
  EXPECT_EQ(marks[1].ids, (std::vector<std::string>{"case 1", "case 2", "case 3"}));
  Record record = unfinished(make_case({"hang", {"cloth.grid=[2, 2]"}, "jakobsen"}), {});
  record.key = key("4");
  store.commit(record);
  record.key = key("2");
  store.commit(record);
  marks = store.still_missing();
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0].ids, (std::vector<std::string>{"case 1", "case 3"}));
}

}  // namespace
}  // namespace taut::session_test
