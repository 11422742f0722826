// Shards, and what a session leaves: who ran what, how far it came, what is still missing.
#include "experiments/study/session.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

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
  setenv("SLURM_ARRAY_TASK_ID", "7", 1), setenv("SLURM_ARRAY_TASK_MIN", "5", 1),
      setenv("SLURM_ARRAY_TASK_COUNT", "4", 1);
  EXPECT_EQ(both(""), std::pair(3, 4));
  EXPECT_EQ(both("1/2"), std::pair(1, 2)) << "said otherwise";
  unsetenv("SLURM_ARRAY_TASK_MIN");
  EXPECT_THROW(Shard::parse(""), InputError) << "the seventh of four";
  setenv("SLURM_ARRAY_TASK_ID", "2", 1);
  EXPECT_EQ(both(""), std::pair(2, 4)) << "from 1 on";
  unsetenv("SLURM_ARRAY_TASK_ID"), unsetenv("SLURM_ARRAY_TASK_COUNT");
}

TEST(Shards, OfACaseFollowFromTheFirstEightDigitsOfItsKey) {
  const std::pair<const char*, int> remainder[] = {
      {"00000000", 0}, {"0000000a", 2}, {"0000000b", 3}, {"ffffffff", 3}, {"10000000", 0}};
  for (const auto& [begin, rest] : remainder)
    for (int index = 1; index <= 4; ++index)
      EXPECT_EQ((Shard{index, 4}.has(key(begin))), index == rest + 1) << begin;
  EXPECT_TRUE(Shard{}.has(key("12345678")));
}

/// Cases that nobody runs.
std::vector<Case> cases(std::initializer_list<const char*> keys) {
  std::vector<Case> all;
  for (const char* begin : keys) {
    all.emplace_back();
    all.back().key = key(begin), all.back().id = "case " + std::string(begin);
  }
  return all;
}

TEST(Sessions, LeaveWhoRanWhat) {
  const Scratch scratch;
  const Store store(scratch.path() / "results");
  const fs::path session =
      begin_session(store, "taut run x", cases({"00000003", "00000004"}), {2, 3});
  EXPECT_EQ(session.parent_path(), store.root() / "sessions");
  const Json about = parse_json(read_text(session / "session.json"));
  EXPECT_EQ(about["schema"], 1);
  EXPECT_EQ(about["command"], "taut run x");
  EXPECT_EQ(about["host"], host_name());
  EXPECT_EQ(about["toolchain"], toolchain());
  EXPECT_EQ((std::tuple{about["shard"], about["shards"], about["cases"]}),
            (std::tuple{Json(2), Json(3), Json(2)}));
  EXPECT_LE(about["started"], utc_stamp());
  EXPECT_TRUE(
      session.filename().string().starts_with(about["started"].get<std::string>().substr(0, 13)));
  EXPECT_EQ(read_text(session / "manifest.jsonl"),
            R"({"key":")" + key("00000003") + R"(","id":"case 00000003","shard":1,"shards":3})" +
                "\n" + R"({"key":")" + key("00000004") +
                R"(","id":"case 00000004","shard":2,"shards":3})" + "\n");
}

TEST(Sessions, TheirManifestsAreReadAsOneWithoutRepetitions) {
  const Scratch scratch;
  const Store store(scratch.path());
  EXPECT_TRUE(read_manifests(store.root()).empty());
  const fs::path one = begin_session(store, "", cases({"3", "1"}), {1, 4});
  begin_session(store, "", cases({"2", "1"}), {2, 4});
  make_folder(store.root() / "sessions/of another kind");
  std::string ids;
  for (const ManifestEntry& entry : read_manifests(store.root())) ids += entry.id + ", ";
  EXPECT_EQ(ids, "case 1, case 2, case 3, ");
  const fs::path file = one / "manifest.jsonl";
  const std::string good = read_text(file);
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"\"shard\":", "\"shard\":0, \"x\":"},
        {"\"shards\":4", "\"shards\":0"},
        {key("1"), "not a key"}}) {
    std::string text = good;
    write_file(file, text.replace(text.rfind(from), from.size(), to));
    try {
      read_manifests(store.root());
      ADD_FAILURE() << to;
    } catch (const InputError& error) {
      EXPECT_EQ(error.diagnostics().front().line, 2) << to;
    }
  }
}

TEST(MissingCases, AreNamedAsFarAsThereIsRoom) {
  Missing mark{"m", {}, 31};
  for (int n = 1; n <= 10; ++n) mark.ids.push_back(std::to_string(n));
  EXPECT_EQ(
      mark.sentence(),
      "merged although 31 planned cases were missing; 10 still are: 1, 2, 3, 4, 5, 6, 7, 8, 9, 10");
  mark.ids.emplace_back("11");
  EXPECT_EQ(mark.sentence(),
            "merged although 31 planned cases were missing; 11 still are: 1, 2, 3, 4, 5, 6, 7, 8, "
            "9, 10, ...");
}

TEST(MissingCases, AreCountedMarkByMark) {
  const Scratch scratch;
  const Store store(scratch.path());
  mark_missing(store.root(), "b", {{key("1"), "one"}, {key("2"), "two"}, {key("3"), "three"}});
  mark_missing(store.root(), "a", {{key("4"), "four"}});
  mark_missing(store.root(), "none", {});
  write_file(store.root() / "missing/notes.txt", "not a mark\n");
  const auto marks = still_missing(store);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].file, store.root() / "missing/a.jsonl");
  EXPECT_EQ(marks[0].cases, 1u);
  EXPECT_EQ(marks[1].cases, 3u);
  EXPECT_EQ(marks[1].ids, (std::vector<std::string>{"one", "two", "three"}));
}

}  // namespace
}  // namespace taut::session_test
