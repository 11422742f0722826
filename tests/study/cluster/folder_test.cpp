// Cluster folders: planned shards, resources requested by job scripts, progress, and merging.
#include <gtest/gtest.h>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/damaged_results.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::cluster::folder_test {
namespace {

namespace fs = std::filesystem;
using Kind = Status::Kind;
using Strings = std::vector<std::string>;

std::string key(int number) { return std::string(60, 'a') + std::to_string(1000 + number); }

class Folder : public testing::Test {
 protected:
  /// Creates a folder with one planned shard per entry; entry `n` is its case.
  fs::path make(const std::string& name, const std::vector<int>& shards) const {
    const fs::path folder = root_.path() / name;
    make_folder(folder / "shards");
    write_file(folder / "job.sh", "#!/bin/bash\n");
    Store store(folder);
    store.begin_session("taut cluster submit");
    for (std::size_t n = 0; n < shards.size(); ++n)
      change(store, "INSERT INTO planned VALUES ('study', ?, ?, ?, 6, 0)", key(static_cast<int>(n)),
             "case " + std::to_string(n), shards[n]);
    return folder;
  }
  /// Stores a record of case `n`.
  static void put(const fs::path& store, int n, double value = 1, Kind kind = Kind::ok) {
    Record record = synthetic::iterations("hang").front();
    record.key = key(n);
    record.id = "case " + std::to_string(n);
    record.values = {{"a", value}};
    record.status = {kind, "", -1, -1};
    Store(store).commit(record, {.series = "{\"step\":[" + std::to_string(n) + "]}"});
  }
  const Scratch root_;
};

/// Message of the InputError that `work` throws; "" if it throws none.
template <class Work>
std::string refused(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The program needs 64 MB plus 2 kB for each vertex and link of the largest case. It takes a tenth
// of a second to start and 15 ns per visit.
TEST_F(Folder, APlanAsksForWhatItsLargestShardNeeds) {
  EXPECT_EQ(estimated_seconds(0), 0.1);
  EXPECT_NEAR(estimated_seconds(1e9), 15.1, 1e-9);
  Study study;
  study.name = "s";
  study.preset = "p";
  study.scenes = {"hang"};
  study.solvers = {"xpbd", "jakobsen:iterations=2"};
  study.axes = {{"cloth.grid", {"[4, 4]", "[9, 5]", "[3, 3]"}}};
  const std::vector<Case> cases = taut::cases_of(study);
  const Plan is = plan(study, cases, {60, 400 << 20}, 2, 1);
  EXPECT_EQ(is.study + is.preset, "sp");
  EXPECT_EQ(is.cases, 6u);
  const std::size_t links = 8 * 5 + 9 * 4 + 2 * 8 * 4;
  EXPECT_EQ(is.case_memory, (std::size_t{64} << 20) + 2048 * (45 + links));
  double seconds[2] = {0, 0};
  for (const Case& one : cases)
    seconds[Shard::of(one.key, 2) - 1] += estimated_seconds(estimated_work(one));
  EXPECT_EQ(is.longest, std::max(seconds[0], seconds[1]));
  EXPECT_EQ(plan(study, cases, {60, 0}, 0, 24).shards, 1) << "as few as end in time";
  EXPECT_EQ(refused([&] {
              plan(study, cases, {60, 0}, 7, 1);
            }),
            "--shards 7: the study has only 6 cases");
  EXPECT_EQ(refused([&] {
              plan(study, cases, {60, 0}, 0, 0.1);
            }),
            "--hours 0.1: a single case may take 5 minutes (--timeout makes that less)");
  EXPECT_EQ(refused([&] { plan(study, {}, {60, 0}, 1, 1); }), "this study has no case");
}

TEST(JobScript, AsksForTimeAndMemoryOfAShard) {
  const Plan plan{"study", "small", 8, {120, std::size_t{4096} << 20}, 90, 1200, 100 << 20};
  EXPECT_EQ(shard_minutes(plan), 51) << "2 x 20 + 10 + 1";
  const std::string text = job_script(plan, Scheduler::slurm),
                    run = "run ./study.toml --preset small -j 1 --timeout 120 --memory 4096";
  EXPECT_TRUE(text.starts_with("#!/bin/bash\n#SBATCH --job-name=taut-study\n")) << text;
  for (const std::string& part : {std::string("--array=1-8\n"), std::string("--time=51\n"),
                                  std::string("--mem=292M\n"), run, std::string("$shard/8")})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  const std::string other = job_script(plan, Scheduler::parallel);
  EXPECT_NE(other.find("set -- {1..8}"), std::string::npos);
  EXPECT_NE(other.find("program " + program_digest().substr(0, 10)), std::string::npos);
  EXPECT_EQ((text + other).find("@"), text.find("USR1@60") + 4) << "every mark is filled";
  Plan odd = plan;
  odd.study = "a@RUN@b@SHARDS@@BUILD@";  // placeholders inside a value must not be replaced
  EXPECT_NE(job_script(odd, Scheduler::parallel).find("run ./a@RUN@b@SHARDS@@BUILD@.toml "),
            std::string::npos);
  EXPECT_EQ(std::ranges::count(readme(plan, Scheduler::slurm), '\n'), 5);
  EXPECT_TRUE(readme(plan, Scheduler::parallel)
                  .starts_with("Study study --preset small: 90 cases in 8 shards"));
}

TEST_F(Folder, ItsStatusIsThatOfEveryShard) {
  const fs::path folder = make("c", {1, 2, 2, 3, 4});
  put(shard_folder(folder, 1), 0);
  put(shard_folder(folder, 2), 1);
  Store(shard_folder(folder, 2)).begin_session("mine");
  put(shard_folder(folder, 4), 4, 1, Kind::crash);
  const Answer is = status_of(folder);
  const Table& shards = is.table("shards");
  std::string states;
  for (const auto& row : shards.rows)
    states += number_text(row[0].number()) + " " + row[1].text() + " " +
              number_text(row[3].number()) + "/" + number_text(row[2].number()) + "\n";
  EXPECT_EQ(states, "2 begun 1/2\n3 waiting 0/1\n1 done 1/1\n4 done 1/1\n");
  EXPECT_EQ(shards.at(shards.rows[0], "host").text(), host_name());
  EXPECT_EQ(is.fact("cases").number(), 5);
  EXPECT_EQ(is.fact("done").number(), 3);
  EXPECT_EQ(is.fact("start").text(), "cd " + folder.string() + " && ./job.sh 2 3");
  EXPECT_EQ(is.fact("again").text(),
            "export ONLY=failed; cd " + folder.string() + " && ./job.sh 4");
  ASSERT_EQ(is.table("failed").rows.size(), 1u);
  EXPECT_EQ(is.table("failed").rows[0][1].text(), "case 4");
  // A folder of an earlier taut, without the file `scheduler`.
  write_file(folder / "job.sh", "#!/bin/bash\n#SBATCH\n");
  EXPECT_TRUE(status_of(folder).fact("start").text().ends_with("sbatch --array=2,3 job.sh"));
  EXPECT_EQ(refused([&] { status_of(root_.path()); }),
            root_.path().string() + ": not a folder of `taut cluster submit`");
}

// A folder's shards are started by the scheduler that it was written for, whatever its script
// contains.
TEST_F(Folder, RemembersItsScheduler) {
  Study study;
  study.name = "s";
  study.scenes = {"hang"};
  study.solvers = {"jakobsen:iterations=2"};
  study.file = root_.path() / "s.toml";
  write_file(study.file, "");
  for (const Scheduler on : {Scheduler::slurm, Scheduler::parallel}) {
    const fs::path folder = root_.path() / to_string(on);
    write_folder(folder, {.study = study, .limits = {60, 0}, .shards = 1, .on = on});
    const std::string start = "cd " + folder.string() + " && " +
                              (on == Scheduler::slurm ? "sbatch --array=1 job.sh" : "./job.sh 1");
    for (const char* script : {"#!/bin/bash\n", "#!/bin/bash\n#SBATCH\n"}) {
      write_file(folder / "job.sh", script);
      EXPECT_EQ(status_of(folder).fact("start").text(), start) << script;
    }
    EXPECT_EQ(scheduler_named(to_string(on)), on);
  }
  EXPECT_FALSE(scheduler_named("pbs"));
  write_file(root_.path() / "slurm/scheduler", "pbs\n");
  EXPECT_EQ(refused([&] { status_of(root_.path() / "slurm"); }),
            (root_.path() / "slurm/scheduler").string() + ": unknown scheduler 'pbs'");
}

TEST_F(Folder, AMergeTakesResultsBeforeFailures) {
  const fs::path folder = make("c", {1, 1, 2, 2, 2});
  put(shard_folder(folder, 1), 0, 1, Kind::timeout);
  put(shard_folder(folder, 1), 1, 1, Kind::oom);
  put(shard_folder(folder, 2), 0, 5);
  put(shard_folder(folder, 2), 2, 6);
  Store(shard_folder(folder, 2)).begin_session("mine");
  Store into(root_.path() / "m");
  const Merge merge({folder});
  const MergePlan plan = merge.look(into);
  EXPECT_TRUE(plan.mergeable());
  EXPECT_EQ(plan.missing.at(0).study, "study");
  EXPECT_EQ(plan.cases.size(), 5u);
  ASSERT_EQ(plan.missing.size(), 2u);
  EXPECT_EQ(plan.missing[0].id + std::to_string(plan.missing[0].shard), "case 32");
  EXPECT_FALSE(fs::exists(into.root())) << "looking changes nothing";
  std::size_t told = 0;
  merge.copy(plan, into, [&](std::size_t done, std::size_t all) {
    EXPECT_GE(done, told);
    told = done;
    EXPECT_EQ(all, 3u);
  });
  EXPECT_EQ(told, 3u);
  Store merged(root_.path() / "m");
  EXPECT_EQ(merged.keys(), (Strings{key(1), key(0), key(2)})) << "as they were merged";
  EXPECT_EQ(merged.find(key(0))->values.at("a"), 5);
  EXPECT_EQ(merged.find(key(1))->status.kind, Kind::oom) << "a failure is better than nothing";
  EXPECT_EQ(merged.series(key(2)).rows.size(), 1u);
  Database file(merged.file(), Database::Access::read);
  EXPECT_EQ(file.number_of("SELECT count(*) FROM sessions WHERE command = 'mine'"), 1);
  EXPECT_EQ(file.number_of("SELECT count(*) FROM planned"), 5);
  put(shard_folder(folder, 2), 3);
  const MergePlan more = Merge({folder}).look(merged);
  ASSERT_EQ(more.missing.size(), 1u);
  EXPECT_EQ(more.missing[0].id, "case 4");
}

// A case failed in one folder and ran in two others: those two results are compared for every order
// of merging.
TEST_F(Folder, AFailureDoesNotHideThatTwoResultsDiffer) {
  const fs::path folders[] = {make("a", {1}), make("b", {1}), make("c", {1})};
  put(shard_folder(folders[0], 1), 0, 0, Kind::timeout);
  put(shard_folder(folders[1], 1), 0, 1);
  put(shard_folder(folders[2], 1), 0, 2);
  std::vector<fs::path> order(std::begin(folders), std::end(folders));
  do {
    const MergePlan plan = Merge(order).look(Store(root_.path() / "into"));
    ASSERT_EQ(plan.conflicts.size(), 1u);
    EXPECT_TRUE(plan.conflicts[0].ends_with("have different results")) << plan.conflicts[0];
  } while (std::ranges::next_permutation(order).found);
}

TEST_F(Folder, AMergeNamesConflictsAndWhatOneSideLacks) {
  const auto sentences = [&](const std::vector<fs::path>& folders, const fs::path& into) {
    const MergePlan plan = Merge(folders).look(Store(into));
    std::string all;
    for (const auto* list : {&plan.conflicts, &plan.foreign})
      for (const std::string& one : *list) {
        std::string text = one;
        for (auto at = text.find(root_.path()); at != text.npos; at = text.find(root_.path()))
          text.erase(at, root_.path().string().size() + 1);
        all += text + "\n";
      }
    EXPECT_EQ(plan.mergeable(), all.empty());
    return all;
  };
  const fs::path a = make("a", {1, 1}), b = make("b", {1, 1, 1}), c = make("c", {1, 1});
  const fs::path nothing = root_.path() / "nothing";
  put(shard_folder(a, 1), 0, 1);
  put(shard_folder(c, 1), 0, 2);
  put(shard_folder(c, 1), 1, 1, Kind::crash);
  put(shard_folder(a, 1), 1, 3);
  EXPECT_EQ(sentences({a}, nothing), "");
  EXPECT_EQ(sentences({a, c}, nothing),
            "case 0: a/shards/0001 and c/shards/0001 have different results\n");
  EXPECT_EQ(sentences({a}, shard_folder(c, 1)),
            "case 0: a/shards/0001 and c/shards/0001 have different results\n");
  EXPECT_EQ(sentences({a, b}, nothing),
            "case 2: planned by b, not by a (another study or build)\n");
  EXPECT_EQ(sentences({b, a}, nothing),
            "case 2: planned by b, not by a (another study or build)\n");
  put(shard_folder(a, 1), 9);
  EXPECT_EQ(sentences({a}, nothing),
            "case 9: in a/shards/0001, but not planned (another study or build)\n");
  EXPECT_EQ(refused([&] { Merge({root_.path()}); }),
            root_.path().string() + ": has no 'results.db'");
  // Results folders of `taut run --shard` contain their studies.
  const fs::path results = root_.path() / "r";
  put(results, 0);
  EXPECT_EQ(sentences({results}, nothing),
            "case 0: in r, but not planned (another study or build)\n");
  Case planned = make_case({"hang", {"cloth.grid=[2, 2]"}, "jakobsen"});
  planned.key = key(0);
  Store(results).begin_session("", {{"mine", {planned}}});
  const MergePlan found = Merge({results}).look(Store(nothing));
  ASSERT_EQ(found.cases.size(), 1u);
  EXPECT_EQ(found.cases[0].study, "mine");
  EXPECT_TRUE(found.mergeable() && found.missing.empty());
}

}  // namespace
}  // namespace taut::cluster::folder_test
