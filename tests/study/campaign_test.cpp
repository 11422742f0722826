// Expected work of a case: the number of items that its steps visit.
#include "experiments/study/campaign.hpp"

#include <gtest/gtest.h>

namespace taut::campaign_test {
namespace {

double work(const std::string& solver, const SceneSettings& more = {}) {
  SceneSettings settings{"cloth.grid=[9, 9]", "time.duration=1"};
  settings.insert(settings.end(), more.begin(), more.end());
  return estimated_work(make_case({"hang", settings, solver}));
}

TEST(EstimatedWork, GrowsByTheLinksOfEverySweepAndWithTheSteps) {
  const double links = 2 * 9 * 8 + 2 * 8 * 8;  // structural and shear
  const Case one = make_case({"hang", {"cloth.grid=[9, 9]", "time.duration=1"}, "jakobsen"});
  ASSERT_EQ(static_cast<double>(one.scene->links.size()), links);
  const double sweep =
      work("jakobsen:iterations=2,substeps=1") - work("jakobsen:iterations=1,substeps=1");
  EXPECT_EQ(sweep, one.scene->steps * links);
  EXPECT_EQ(work("jakobsen:iterations=6,substeps=1") - work("jakobsen:iterations=1,substeps=1"),
            5 * sweep);
  EXPECT_EQ(work("jakobsen:iterations=3,substeps=4"), work("jakobsen:iterations=12,substeps=1"));
  EXPECT_EQ(work("jakobsen:iterations=0,substeps=1"), work("jakobsen:iterations=1,substeps=1"));
  EXPECT_EQ(work("jakobsen", {"time.duration=2"}), 2 * work("jakobsen"));
  EXPECT_GT(work("jakobsen:iterations=1,substeps=1"), sweep) << "vertices count, too";
  EXPECT_LT(work("jakobsen", {"cloth.grid=[9, 9]"}), work("jakobsen", {"cloth.grid=[10, 9]"}));
}

}  // namespace
}  // namespace taut::campaign_test
