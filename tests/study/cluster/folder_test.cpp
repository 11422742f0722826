// A cluster folder as its files have it: the manifest, how far the shards are, and what a merge
// makes of them.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "tests/study/cluster/speaking.hpp"
#include "tests/support/damaged_results.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::cluster::folder_test {
namespace {

namespace fs = std::filesystem;
using Kind = Status::Kind;
using Strings = std::vector<std::string>;

std::string key(int number) { return std::string(60, 'a') + std::to_string(1000 + number); }

/// Case `n` of a shard each.
Manifest manifest_of(const std::vector<int>& shards) {
  Manifest manifest{"study", "small", "build", "", 1, {7.5, 123456}, 99, {}};
  for (std::size_t n = 0; n < shards.size(); ++n) {
    const std::string number = std::to_string(n);
    manifest.cases.push_back({key(static_cast<int>(n)),
                              "case " + number,
                              {"scenes/1/a.toml", {"time.dt=0." + number}, "xpbd"},
                              shards[n],
                              1e8 * static_cast<double>(n)});
    manifest.shards = std::max(manifest.shards, shards[n]);
  }
  return manifest;
}

class Folder : public testing::Test {
 protected:
  Folder() { setenv("TAUT_CLUSTER_PATIENCE", "1", 1); }
  ~Folder() override { unsetenv("TAUT_CLUSTER_PATIENCE"); }
  fs::path make(const std::string& name, Manifest manifest) const {
    make_folder(root_.path() / name);
    write_file(root_.path() / name / "manifest.jsonl", manifest_text(manifest));
    return root_.path() / name;
  }
  /// Keeps a record of case `n` in the store.
  static void put(const fs::path& store, int n, double value = 1, Kind kind = Kind::ok) {
    Record record = synthetic::iterations("hang").front();
    record.key = key(n), record.id = "case " + std::to_string(n);
    record.values = {{"a", value}}, record.status = {kind, "", -1, -1};
    Store(store).commit(record, {.series = "{\"step\":[" + std::to_string(n) + "]}"});
  }
  const Scratch root_;
};

TEST_F(Folder, AManifestIsReadAsItWasWritten) {
  const fs::path folder = make("c", manifest_of({1, 3, 2}));
  const Manifest is = read_manifest(folder);
  EXPECT_EQ(is.study + " " + is.preset + " " + is.build, "study small build");
  EXPECT_EQ(is.shards, 3);
  EXPECT_EQ(is.limits.seconds, 7.5);
  EXPECT_EQ(is.limits.bytes, 123456u);
  EXPECT_EQ(is.case_memory, 99u);
  ASSERT_EQ(is.cases.size(), 3u);
  EXPECT_EQ(is.cases[1].key, key(1));
  EXPECT_EQ(is.cases[1].id, "case 1");
  EXPECT_EQ(is.cases[1].spec.scene + is.cases[1].spec.solver, "scenes/1/a.tomlxpbd");
  EXPECT_EQ(is.cases[1].spec.overrides, Strings{"time.dt=0.1"});
  EXPECT_EQ(is.cases[1].shard, 3);
  EXPECT_EQ(is.cases[1].work, 1e8);
  const std::string text = read_text(folder / "manifest.jsonl");
  EXPECT_EQ(is.digest, sha256(text.substr(text.find('\n') + 1)));
  EXPECT_NEAR(is.seconds_of(3), 0.1 + 1.5, 1e-12) << "a tenth to start, 15 ns for each visit";
  EXPECT_EQ(is.seconds_of(4), 0);
  EXPECT_EQ(shard_folder("c", 7), fs::path("c/shards/0007"));
  EXPECT_EQ(shard_folder("c", 1000), fs::path("c/shards/1000"));
  const auto refused = [&](std::string from, const std::string& to) -> std::string {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    write_file(folder / "manifest.jsonl", changed);
    try {
      read_manifest(folder);
    } catch (const InputError& error) {
      return std::string(error.what()).substr((folder / "manifest.jsonl").string().size());
    }
    return "";
  };
  EXPECT_EQ(refused("case 2", "case 3"),
            ": its cases do not match its digest: it was changed or cut");
  EXPECT_TRUE(refused("\"schema\":1", "\"schema\":2").starts_with(":1: "));
  EXPECT_TRUE(refused("\"shards\":3", "\"shards\":0").starts_with(":1: shards: "));
  EXPECT_TRUE(refused("\"shards\":3", "\"shards\":1001").starts_with(":1: shards: "));
  EXPECT_TRUE(refused("\"shards\":3", "\"shards\":2").starts_with(":3: shard: "))
      << "the second case is of the third shard";
}

// 64 MB for the program, 2 kB for each vertex and link of the largest case.
TEST_F(Folder, APlanHasTheCasesOfTheStudyAndTheMemoryOfTheLargest) {
  Study study;
  study.name = "s", study.preset = "p";
  study.scenes = {"hang"}, study.solvers = {"xpbd", "jakobsen:iterations=2"};
  study.axes = {{"cloth.grid", {"[4, 4]", "[9, 5]", "[3, 3]"}}};
  const Manifest is = plan(study, {3, 4}, root_.path() / "c");
  EXPECT_EQ(is.study + is.preset, "sp");
  EXPECT_EQ(is.build, program_digest());
  EXPECT_EQ(is.limits.seconds, 3);
  EXPECT_EQ(is.limits.bytes, 4u);
  const std::size_t links = 8 * 5 + 9 * 4 + 2 * 8 * 4;
  EXPECT_EQ(is.case_memory, (std::size_t{64} << 20) + 2048 * (45 + links));
  const std::vector<Case> cases = taut::cases_of(study);
  ASSERT_EQ(is.cases.size(), 6u);
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_EQ(is.cases[n].key, cases[n].key);
    EXPECT_EQ(is.cases[n].id, cases[n].id);
    EXPECT_EQ(is.cases[n].work, estimated_work(cases[n]));
    EXPECT_EQ(is.cases[n].spec.scene, "hang") << "a shipped scene is no file of the folder";
  }
  EXPECT_FALSE(fs::exists(root_.path() / "c"));
}

// The five states of a shard, by what its sessions say and its store holds.
TEST_F(Folder, ItsStatusIsThatOfEveryShard) {
  const Manifest manifest = manifest_of({1, 2, 2, 3, 3, 4, 5, 6});
  const fs::path folder = make("c", manifest);
  const auto said = [&](int shard, const std::string& state) {
    const fs::path start = make_start(shard_folder(folder, shard), "one");
    append(start, beat_line(state) + "\n");
    return start;
  };
  said(1, "ended"), put(shard_folder(folder, 1), 0);
  put(shard_folder(folder, 2), 1);
  said(3, "running"), put(shard_folder(folder, 3), 3);
  said(4, "ended");
  said(6, "claiming"), put(shard_folder(folder, 6), 7, 1, Kind::crash);
  const FolderStatus is = [&] {
    const Speaking slow(said(2, "running"), beat_line("running", 10, 2.5));
    const Speaking quick(said(6, "running"), beat_line("running", 10, 5));
    return status_of(manifest, folder);
  }();
  std::string states;
  for (const ShardStatus& one : is.shards)
    states += std::to_string(one.shard) + " " + std::string(to_string(one.state)) + " " +
              std::to_string(one.done) + "/" + std::to_string(one.cases) + " " + one.host + "\n";
  EXPECT_EQ(states,
            "1 done 1/1 \n2 running 1/2 zeus\n3 lost 1/2 zeus\n4 stopped 0/1 \n5 waiting 0/1 \n"
            "6 running 1/1 zeus\n");
  EXPECT_EQ(is.to_start(), (std::vector{3, 4, 5}));
  EXPECT_EQ(is.cases, 8u);
  EXPECT_EQ(is.done, 4u);
  EXPECT_FALSE(is.complete());
  ASSERT_EQ(is.failed.size(), 1u);
  EXPECT_EQ(std::to_string(is.failed[0].shard) + is.failed[0].id, "6case 7");
  EXPECT_EQ(is.failed[0].status.kind, Kind::crash);
  EXPECT_NEAR(*is.shards[1].seconds, 9, 1e-12) << "a quarter took 3 s";
  EXPECT_NEAR(*is.seconds(), 9, 1e-12) << "the longest";
  EXPECT_FALSE(is.shards[2].seconds);
  EXPECT_FALSE(FolderStatus{}.seconds());
  EXPECT_TRUE(FolderStatus{}.complete());
}

TEST_F(Folder, AMergeTakesResultsBeforeFailuresAndSaysWhatIsMissing) {
  const fs::path folder = make("c", manifest_of({1, 1, 2, 2, 2}));
  put(shard_folder(folder, 1), 0, 1, Kind::timeout), put(shard_folder(folder, 1), 1, 1, Kind::oom);
  put(shard_folder(folder, 2), 0, 5), put(shard_folder(folder, 2), 2, 6);
  Store(shard_folder(folder, 2)).begin_session("mine");
  Store into(root_.path() / "m");
  const Merge merge({folder});
  const MergePlan plan = merge.look(into);
  EXPECT_TRUE(plan.mergeable());
  EXPECT_EQ(plan.missing.at(0).study, "study");
  EXPECT_EQ(plan.cases.size(), 5u);
  ASSERT_EQ(plan.missing.size(), 2u);
  EXPECT_EQ(plan.missing[0].id + std::to_string(plan.missing[0].shard), "case 32");
  EXPECT_EQ(plan.missing[1].shards, 2);
  EXPECT_FALSE(fs::exists(into.root())) << "looking changes nothing";
  std::vector<std::pair<std::size_t, std::size_t>> told;
  merge.copy(plan, into, [&](std::size_t done, std::size_t all) { told.emplace_back(done, all); });
  EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{2, 3}, {3, 3}}));
  const Store merged(root_.path() / "m");
  EXPECT_EQ(merged.keys(), (Strings{key(0), key(1), key(2)}));
  EXPECT_EQ(merged.find(key(0))->values.at("a"), 5);
  EXPECT_EQ(merged.find(key(1))->status.kind, Kind::oom) << "a failure is better than nothing";
  EXPECT_EQ(merged.series(key(2)).rows.size(), 1u);
  Database file(merged.file(), Database::Access::read);
  EXPECT_EQ(file.number_of("SELECT count(*) FROM sessions WHERE command = 'mine'"), 1);
  put(shard_folder(folder, 2), 3);
  const MergePlan more = Merge({folder}).look(merged);
  ASSERT_EQ(more.missing.size(), 1u);
  EXPECT_EQ(more.missing[0].id, "case 4");
}

TEST_F(Folder, AMergeNamesWhatDiffersAndWhatOneFolderAloneHas) {
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
  const fs::path a = make("a", manifest_of({1, 1})), b = make("b", manifest_of({1, 1, 1})),
                 c = make("c", manifest_of({1, 1}));
  const fs::path nothing = root_.path() / "nothing";
  put(shard_folder(a, 1), 0, 1), put(shard_folder(c, 1), 0, 2);
  put(shard_folder(c, 1), 1, 1, Kind::crash), put(shard_folder(a, 1), 1, 3);
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
  try {
    Merge({root_.path()});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              root_.path().string() +
                  ": neither a cluster folder (no 'manifest.jsonl' in it) nor "
                  "results (no 'results.db')");
  }
  // Results folders of `taut run --shard` know their studies.
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
