// The results file: whole cases or none, results that are never replaced, and numbers that keep
// every bit.
#include "experiments/results/store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>
#include <thread>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/record_columns.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/results/schema.hpp"
#include "experiments/results/store_error.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "tests/support/damaged_results.hpp"

namespace taut::store_test {
namespace {

namespace fs = std::filesystem;

Record some_record() {
  Record r;
  r.key = std::string(63, 'a') + "7";
  r.id = "hang jakobsen:iterations=8";
  r.spec = {"hang", {"time.dt=\"1/60\""}, "jakobsen:iterations=8"};
  r.scene = "a sheet";  // each text is unique, so that a swapped field is noticed
  r.solver = "jakobsen";
  r.params = {{"iterations", "8"}};
  r.sweeps = 8;
  r.work_parameters = {"iterations"};
  r.log = "what it said";
  r.dt = 1.0 / 60;
  r.steps = 600;
  r.vertices = 400;
  r.links = 760;
  r.status = {Status::Kind::exploded, Reason::energy, 17, 3};
  r.values = {{"a", 0.1 + 0.2},
              {"b", std::numeric_limits<double>::quiet_NaN()},
              {"c", std::numeric_limits<double>::denorm_min()},
              {"d", -1.7976931348623157e308},
              {"e", -0.0},
              {"f", 7}};
  r.projections = 6080;
  r.step_cost = {{"structural", 760, 8, 12160, true}};
  r.resolved_settings = {{"time step", "1/60 s"}};
  r.digest = "beef";
  return r;
}

/// The message for this text of a record.
std::string refusal(const std::string& json) {
  try {
    record_from_json(json, "JSON");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class StoreTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(root_); }
  Store::Commit put(const Record& record) {
    store_.prepare();
    return store_.commit(record);
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
  const std::string written = "\"schema\":" + std::to_string(kRecordSchema);
  text.replace(text.find(written), written.size(), "\"schema\":1");
  EXPECT_EQ(refusal(text),
            "JSON: schema: is 1; this program reads " + std::to_string(kRecordSchema));
  EXPECT_THROW(record_from_json("{}", "x"), InputError);
  EXPECT_THROW(record_from_json("[1", "x"), InputError);
}

TEST(RecordText, SeriesKeepGapsAndBits) {
  const Series series{{"step", "y"}, {{0, 1e-300}, {1, std::nan("")}, {2, 0.1}}};
  EXPECT_EQ(to_json(series), R"({"step":[0.0,1.0,2.0],"y":[1e-300,null,0.1]})");
  const Series back = series_from_json(to_json(series), "x");
  EXPECT_EQ(back.columns, series.columns);
  ASSERT_EQ(back.rows.size(), 3u);
  EXPECT_EQ(back.rows[0], series.rows[0]);
  EXPECT_TRUE(std::isnan(back.rows[1][1]));
  EXPECT_EQ(back.rows[2], series.rows[2]);
}

TEST(RecordText, TheResultIsNotHowItWasCalled) {
  Record a = some_record(), b = a;
  b.id = "another";
  b.spec.scene = "./copy.toml";
  b.scene = "copy";
  EXPECT_EQ(result_digest(a), result_digest(b));
  b.values["a"] = std::nextafter(b.values["a"], 1);
  EXPECT_NE(result_digest(a), result_digest(b));
}

TEST_F(StoreTest, ACaseIsThereAfterItsCommit) {
  const Record r = some_record();
  EXPECT_FALSE(store_.find(r.key));
  EXPECT_EQ(put(r), Store::Commit::stored);
  ASSERT_TRUE(store_.find(r.key));
  const Record back = *Store(root_).find(r.key);
  EXPECT_EQ(to_json(back), to_json(r));
  EXPECT_EQ(back.status.reason, Reason::energy);
  EXPECT_TRUE(std::signbit(back.values.at("e"))) << "a zero keeps its sign";
  EXPECT_EQ(back.values.at("c"), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(store_.keys(), std::vector<std::string>{r.key});
  std::vector<std::string> names;
  for (const auto& one : fs::directory_iterator(root_)) names.push_back(one.path().filename());
  EXPECT_EQ(names, std::vector<std::string>{"results.db"}) << "one file, and no journal stays";
}

/// Sets a value that differs from that of an empty record.
template <class Value>
void fill(Value& value, int n) {
  const std::string text = "text " + std::to_string(n);
  if constexpr (std::is_same_v<Value, std::string>)
    value = text;
  else if constexpr (std::is_arithmetic_v<Value>)
    value = static_cast<Value>(n);
  else if constexpr (std::is_same_v<Value, Status::Kind>)
    value = Status::Kind::extreme;
  else if constexpr (std::is_same_v<Value, StatusReason>)
    value = text;
  else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
    value = {text};
  else if constexpr (std::is_same_v<Value, RecordColumn::Texts>)
    value = {{"a", text}};
  else if constexpr (std::is_same_v<Value, RecordColumn::Numbers>)
    value = {{"a", n / 7.0}};
  else if constexpr (std::is_same_v<Value, SceneSettings>)
    value = {"a=" + text};
  else if constexpr (std::is_same_v<Value, ResolvedSettings>)
    value = {{"a", text, "token", n / 7.0}, {"b", "c"}};
  else
    value = {{text, 1, 2, 3, true}};
}

TEST_F(StoreTest, EveryFieldOfARecordIsKept) {
  Record r;
  int n = 0;
  for (const RecordColumn& column : record_columns())
    with_member(r, column, [&](auto& value) { fill(value, ++n); });
  r.key = some_record().key;
  EXPECT_EQ(to_json(record_from_json(to_json(r), "JSON")), to_json(r));
  EXPECT_EQ(put(r), Store::Commit::stored);
  ASSERT_TRUE(Store(root_).find(r.key));
  EXPECT_EQ(to_json(*Store(root_).find(r.key)), to_json(r));
}

/// Only -1 is stored as NULL, which means that there is no step.
TEST_F(StoreTest, AWholeNumberBelowNoneIsKeptAndRefused) {
  Record r = some_record();
  r.status.step = -2;
  put(r);
  Database file(store_.file(), Database::Access::read);
  Database::Rows row = file.rows("SELECT step FROM cases");
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.integer(0), -2);
  EXPECT_FALSE(store_.find(r.key));
}

TEST_F(StoreTest, WhatASolverHasNotIsNull) {
  put(some_record());
  Database file(store_.file(), Database::Access::read);
  Database::Rows row = file.rows("SELECT substeps, sweeps FROM cases");
  ASSERT_TRUE(row.next());
  EXPECT_TRUE(row.null(0));
  EXPECT_EQ(row.integer(1), 8);
}

TEST_F(StoreTest, OfWhatACaseLeavesSeriesAndMotionAreKept) {
  const Record r = some_record();
  store_.prepare();
  const fs::path staged = store_.stage(r.key);
  const Series series{{"step", "t"}, {{0, 0}, {1, 0.5}}};
  write_file(staged / kSeriesFile, to_json(series));
  write_file(staged / "stderr.txt", std::string(70000, 'a') + "the end");
  std::string frames;
  for (const double t : {0.25, 0.5})
    frames += frame_bytes(
        {t, {std::vector<Vec3>(static_cast<std::size_t>(r.vertices), Vec3(1, 2, 3)), {}}});
  write_file(staged / kFramesFile, frames);
  EXPECT_EQ(store_.commit(staged, r, {2, 0.5}), Store::Commit::stored);
  EXPECT_FALSE(fs::exists(staged));
  Store other(root_);
  EXPECT_EQ(other.spent().at(r.key).cpu, 2);
  EXPECT_EQ(other.spent().at(r.key).metrics, 0.5);
  EXPECT_EQ(other.series(r.key).columns, series.columns);
  EXPECT_EQ(other.series(r.key).rows, series.rows);
  ASSERT_TRUE(other.has_frames(r.key));
  const Trajectory motion = other.motion(r.key);
  EXPECT_EQ(motion.solver, r.spec.solver);
  EXPECT_EQ(motion.frame_dt, r.dt);
  EXPECT_EQ(motion.frames.size(), 2u);
  EXPECT_EQ(motion.frames.at(0).t, 0.25);
  EXPECT_EQ(motion.frames[0].state.x[0], Vec3(1, 2, 3));
  Database file(store_.file(), Database::Access::read);
  Database::Rows row = file.rows("SELECT errors FROM cases");
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.text(0).size(), 65536u);
  EXPECT_TRUE(row.text(0).ends_with("the end"));
  EXPECT_TRUE(other.series("none").columns.empty());
  EXPECT_FALSE(other.has_frames("none"));
}

TEST_F(StoreTest, AResultIsNeverReplaced) {
  Record r = some_record();
  put(r);
  const std::string digest = store_.digest();
  EXPECT_EQ(put(r), Store::Commit::same);
  EXPECT_TRUE(store_.conflicts().empty());
  r.values["a"] = 7;
  EXPECT_EQ(put(r), Store::Commit::conflict);
  EXPECT_EQ(put(r), Store::Commit::conflict);
  EXPECT_EQ(store_.conflicts(), std::vector{r.key}) << "the same other result counts once";
  r.values["a"] = 8;
  EXPECT_EQ(put(r), Store::Commit::conflict);
  EXPECT_EQ(store_.conflicts(), (std::vector{r.key, r.key}));
  EXPECT_EQ(store_.digest(), digest);
  r.status = {Status::Kind::timeout, "wall time", 5, -1};
  EXPECT_EQ(put(r), Store::Commit::same) << "a failure says nothing against a result";
  EXPECT_EQ(store_.digest(), digest);
}

TEST_F(StoreTest, AResultWithItsMotionReplacesOneWithout) {
  const Record r = some_record();
  put(r);
  const std::string digest = store_.digest();
  EXPECT_EQ(store_.commit(r, {.motion = "a motion"}), Store::Commit::stored);
  EXPECT_TRUE(store_.has_frames(r.key));
  EXPECT_EQ(store_.commit(r, {.motion = "a motion"}), Store::Commit::same);
  EXPECT_EQ(put(r), Store::Commit::same);
  EXPECT_TRUE(store_.has_frames(r.key));
  change(store_, "UPDATE frames SET motion = x'00'");
  EXPECT_FALSE(store_.has_frames(r.key)) << "it does not match its digest";
  EXPECT_THROW(store_.motion(r.key), StoreError);
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("damaged motion of " + r.key), std::string::npos) << said_[0];
  EXPECT_EQ(store_.commit(r, {.motion = "a motion"}), Store::Commit::stored);
  EXPECT_TRUE(store_.has_frames(r.key));
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
}

TEST_F(StoreTest, ACaseOfAnotherDigestIsReportedAsMissing) {
  const Record r = some_record();
  put(r);
  const std::string digest = store_.digest();
  for (const char* damage :
       {"UPDATE numbers SET value = 8 WHERE value = 7", "DELETE FROM numbers WHERE value = 7",
        "UPDATE cases SET projections = 1", "UPDATE cases SET passes = '[1'",
        "UPDATE cases SET status = 'well'", "UPDATE cases SET vertices = -1",
        "UPDATE cases SET steps = -1", "UPDATE cases SET sweeps = -2",
        "UPDATE cases SET projections = -1", "UPDATE cases SET dt = 0",
        "UPDATE cases SET parameters = x'00ff'"}) {
    said_.clear();
    change(store_, damage);
    EXPECT_FALSE(store_.find(r.key)) << damage;
    ASSERT_EQ(said_.size(), 1u) << damage;
    EXPECT_NE(said_[0].find("results.db: damaged case " + r.key), std::string::npos) << said_[0];
    EXPECT_EQ(put(r), Store::Commit::stored) << damage;
    EXPECT_EQ(to_json(*store_.find(r.key)), to_json(r));
    EXPECT_EQ(store_.digest(), digest);
  }
}

/// 600 steps, vertex 3 and 6080 projections are also what the low bits of some of these say, and
/// step and vertex are part of the digest.
TEST_F(StoreTest, WhatNoRecordHasIsRefusedInTheWordsOfJson) {
  const Record r = some_record();
  const Json json = parse_json(to_json(r));
  put(r);
  const auto said_of = [&](const std::string& key, const std::string& column,
                           const std::string& value) {
    said_.clear();
    change(store_, "UPDATE cases SET " + column + " = " + value);
    EXPECT_FALSE(store_.find(key)) << column << " = " << value;
    EXPECT_TRUE(store_.entries().empty()) << column << " = " << value;
    change(store_, "DELETE FROM cases");
    put(r);
    return said_.empty() ? "" : said_.front();
  };
  const std::string file = store_.file().string() + ": damaged case ";
  for (const auto& [column, value] : {std::pair("steps", "4294967896"),
                                      {"steps", "-1"},
                                      {"steps", "600.5"},
                                      {"vertices", "-4294966896"},
                                      {"links", "2147483648"},
                                      {"sweeps", "4294967304"},
                                      {"substeps", "-2"},
                                      {"projections", "-1"},
                                      {"projections", "6080.5"},
                                      {"projections", "9007199254740994"}}) {
    Json same = json;
    same[column] = parse_json(value);
    const std::string why = refusal(to_text(same));
    ASSERT_TRUE(why.starts_with("JSON: " + std::string(column) + ": expected a ")) << why;
    EXPECT_EQ(said_of(r.key, column, value),
              file + r.key + " (" + why.substr(6) + "), counts as none");
  }
  for (const auto& [column, value] :
       {std::pair("step", "4294967313"), {"vertex", "4294967299"}, {"vertex", "'three'"}})
    EXPECT_EQ(said_of(r.key, column, value),
              file + r.key + " (" + column +
                  ": expected a whole number from -1 to 2147483647), counts as none");
  for (const std::string& key : {std::string("../escaped"), std::string(64, 'A'), r.key + "0"}) {
    Json same = json;
    same["key"] = key;
    EXPECT_EQ(refusal(to_text(same)), "JSON: key: expected 64 hexadecimal digits");
    EXPECT_EQ(said_of(key, "key", "'" + key + "'"),
              file + key + " (key: expected 64 hexadecimal digits), counts as none");
  }
}

TEST_F(StoreTest, AMotionOfMoreVerticesThanThereAreNumbersIsRefused) {
  const Record r = some_record();
  store_.prepare();
  store_.commit(r, {.motion = frame_bytes({0.5, {std::vector<Vec3>(400, Vec3(1, 2, 3)), {}}})});
  change(store_, "UPDATE cases SET vertices = 4294967696");  // 2^32 + 400
  try {
    store_.motion(r.key);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              store_.file().string() + ": motion of " + r.key +
                  ": vertices: expected a whole number from 0 to 2147483647");
  }
}

TEST_F(StoreTest, ADamagedFileIsRefusedOrSetAside) {
  const Record r = some_record();
  for (const bool header : {true, false}) {
    fs::remove_all(root_);
    said_.clear();
    std::optional<Store> first(std::in_place, root_);
    first->commit(r);
    first.reset();
    std::string bytes = read_text(root_ / "results.db");
    if (header)
      bytes.replace(0, 100, std::string(100, 'x'));
    else  // the rest of the file without the schema
      bytes.replace(4096, bytes.size() - 4096, std::string(bytes.size() - 4096, '\x7f'));
    write_file(root_ / "results.db", bytes);
    const auto note = [this](const std::string& text) { said_.push_back(text); };
    try {
      Store(root_, note).find(r.key);
      ADD_FAILURE() << header;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("results.db: damaged: "), std::string::npos)
          << error.what();
    }
    EXPECT_EQ(read_text(root_ / "results.db"), bytes) << "reading changes nothing";
    Store again(root_, note);
    again.prepare();
    ASSERT_EQ(said_.size(), 1u);
    EXPECT_NE(said_[0].find("begun anew"), std::string::npos);
    EXPECT_TRUE(again.keys().empty());
    EXPECT_EQ(again.commit(r), Store::Commit::stored);
    int aside = 0;
    for (const auto& one : fs::directory_iterator(root_))
      if (one.path().string().find(".damaged-") != std::string::npos) {
        EXPECT_EQ(read_text(one.path()), bytes);
        ++aside;
      }
    EXPECT_EQ(aside, 1);
  }
}

TEST_F(StoreTest, WhereNoFileCanBeMadeIsSaidBeforeACaseRuns) {
  fs::create_directory_symlink("/proc/self", root_);  // exists, but is writable for no one
  EXPECT_THROW(store_.prepare(), StoreError);
  fs::remove(root_);
}

TEST_F(StoreTest, OfAProcessKilledWhileWritingNothingStays) {
  Record failure = some_record(), other = some_record();
  failure.key[0] = 'b';
  failure.status = {Status::Kind::timeout, "wall time", 5, -1};
  other.key = failure.key;
  put(failure);
  const std::string digest = store_.digest();
  const auto size = fs::file_size(store_.file());
  for (const rlim_t most : {rlim_t{10}, rlim_t{size}, rlim_t{size + 4096}}) {
    const pid_t child = fork();
    if (child == 0) {  // a signal ends it within the write, which exceeds the limit of file sizes
      const rlimit no_core{0, 0}, limit{most, most};
      setrlimit(RLIMIT_CORE, &no_core);
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_DFL);
      Store(root_).commit(other, {.motion = std::string(100000, 'm')});
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    Store next(root_);
    next.prepare();
    EXPECT_EQ(next.keys(), std::vector{other.key}) << most;
    EXPECT_EQ(next.find(other.key)->status.kind, Status::Kind::timeout);
    EXPECT_EQ(next.digest(), digest);
  }
  EXPECT_TRUE(said_.empty());
}

TEST_F(StoreTest, OfResultsAtOnceOneStaysAndOthersConflict) {
  constexpr int kCases = 30, kWriters = 3;
  store_.prepare();
  std::vector<pid_t> writers;
  for (int i = 0; i < kWriters; ++i) {
    writers.push_back(fork());
    if (writers.back() != 0) continue;
    Store own(root_);
    for (int n = 0; n < kCases; ++n) {
      Record record = some_record();
      record.key = std::string(60, 'a') + std::to_string(1000 + n);
      record.values["a"] = i;
      own.commit(record);
    }
    _exit(0);
  }
  for (const pid_t writer : writers) {
    int status = 0;
    ASSERT_EQ(waitpid(writer, &status, 0), writer);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(store_.keys().size(), static_cast<std::size_t>(kCases));
  EXPECT_EQ(store_.conflicts().size(), static_cast<std::size_t>(kCases * (kWriters - 1)));
}

TEST_F(StoreTest, ManyCommitsTogetherAreAllOrNone) {
  store_.prepare();
  Record a = some_record(), b = some_record();
  b.key[0] = 'b';
  b.values["only here"] = 1;
  for (int again = 0; again < 2; ++again) {
    EXPECT_THROW(store_.together([&] {
      store_.commit(a);
      store_.commit(b);
      throw InputError("no");
    }),
                 InputError);
    EXPECT_TRUE(store_.keys().empty()) << again << ": one that failed is over";
  }
  store_.together([&] {
    store_.commit(a);
    store_.commit(b);
  });
  EXPECT_EQ(store_.keys(), (std::vector{a.key, b.key}));
  EXPECT_EQ(to_json(*store_.find(b.key)), to_json(b));
}

TEST_F(StoreTest, TakesOverWhatAnotherHas) {
  const fs::path place = root_ / "other";
  Store other(place);
  Record failed = some_record(), better = some_record(), fresh = some_record();
  failed.key[0] = better.key[0] = 'b';
  fresh.key[0] = 'c';
  fresh.values["new"] = -0.0;
  failed.status = {Status::Kind::timeout, "wall time", 5, -1};
  put(some_record());
  put(failed);
  other.commit(better, {.series = "{\"t\":[1]}"});
  other.commit(fresh, {.motion = "m"});
  Record late = some_record();
  late.key[0] = 'd';
  late.status = failed.status;
  other.commit(late);
  put([&] {
    Record sound = some_record();
    sound.key = late.key;
    return sound;
  }());
  store_.take(other);
  EXPECT_EQ(store_.keys().size(), 4u);
  EXPECT_EQ(to_json(*store_.find(better.key)), to_json(better));
  EXPECT_EQ(store_.series(better.key).rows.size(), 1u);
  EXPECT_EQ(to_json(*store_.find(fresh.key)), to_json(fresh));
  EXPECT_TRUE(store_.has_frames(fresh.key));
  EXPECT_TRUE(store_.find(late.key)->status.is_result()) << "a failure replaces nothing";
  const std::string digest = store_.digest();
  store_.take(other);
  EXPECT_EQ(store_.digest(), digest);
  store_.take(Store(root_ / "none"));
  EXPECT_EQ(store_.digest(), digest);
}

TEST_F(StoreTest, ResultsOfAnEarlierTautAreSaidAndLeftAlone) {
  fs::create_directories(root_ / "store" / "aa");
  write_file(root_ / "store" / "aa" / "entry", "{}");
  EXPECT_TRUE(store_.keys().empty());
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("/store: results of an earlier taut"), std::string::npos) << said_[0];
  put(some_record());
  EXPECT_EQ(said_.size(), 2u);
  store_.prepare();
  EXPECT_EQ(store_.keys().size(), 1u);
  EXPECT_EQ(said_.size(), 2u) << "not again";
  EXPECT_EQ(read_text(root_ / "store" / "aa" / "entry"), "{}");
}

TEST_F(StoreTest, AFileOfAnotherVersionIsNeitherReadNorWritten) {
  put(some_record());
  change(store_, "PRAGMA user_version = 99");
  Store other(root_);
  for (const auto& use :
       {std::function([&] { other.keys(); }), std::function([&] { other.prepare(); })})
    try {
      use();
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what())
                    .find("(version 99; this one reads " + std::to_string(kSchemaVersion) + ")"),
                std::string::npos)
          << error.what();
    }
}

TEST_F(StoreTest, AFileOfTablesWithoutAVersionIsSetAside) {
  put(some_record());
  change(store_, "PRAGMA user_version = 0");
  Store other(root_, [&](const std::string& text) { said_.push_back(text); });
  EXPECT_TRUE(other.keys().empty());
  other.prepare();
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("results.db: damaged, set aside as "), std::string::npos) << said_[0];
  EXPECT_TRUE(other.keys().empty());
  Store again(root_);
  again.prepare();
  EXPECT_EQ(said_.size(), 1u) << "it is begun anew, once";
}

TEST_F(StoreTest, ReadingCreatesNothing) {
  EXPECT_FALSE(store_.find(some_record().key));
  EXPECT_TRUE(store_.keys().empty());
  EXPECT_FALSE(fs::exists(root_));
}

}  // namespace
}  // namespace taut::store_test
