// How cases are shared out, and what a job script asks for.
#include <gtest/gtest.h>

#include <map>

#include "core/model/input_error.hpp"
#include "experiments/study/cluster/job_script.hpp"
#include "experiments/study/cluster/manifest.hpp"

namespace taut::cluster::share_out_test {
namespace {

Manifest of_seconds(const std::vector<double>& seconds, int shards) {
  Manifest manifest{"study", "", "build", "", shards, {}, 100 << 20, {}};
  const double start = estimated_seconds(0), pace = estimated_seconds(1e9) - start;
  for (std::size_t i = 0; i < seconds.size(); ++i)
    manifest.cases.push_back({std::string(60, 'a') + std::to_string(1000 + i),
                              "case",
                              {},
                              1,
                              (seconds[i] - start) / pace * 1e9});
  share_out(manifest);
  return manifest;
}

TEST(ShareOut, IsEvenInTime) {
  const Manifest manifest = of_seconds({60, 10, 10, 10, 10, 10, 10}, 2);
  EXPECT_NEAR(manifest.seconds_of(1), 60, 1e-6);
  EXPECT_NEAR(manifest.seconds_of(2), 60, 1e-6);
}

TEST(ShareOut, ManyAlikeDifferByOneAtMost) {
  const Manifest manifest = of_seconds(std::vector<double>(203, 1.0), 8);
  std::map<int, int> count;
  for (const PlannedCase& one : manifest.cases) ++count[one.shard];
  ASSERT_EQ(count.size(), 8u);
  for (const auto& [shard, cases] : count) EXPECT_TRUE(cases == 25 || cases == 26) << shard;
}

TEST(ShareOut, TheFewestShardsThatEndInTime) {
  Manifest manifest = of_seconds(std::vector<double>(100, 360.0), 1);  // ten hours
  const int shards = shards_for(manifest, 2);
  manifest.shards = shards;
  share_out(manifest);
  EXPECT_LE(shard_minutes(manifest), 120);
  EXPECT_LE(shards, 14);
  EXPECT_GE(shards, 11) << "twice ten hours do not fit into less, beside a case's ten minutes";
  EXPECT_THROW(shards_for(manifest, 0.15), InputError);
}

TEST(JobScript, AsksForWhatTheLongestShardNeeds) {
  const Manifest manifest = of_seconds({1199, 60, 60}, 2);
  const std::string text = job_script(manifest, Scheduler::slurm);
  EXPECT_NE(text.find("--array=1-2\n"), std::string::npos);
  EXPECT_NE(text.find("--time=51\n"), std::string::npos) << "2 x 20 + 10 + 1 minutes\n" << text;
  EXPECT_NE(text.find("--mem=292M\n"), std::string::npos) << "100 MB for a case, 192 beside it";
}

}  // namespace
}  // namespace taut::cluster::share_out_test
