// How cases are shared out, and what a job script asks for.
#include <gtest/gtest.h>

#include <map>

#include "core/model/input_error.hpp"
#include "experiments/study/cluster/cluster.hpp"

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
  Manifest manifest = of_seconds(std::vector<double>(100, 359.99), 1);  // ten hours
  const int shards = shards_for(manifest, 2);
  manifest.shards = shards;
  share_out(manifest);
  EXPECT_EQ(shard_minutes(manifest), 119) << "nine cases of six minutes, twice, and ten and one";
  EXPECT_EQ(shards, 12) << "beside a case's ten minutes and one more there is room for 109 minutes";
  const auto refused = [](const Manifest& all, double hours) -> std::string {
    try {
      return std::to_string(shards_for(all, hours));
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refused(manifest, 11. / 60),
            "--hours 0.18333333333333332: a single case may take 10 minutes (--timeout makes that "
            "less)");
  EXPECT_EQ(refused(manifest, 0.25),
            "--hours 0.25: 100 shards, as many as there can be, take 23 minutes each");
  EXPECT_EQ(refused(manifest, 23. / 60), "100") << "just";
  EXPECT_EQ(refused(manifest, 1.5), "17") << "six cases each; by their sum 16 would do";
  EXPECT_EQ(refused(manifest, 1000), "1");
  const Manifest many = of_seconds(std::vector<double>(1500, 60.0), 1);
  EXPECT_EQ(refused(many, 0.2),
            "--hours 0.2: 1000 shards, as many as there can be, take 15 minutes each");
}

TEST(ShareOut, ACaseTakesATenthOfASecondAnd15NanosecondsForEachVisit) {
  EXPECT_EQ(estimated_seconds(0), 0.1);
  EXPECT_NEAR(estimated_seconds(1e9), 15.1, 1e-9);
}

TEST(JobScript, AsksForWhatTheLongestShardNeeds) {
  const Manifest manifest = of_seconds({1199, 60, 60}, 2);
  const std::string text = job_script(manifest, Scheduler::slurm);
  EXPECT_NE(text.find("--array=1-2\n"), std::string::npos);
  EXPECT_NE(text.find("--time=51\n"), std::string::npos) << "2 x 20 + 10 + 1 minutes\n" << text;
  EXPECT_NE(text.find("--mem=292M\n"), std::string::npos) << "100 MB for a case, 192 beside it";
  EXPECT_TRUE(text.starts_with("#!/bin/bash\n#SBATCH --job-name=taut-study\n")) << text;
  const std::string other = job_script(manifest, Scheduler::parallel);
  EXPECT_TRUE(other.starts_with("#!/bin/bash\n# GNU parallel: ")) << other;
  EXPECT_NE(other.find("shards=({1..2}); options"), std::string::npos);
  EXPECT_EQ(other.find("@SHARDS"), std::string::npos);
}

TEST(JobScript, AFolderSaysInFiveLinesWhatToDoWithIt) {
  Manifest manifest = of_seconds({1, 1, 1}, 2);
  manifest.build = "0123456789abcdef", manifest.preset = "small";
  EXPECT_EQ(readme(manifest, Scheduler::slurm),
            "Study study --preset small: 3 cases in 2 shards, for taut build 0123456789 (`taut "
            "--version`; $TAUT names it if it is not in the PATH).\n"
            "Start, or go on where it stopped: sbatch job.sh in this folder; a shard by hand: taut "
            "cluster run . --shard 1\n"
            "How far it is, what failed, what to start again: taut cluster status .\n"
            "All results into one store, if none is missing: taut cluster merge . --out "
            "results/runs\n"
            "manifest.jsonl: what is to run; study.toml: the study; shards/: results; log/: what "
            "the jobs said.\n");
  manifest.preset.clear();
  const std::string other = readme(manifest, Scheduler::parallel);
  EXPECT_TRUE(other.starts_with("Study study: 3 cases")) << other;
  EXPECT_NE(other.find(" stopped: ./job.sh in"), std::string::npos);
  EXPECT_TRUE(other.ends_with("joblog: GNU parallel's list of what ended.\n"));
}

}  // namespace
}  // namespace taut::cluster::share_out_test
