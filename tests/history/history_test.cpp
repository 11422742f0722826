#include "experiments/history/history.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/external/external.hpp"
#include "experiments/history/history_answer.hpp"
#include "experiments/history/walk.hpp"
#include "experiments/results/store.hpp"
#include "experiments/results/store_error.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut {

namespace {

/// Store whose builds have these stretches of one case each; NaN: planned but not run.
class Histories : public testing::Test {
 protected:
  void build(const std::string& id, double stretch, Status status = {}) {
    const std::string key = std::string(63, '0') + static_cast<char>('a' + count_);
    const Build one{id, "2026-05-0" + std::to_string(++count_)};
    if (stretch == stretch) {
      Record record = synthetic::record("hang", "a", 4, 0.01);
      record.key = key;
      record.status = status;
      record.values = {{"stretch.rms", stretch}, {"stretch.max", 1}};
      store_.commit(record);
    }
    note_ran(store_, "s", one, "hang a", key);
  }
  History history(double relative = 1e-6) {
    return history_of(store_, "s", Tolerances({{"default", {0, relative, false, "close"}}}));
  }

  Scratch scratch_;
  Store store_{scratch_.path()};
  int count_ = 0;
};

TEST_F(Histories, AStepIsBeyondTheToleranceOfTheBuildBefore) {
  for (const auto& [id, stretch] : {std::pair{"one", 0.021},
                                    {"two", 0.021},
                                    {"three", 0.026},
                                    {"four", 0.02600001},
                                    {"five", 0.026}})
    build(id, stretch);
  const History found = history(1e-4);
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "three");
  EXPECT_EQ(found.builds[found.steps[0].before].id, "two");
  EXPECT_EQ(found.compared, 4U);
  EXPECT_FALSE(found.last_stepped());
  EXPECT_EQ(stepped_values(found)[0].sentence,
            "stretch.rms of hang a rose from 2.1 to 2.6 % at three (2026-05-03)");
  EXPECT_EQ(history(1e-9).steps.size(), 3U) << "every digit counts";
}

TEST_F(Histories, ABuildWithoutAResultIsAGap) {
  build("one", 0.02);
  build("two", std::nan(""));
  build("three", 0.03);
  const History found = history();
  EXPECT_EQ(found.missing(1), 1U);
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.steps[0].before, 0U);
  EXPECT_TRUE(found.last_stepped());
  EXPECT_NE(stepped_values(found)[0].sentence.find("or at one of 1 builds before it"),
            std::string::npos);
}

TEST_F(Histories, ACaseThatFailsStepsInItsStatusAlone) {
  build("one", 0.02);
  build("two", 0.5, {Status::Kind::exploded, Reason::energy, 3});
  const History found = history();
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.steps[0].what.kind, Changing::Kind::status);
  EXPECT_EQ(status_change(found, found.steps[0]), "ok to exploded (energy)");
  EXPECT_EQ(stepped_values(found)[0].sentence,
            "the status of hang a went from ok to exploded (energy) at two (2026-05-02)");
}

TEST_F(Histories, AStatusIsItsKindAndItsReason) {
  const Status::Kind exploded = Status::Kind::exploded;
  build("one", 0.02, {exploded, "energy", 3});
  build("two", 0.03, {exploded, "energy", 4});
  build("three", 0.03, {exploded, "nonfinite", 4});
  build("four", 0.03, {Status::Kind::extreme, "nonfinite", 4});
  const History found = history();
  ASSERT_EQ(found.steps.size(), 2U) << "not the step at which it happened";
  EXPECT_EQ(status_change(found, found.steps[0]), "exploded (energy) to exploded (nonfinite)");
  EXPECT_EQ(status_change(found, found.steps[1]), "exploded (nonfinite) to extreme (nonfinite)");
}

// A metric's value is not a cost, whatever its name.
TEST(Changes, HaveTheNamesThatAreTyped) {
  using Kind = Changing::Kind;
  for (const auto& [name, kind] : {std::pair{"status", Kind::status},
                                   {"cpu.per_step", Kind::cpu},
                                   {"wall.per_step", Kind::wall},
                                   {"stretch.rms", Kind::value},
                                   {"slip.per_step", Kind::value}}) {
    const Changing what = changing(name);
    EXPECT_EQ(what.kind, kind) << name;
    EXPECT_EQ(what.name(), name);
    EXPECT_EQ(what.is_cost(), kind == Kind::cpu || kind == Kind::wall) << name;
    EXPECT_EQ(what.metric.empty(), kind != Kind::value) << name;
  }
  EXPECT_NE(changing("stretch.rms"), changing("stretch.max"));
}

TEST_F(Histories, OnlyTheBuildsThatAreAskedForAreLookedAt) {
  build("one", 0.02);
  build("two", 0.03);
  build("three", 0.04);
  const auto builds = builds_of(store_, "s");
  const History found = history_of(store_, "s", {}, {builds[0], builds[2]});
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "three");
}

TEST_F(Histories, ACostStepsBeyondIntervalAndControl) {
  build("one", 0.02);
  build("two", 0.02);
  build("three", 0.02);
  const auto timed = [&](const char* before, const char* now, double ratio, double noise) {
    note_ratio(store_, "s",
               {"hang a", before, now, "here", "cpu", ratio * 0.99, ratio, ratio * 1.01, 1 - noise,
                1, 1 + noise});
  };
  timed("one", "two", 2.1, 0.01);
  timed("two", "three", 1.2, 0.4);
  timed("two", "gone", 3, 0.01);
  timed("one", "three", 2.1, 0.01);  // the bisection skipped "two", which lies in between
  const History found = history();
  ASSERT_EQ(found.steps.size(), 1U);
  EXPECT_EQ(found.builds[found.steps[0].now].id, "two");
  EXPECT_EQ(found.steps[0].what.kind, Changing::Kind::cpu);
  EXPECT_EQ(stepped_values(found)[0].sentence,
            "CPU time of hang a rose to 2.1 (2.08 to 2.12) times what it was at two (2026-05-02)");
}

TEST(Builds, ANameMayHaveATime) {
  EXPECT_EQ(build_named("1.2.0@2026-05-04").made, "2026-05-04");
  EXPECT_EQ(build_named("1.2.0@2026-05-04T10:11:12Z").id, "1.2.0");
  EXPECT_EQ(build_named("a").made.size(), std::string("2026-05-04T10:11:12Z").size());
  for (const char* wrong : {"", "@2026-01-01", "a b", "a,b", "a@now", "a@2026-1-1", "it's"})
    EXPECT_THROW(build_named(wrong), InputError) << wrong;
}

/// Walks over two commits of a solver.
class Walks : public testing::Test {
 protected:
  void SetUp() override {
    external::enable();
    make_folder(repository_);
    for (const char* file : {"toy.py", "taut_solver.py"})
      write_file(repository_ / file,
                 read_text(TAUT_SOURCE_DIR "/experiments/external/sdk/" + std::string(file)));
    write_file(study_,
               "question = \"?\"\nscenes = [\"chain\"]\nsolvers = [\"jakobsen\"]\n"
               "set = [\"time.duration=0.1\"]\n");
    const std::string script =
        "git init -q -b main && git add -A && for k in 1 2; do "
        "git -c user.name=a -c user.email=a@x commit -q --allow-empty -m \"change $k\" || exit; "
        "done";
    ASSERT_TRUE(Process({"sh", "-c", script}, {.folder = repository_}).wait(20)->good());
  }
  void TearDown() override { set_solver_source({}); }
  /// Reasons of the commits' gaps, if this happens instead of running their cases.
  std::vector<std::string> gaps(const std::function<void(const Store&)>& happens) {
    Walk asked;
    asked.study = study_.string();
    asked.repository = repository_.string();
    asked.range = "HEAD~1..HEAD";
    asked.solver = "python3 toy.py";
    asked.silence = [](const SolverEntry&) { return std::string(); };
    asked.say = [](const std::string&) {};
    asked.run = [&](const auto&, Store& into, const auto&, const auto&) {
      happens(into);
      return CampaignProgress{};
    };
    Store store(scratch_.path() / ("out" + std::to_string(++stores_)));
    std::vector<std::string> all;
    for (const Build& build : walk(asked, store).builds) all.push_back(build.gap);
    return all;
  }
  const Scratch scratch_;
  const std::filesystem::path repository_ = scratch_.path() / "repo";
  const std::filesystem::path study_ = scratch_.path() / "study.toml";
  int stores_ = 0;
};

TEST_F(Walks, EndAtWhatConcernsEveryCommitWhateverTheWords) {
  const std::string words = "mine.py: dislikes ", full = "cannot write: No space left on device";
  EXPECT_EQ(gaps([](const Store&) {}), (std::vector<std::string>{"", ""}));
  EXPECT_EQ(
      gaps([&](const Store& store) { throw InputError(words + store.file().string()); }),
      std::vector<std::string>(2, words + (scratch_.path() / "out2" / "results.db").string()));
  EXPECT_EQ(gaps([&](const Store&) { throw InputError(words + study_.string()); }),
            std::vector<std::string>(2, words + study_.string()));
  EXPECT_THROW(gaps([&](const Store&) { throw StoreError("results", full); }), StoreError);
  EXPECT_THROW(gaps([&](const Store&) {
                 throw InputError({{study_.string(), 3, 1, "no such solver"}});
               }),
               InputError);
  EXPECT_THROW(gaps([&](const Store&) {
                 std::filesystem::remove(study_);
                 throw InputError("no such file");
               }),
               InputError);
}

}  // namespace

}  // namespace taut
