#include "experiments/history/history.hpp"

#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "experiments/history/history_answer.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut {

namespace {

/// Store whose builds have these stretches of one case each; NaN: planned but not run.
class Histories : public testing::Test {
 protected:
  void build(const std::string& id, double stretch, Status status = {}) {
    const std::string key = std::string(63, '0') + static_cast<char>('a' + count_);
    const Build one{id, "2026-05-0" + std::to_string(++count_)};
    if (stretch == stretch) {
      Record record = synthetic::record("hang", "a", 4, 0.01);
      record.key = key;
      record.status = status;
      record.values = {{"stretch.rms", stretch}, {"stretch.max", 1}};
      store_.commit(record);
    }
    note_ran(store_, "s", one, "hang a", key);
  }
  History history(double relative = 1e-6) {
    return history_of(store_, "s", Tolerances({{"default", {0, relative, false, "close"}}}));
  }

  Scratch scratch_;
  Store store_{scratch_.path()};
  int count_ = 0;
};

TEST_F(Histories, AStepIsBeyondTheToleranceOfTheBuildBefore) {
  for (const auto& [id, stretch] : {std::pair{"one", 0.021},
                                    {"two", 0.021},
                                    {"three", 0.026},
                                    {"four", 0.02600001},
                                    {"five", 0.026}})
    build(id, stretch);
  const History found = history(1e-4);
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "three");
  EXPECT_EQ(found.builds[found.steps[0].before].id, "two");
  EXPECT_EQ(found.compared, 4U);
  EXPECT_FALSE(found.last_stepped());
  EXPECT_EQ(stepped_values(found)[0].sentence,
            "stretch.rms of hang a rose from 2.1 to 2.6 % at three (2026-05-03)");
  EXPECT_EQ(history(1e-9).steps.size(), 3U) << "every digit counts";
}

TEST_F(Histories, ABuildWithoutAResultIsAGap) {
  build("one", 0.02);
  build("two", std::nan(""));
  build("three", 0.03);
  const History found = history();
  EXPECT_EQ(found.missing(1), 1U);
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.steps[0].before, 0U);
  EXPECT_TRUE(found.last_stepped());
  EXPECT_NE(stepped_values(found)[0].sentence.find("or at one of 1 builds before it"),
            std::string::npos);
}

TEST_F(Histories, ACaseThatFailsStepsInItsStatusAlone) {
  build("one", 0.02);
  build("two", 0.5, {Status::Kind::exploded, Reason::energy, 3});
  const History found = history();
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.steps[0].value, "status");
  EXPECT_EQ(found.steps[0].text, "ok to exploded (energy)");
}

TEST_F(Histories, OnlyTheBuildsThatAreAskedForAreLookedAt) {
  build("one", 0.02);
  build("two", 0.03);
  build("three", 0.04);
  const auto builds = builds_of(store_, "s");
  const History found = history_of(store_, "s", {}, {builds[0], builds[2]});
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "three");
}

TEST_F(Histories, ACostStepsBeyondIntervalAndControl) {
  build("one", 0.02);
  build("two", 0.02);
  build("three", 0.02);
  const auto timed = [&](const char* before, const char* now, double ratio, double noise) {
    note_ratio(store_, "s",
               {"hang a", before, now, "here", "cpu", ratio * 0.99, ratio, ratio * 1.01, 1 - noise,
                1, 1 + noise});
  };
  timed("one", "two", 2.1, 0.01);
  timed("two", "three", 1.2, 0.4);
  timed("two", "gone", 3, 0.01);
  timed("one", "three", 2.1, 0.01);  // the bisection skipped "two", which lies in between
  const History found = history();
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "two");
  EXPECT_EQ(stepped_values(found)[0].sentence,
            "CPU time of hang a rose to 2.1 (2.08 to 2.12) times what it was at two (2026-05-02)");
}

TEST(Builds, ANameMayHaveATime) {
  EXPECT_EQ(build_named("1.2.0@2026-05-04").made, "2026-05-04");
  EXPECT_EQ(build_named("1.2.0@2026-05-04T10:11:12Z").id, "1.2.0");
  EXPECT_EQ(build_named("a").made.size(), std::string("2026-05-04T10:11:12Z").size());
  for (const char* wrong : {"", "@2026-01-01", "a b", "a,b", "a@now", "a@2026-1-1", "it's"})
    EXPECT_THROW(build_named(wrong), InputError) << wrong;
}

}  // namespace

}  // namespace taut
