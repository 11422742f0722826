// What moved, by scene and value.
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "experiments/baseline/baseline.hpp"

namespace taut::roll_up_test {
namespace {

Change moved(const char* scene, const char* value, double before, double now) {
  Change c;
  c.id = scene, c.scene = scene, c.value = value, c.before = before, c.now = now;
  return c;
}

TEST(RollUp, TheLargestChangeOfEveryValueIsNamedAndTheLargestIsFirst) {
  Comparison comparison;
  comparison.findings = {moved("hang", "stretch.rms", 0.01, 0.0101),
                         moved("hang", "stretch.rms", 0.01, 0.0098),
                         moved("ball", "penetration.max", 0.001, 0.002)};
  for (int i = 0; i < 2; ++i)
    comparison.findings.push_back(
        {Change::Kind::status_changed, "hang", "", "status ok -> crash", "hang", "status"});
  comparison.findings.push_back({Change::Kind::case_new, "new", "", "is new"});
  const auto all = roll_up(comparison);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].value, "status") << "a failure is no smaller than any change of a value";
  EXPECT_EQ(all[0].cases, 2u);
  EXPECT_EQ(text(all[0], ""), "status ok -> crash");
  EXPECT_EQ(all[1].value, "penetration.max");
  EXPECT_EQ(text(all[1], "m"), "+100 % (0.001 -> 0.002 m)");
  EXPECT_EQ(all[2].cases, 2u);
  EXPECT_EQ(std::pair(all[2].less, all[2].more), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(text(all[2], "1"), "-2 % (0.01 -> 0.0098)");
}

TEST(RollUp, FromNothingIsWorseThanAnyPerCent) {
  Comparison comparison;
  comparison.findings = {moved("hang", "a", 1, 5), moved("hang", "b", 0, 1e-9),
                         moved("hang", "c", 1, std::numeric_limits<double>::quiet_NaN())};
  const auto all = roll_up(comparison);
  EXPECT_EQ(all[0].value, "b");
  EXPECT_EQ(all[1].value, "c");
  EXPECT_EQ(text(all[1], "1"), "1 -> nan");
  EXPECT_EQ(all[2].value, "a");
}

}  // namespace
}  // namespace taut::roll_up_test
