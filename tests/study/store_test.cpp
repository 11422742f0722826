// The store: whole entries or none, results that nothing replaces, texts that keep every bit.
#include "experiments/study/store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <csignal>
#include <limits>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/files.hpp"

namespace taut::store_test {
namespace {

namespace fs = std::filesystem;

Record some_record() {
  Record r;
  r.key = std::string(63, 'a') + "7";
  r.id = "hang jakobsen:iterations=8";
  r.spec = {"hang", {"time.dt=\"1/60\""}, "jakobsen:iterations=8"};
  r.scene = "hang";
  r.solver = "jakobsen";
  r.params = {{"iterations", "8"}};
  r.dt = 1.0 / 60;
  r.steps = 600;
  r.vertices = 400;
  r.links = 760;
  r.status = {Status::Kind::exploded, "energy", 17, 3};
  r.values = {{"a", 0.1 + 0.2},
              {"b", std::numeric_limits<double>::quiet_NaN()},
              {"c", std::numeric_limits<double>::denorm_min()},
              {"d", -1.7976931348623157e308}};
  r.projections = 6080;
  r.step_cost = {{"structural", 760, 8, 12160, true}};
  r.resolved_settings = {{"time step", "1/60 s"}};
  r.digest = "beef";
  return r;
}

class StoreTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(root_); }
  Store::Commit put(const Record& record) {
    store_.prepare();
    return store_.commit(store_.stage(record.key), record);
  }
  /// Adds to the last digit of the entry, a part of its record.
  void damage(const std::string& key) {
    std::string text = read_text(store_.file(key));
    text[text.find_last_of("0123456789")] ^= 1;
    write_file(store_.file(key), text);
  }
  fs::path root_ = fs::path(testing::TempDir()) / unique_suffix();
  std::vector<std::string> said_;
  Store store_{root_, [this](const std::string& text) { said_.push_back(text); }};
};

TEST(RecordText, KeepsEveryBit) {
  const Record r = some_record(), back = record_from_json(to_json(r), "test");
  EXPECT_EQ(to_json(back), to_json(r));
  EXPECT_EQ(back.values.at("a"), 0.1 + 0.2);
  EXPECT_TRUE(std::isnan(back.values.at("b")));
  EXPECT_EQ(back.values.at("c"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(back.values.at("d"), -1.7976931348623157e308);
  EXPECT_EQ(back.status.kind, Status::Kind::exploded);
  EXPECT_EQ(back.status.step, 17);
  EXPECT_EQ(back.step_cost[0].bytes, 12160u);
}

TEST(RecordText, RefusesOtherSchemasAndNonsense) {
  std::string text = to_json(some_record());
  text.replace(text.find("\"schema\":1"), 10, "\"schema\":2");
  EXPECT_THROW(record_from_json(text, "x"), InputError);
  EXPECT_THROW(record_from_json("{}", "x"), InputError);
  EXPECT_THROW(record_from_json("[1", "x"), InputError);
}

TEST(RecordText, SeriesKeepGapsAndBits) {
  const Series series{{"step", "y"}, {{0, 1e-300}, {1, std::nan("")}, {2, 0.1}}};
  const Series back = series_from_csv(to_csv(series));
  EXPECT_EQ(back.columns, series.columns);
  ASSERT_EQ(back.rows.size(), 3u);
  EXPECT_EQ(back.rows[0], series.rows[0]);
  EXPECT_TRUE(std::isnan(back.rows[1][1]));
  EXPECT_EQ(back.rows[2], series.rows[2]);
}

TEST(RecordText, TheResultIsNotHowItWasCalled) {
  Record a = some_record(), b = a;
  b.id = "another", b.spec.scene = "./copy.toml", b.scene = "copy";
  EXPECT_EQ(result_digest(a), result_digest(b));
  b.values["a"] = std::nextafter(b.values["a"], 1);
  EXPECT_NE(result_digest(a), result_digest(b));
}

TEST_F(StoreTest, AnEntryIsThereAfterItsCommit) {
  const Record r = some_record();
  EXPECT_FALSE(store_.find(r.key));
  EXPECT_EQ(put(r), Store::Commit::stored);
  ASSERT_TRUE(store_.find(r.key));
  EXPECT_EQ(to_json(*store_.find(r.key)), to_json(r));
  EXPECT_EQ(store_.keys(), std::vector<std::string>{r.key});
  EXPECT_TRUE(fs::is_empty(root_ / "tmp"));
}

TEST_F(StoreTest, AResultIsNeverReplaced) {
  Record r = some_record();
  put(r);
  const std::string digest = store_.digest();
  EXPECT_EQ(put(r), Store::Commit::same);
  r.values["a"] = 7;
  EXPECT_EQ(put(r), Store::Commit::conflict);
  EXPECT_EQ(store_.digest(), digest);
  EXPECT_FALSE(fs::is_empty(root_ / "conflicts"));
  r.status = {Status::Kind::timeout, "wall time", 5, -1};
  EXPECT_EQ(put(r), Store::Commit::same) << "a failure says nothing against a result";
  EXPECT_EQ(store_.digest(), digest);
}

TEST_F(StoreTest, AFailureGivesWayToAResult) {
  Record failure = some_record();
  failure.status = {Status::Kind::timeout, "wall time", 5, -1};
  put(failure);
  const std::string nothing = store_.digest();
  EXPECT_EQ(put(some_record()), Store::Commit::stored);
  EXPECT_EQ(store_.find(failure.key)->status.kind, Status::Kind::exploded);
  EXPECT_NE(store_.digest(), nothing) << "failures do not count, results do";
  EXPECT_TRUE(fs::is_empty(root_ / "tmp"));
}

TEST_F(StoreTest, ADamagedEntryIsSetAsideAndSaidSo) {
  const Record r = some_record();
  put(r);
  damage(r.key);
  EXPECT_FALSE(store_.find(r.key));
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("corrupt entry (case.json does not match its digest)"),
            std::string::npos);
  EXPECT_EQ(put(r), Store::Commit::stored);
}

TEST_F(StoreTest, WhereNoFileCanBeMadeIsSaidBeforeACaseRuns) {
  fs::create_directories(root_ / "store");
  fs::create_directory_symlink("/proc/self", root_ / "tmp");  // there, and nobody can write in it
  EXPECT_THROW(store_.prepare(), InputError);
}

TEST_F(StoreTest, WhoLosesTheRenameLooksAgain) {
  const Record r = some_record();
  put(r);
  damage(r.key);
  // The notice of the damaged entry comes between this commit's look and its rename.
  Store::Commit others = Store::Commit::conflict;
  const Store racing(root_, [&](const std::string&) {
    const Store other(root_);
    others = other.commit(other.stage(r.key), r);
  });
  EXPECT_EQ(racing.commit(racing.stage(r.key), r), Store::Commit::same);
  EXPECT_EQ(others, Store::Commit::stored);
  EXPECT_EQ(to_json(*store_.find(r.key)), to_json(r));
  EXPECT_TRUE(fs::is_empty(root_ / "tmp"));
}

TEST_F(StoreTest, WhoIsKilledWhileWritingLeavesSomethingInTmpAlone) {
  Record failure = some_record(), other = some_record(), framed = some_record(), conflict;
  failure.key[0] = 'b', failure.status = {Status::Kind::timeout, "wall time", 5, -1};
  other.key = failure.key;
  conflict = framed;
  conflict.values["a"] = 7;
  put(failure), put(framed);
  const std::vector<std::pair<EntryParts, Record>> all{
      {{}, other}, {{{kFramesFile, "a motion"}}, framed}, {{}, conflict}};
  for (const auto& [parts, record] : all) {
    const pid_t child = fork();
    if (child == 0) {  // ends by a signal within the write, which is larger than a file may be
      const rlimit no_core{0, 0}, ten{10, 10};
      setrlimit(RLIMIT_CORE, &no_core);
      setrlimit(RLIMIT_FSIZE, &ten);
      std::signal(SIGXFSZ, SIG_DFL);
      store_.commit(parts, record);
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_FALSE(fs::is_empty(root_ / "tmp"));
    EXPECT_EQ(store_.keys().size(), 2u);
    EXPECT_TRUE(store_.conflicts().empty());
    store_.prepare();
    EXPECT_TRUE(fs::is_empty(root_ / "tmp")) << "the next one cleans up";
  }
  EXPECT_TRUE(said_.empty());
}

TEST_F(StoreTest, OfResultsThatComeAtOnceOneStaysAndTheOthersAreConflicts) {
  constexpr int kRounds = 40, kWriters = 3;
  store_.prepare();
  for (int round = 0; round < kRounds; ++round) {
    Record failure = some_record();
    failure.key = std::string(60, 'a') + std::to_string(1000 + round);
    failure.status = {Status::Kind::timeout, "wall time", 5, -1};
    put(failure);
    std::barrier begin(kWriters);
    std::vector<std::thread> writers;
    for (int i = 0; i < kWriters; ++i)
      writers.emplace_back([&, i] {
        Record record = some_record();
        record.key = failure.key;
        record.values["a"] = i;
        const Store own(root_);
        begin.arrive_and_wait();
        own.commit(EntryParts{}, record);
      });
    for (std::thread& writer : writers) writer.join();
    ASSERT_TRUE(store_.find(failure.key)->status.is_result());
    ASSERT_EQ(std::ranges::count(store_.conflicts(), failure.key), kWriters - 1);
    ASSERT_TRUE(fs::is_empty(root_ / "tmp"));
  }
}

TEST_F(StoreTest, EntriesOfAnEarlierTautAreRefusedToReadersAndSetAsideByWriters) {
  const std::string key = some_record().key;
  fs::create_directories(store_.file(key));
  write_file(store_.file(key) / "case.json", "{}");
  EXPECT_THROW(store_.keys(), InputError);
  EXPECT_EQ(put(some_record()), Store::Commit::stored);
  EXPECT_EQ(store_.keys(), std::vector{key});
  EXPECT_EQ(read_text(root_ / "store.earlier" / key.substr(0, 2) / key / "case.json"), "{}");
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("set aside"), std::string::npos) << said_[0];
  store_.prepare();
  EXPECT_EQ(said_.size(), 1u) << "once";
}

TEST_F(StoreTest, ReadingCreatesNothing) {
  EXPECT_FALSE(store_.find(some_record().key));
  EXPECT_TRUE(store_.keys().empty());
  EXPECT_FALSE(fs::exists(root_));
}

}  // namespace
}  // namespace taut::store_test
