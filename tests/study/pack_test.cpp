// Pack files: whole entries or none, whatever was cut off, damaged or written twice.
#include <gtest/gtest.h>

#include <fstream>

#include "experiments/case/record_io.hpp"
#include "experiments/study/session.hpp"
#include "experiments/study/store.hpp"
#include "experiments/system/files.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::pack_test {
namespace {

namespace fs = std::filesystem;

Record record_of(int number, double value = 1) {
  Record record = synthetic::iterations("hang").front();
  record.key = std::string(60, 'a') + std::to_string(1000 + number);
  record.id = "case " + std::to_string(number);
  record.values = {{"a", value}};
  record.status = {};
  return record;
}

class PackTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(root_); }
  Store packing(const std::string& name, std::size_t batch = 0) {
    Store store = reading();
    store.pack_into(name, batch);
    return store;
  }
  Store reading() {
    return Store(root_, [this](const std::string& text) { said_.push_back(text); });
  }
  static Store::Commit put(Store& store, const Record& record) {
    return store.commit(EntryParts{{"series.csv", "step,t\n0,0\n1,\n"}}, record);
  }
  fs::path pack(const std::string& name) const { return root_ / "packs" / (name + ".pack"); }
  fs::path root_ = fs::path(testing::TempDir()) / unique_suffix();
  std::vector<std::string> said_;
};

TEST_F(PackTest, EntriesAreThereAfterTheirCommit) {
  Store store = packing("one");
  for (int i = 0; i < 5; ++i) EXPECT_EQ(put(store, record_of(i)), Store::Commit::stored);
  const Store other = reading();
  EXPECT_EQ(other.keys().size(), 5u);
  EXPECT_EQ(to_json(*other.find(record_of(3).key)), to_json(record_of(3)));
  EXPECT_EQ(other.series(record_of(3).key).rows.size(), 2u);
  EXPECT_EQ(other.parts(record_of(3).key).size(), 2u);
  EXPECT_FALSE(fs::exists(root_ / "store")) << "one file, no folders";
}

TEST_F(PackTest, TheDigestIsThatOfTheSameEntriesInFolders) {
  Store store = packing("one");
  const fs::path loose_root = root_ / "loose";
  const Store loose(loose_root);
  loose.prepare();
  for (int i = 0; i < 3; ++i) {
    put(store, record_of(i));
    loose.commit(loose.stage(record_of(i).key), record_of(i));
  }
  EXPECT_EQ(store.digest(), loose.digest());
  EXPECT_EQ(reading().digest(), loose.digest());
}

TEST_F(PackTest, OfAnEntryThatWasCutOffNothingIsSeen) {
  Store store = packing("one");
  put(store, record_of(0));
  const auto whole = fs::file_size(pack("one"));
  put(store, record_of(1));
  const auto both = fs::file_size(pack("one"));
  for (auto size = both - 1; size >= whole; size -= std::min<std::uintmax_t>(97, size)) {
    fs::resize_file(pack("one"), size);
    EXPECT_EQ(reading().keys(), std::vector{record_of(0).key}) << size;
    EXPECT_FALSE(reading().find(record_of(1).key));
  }
  EXPECT_TRUE(said_.empty()) << "a killed process is no damage";
  Store again = packing("two");
  EXPECT_EQ(put(again, record_of(1)), Store::Commit::stored);
  EXPECT_EQ(reading().keys().size(), 2u);
}

TEST_F(PackTest, DamageIsSaidAndCostsOneEntry) {
  Store store = packing("one");
  put(store, record_of(0)), put(store, record_of(1));
  std::string text;
  std::getline(std::ifstream(pack("one")), text, '\0');
  const std::size_t at = text.find("\"a\": 1");
  ASSERT_NE(at, std::string::npos);
  text[at + 5] = '2';
  std::ofstream(pack("one")) << text;
  EXPECT_FALSE(reading().find(record_of(0).key));
  EXPECT_TRUE(reading().find(record_of(1).key));
  ASSERT_FALSE(said_.empty());
  EXPECT_NE(said_.back().find("corrupt entry at byte 0 (case.json does not match its digest)"),
            std::string::npos)
      << said_.back();
}

TEST_F(PackTest, AResultIsNeverReplacedAndAFailureGivesWay) {
  Record failure = record_of(0);
  failure.status = {Status::Kind::timeout, "wall time", 5, -1};
  Store first = packing("one");
  EXPECT_EQ(put(first, failure), Store::Commit::stored);
  Store second = packing("two");
  EXPECT_EQ(put(second, record_of(0)), Store::Commit::stored);
  EXPECT_EQ(reading().find(failure.key)->status.kind, Status::Kind::ok);
  Store third = packing("three");
  EXPECT_EQ(put(third, failure), Store::Commit::same);
  EXPECT_EQ(put(third, record_of(0)), Store::Commit::same);
  EXPECT_EQ(put(third, record_of(0, 2)), Store::Commit::conflict);
  EXPECT_EQ(reading().conflicts(), std::vector{failure.key});
  EXPECT_FALSE(fs::exists(pack("three"))) << "nothing was new";
}

TEST_F(PackTest, AResultInAPackGoesBeforeAFailureInAFolderUnlessItIsDamaged) {
  Record failure = record_of(0);
  failure.status = {Status::Kind::timeout, "wall time", 5, -1};
  const Store loose = reading();
  loose.prepare();
  EXPECT_EQ(loose.commit(loose.stage(failure.key), failure), Store::Commit::stored);
  Store store = packing("one");
  EXPECT_EQ(put(store, record_of(0)), Store::Commit::stored);
  EXPECT_EQ(reading().find(failure.key)->status.kind, Status::Kind::ok);
  EXPECT_EQ(reading().series(failure.key).rows.size(), 2u) << "of the same entry";
  EXPECT_EQ(reading().parts(failure.key).size(), 2u);
  std::string text = read_text(pack("one"));
  text[text.find("\"a\": 1") + 5] = '2';
  std::ofstream(pack("one")) << text;
  EXPECT_EQ(reading().find(failure.key)->status.kind, Status::Kind::timeout);
  EXPECT_EQ(said_.size(), 1u) << "the damage, once";
}

TEST_F(PackTest, TwoThatDidNotSeeEachOtherAreCountedOnce) {
  Store a = packing("a"), b = packing("b");
  put(a, record_of(0)), put(b, record_of(0));
  EXPECT_EQ(reading().keys().size(), 1u);
  EXPECT_TRUE(reading().conflicts().empty());
  Store c = packing("c"), d = packing("d");
  put(c, record_of(1)), put(d, record_of(1, 2));
  EXPECT_EQ(reading().conflicts(), std::vector{record_of(1).key});
}

TEST_F(PackTest, ABatchIsWrittenAtItsEnd) {
  Store store = packing("one", 1 << 20);
  for (int i = 0; i < 5; ++i) put(store, record_of(i));
  EXPECT_FALSE(fs::exists(pack("one")));
  store.flush();
  EXPECT_EQ(reading().keys().size(), 5u);
  EXPECT_EQ(store.digest(), reading().digest());
}

TEST_F(PackTest, AMarkOfMissingCasesHoldsUntilTheyCome) {
  mark_missing(root_, "study", {{record_of(0).key, "zero"}, {record_of(1).key, "one"}});
  Store store = packing("one");
  put(store, record_of(0));
  const auto missing = still_missing(store);
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0].sentence(),
            "merged although 2 planned cases were missing; 1 still are: one");
  put(store, record_of(1));
  EXPECT_TRUE(still_missing(store).empty());
}

}  // namespace
}  // namespace taut::pack_test
