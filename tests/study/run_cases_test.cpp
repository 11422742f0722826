// The cases of a list that are run, their order, the number at a time, and the counts of results.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <sstream>

#include "core/model/input_error.hpp"
#include "core/reference/linear_stability.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/frontier/frontier.hpp"
#include "experiments/system/clock.hpp"
#include "tests/support/scripted.hpp"

namespace taut::run_cases_test {
namespace {

namespace fs = std::filesystem;
using Kind = Status::Kind;

Case scripted_case(int iterations) {
  return make_case({"hang",
                    {"cloth.grid=[4, 4]", "time.duration=0.25"},
                    "scripted:iterations=" + std::to_string(iterations)});
}

/// Script that logs the case and returns the record prepared under its solver's text.
const std::string kCopy = "echo \"$3\" >>$folder/order\ncp \"$folder/$3.json\" $5/case.json\n";

class Runs : public testing::Test {
 protected:
  CampaignProgress run(const std::vector<Case>& cases, CampaignOptions options = {}) {
    told_.clear();
    options.progress = [this](const CampaignProgress& now, const Record* record) {
      told_.push_back(now);
      if (record) ended_.push_back(record->id);
    };
    store_.prepare();
    return run_cases(cases, store_, options);
  }
  /// Prepares the record that the script returns for a case.
  void give(const Case& one, Kind kind = Kind::ok, double value = 1) const {
    Record record = unfinished(one, {kind, kind == Kind::ok ? "" : "made up", -1, -1});
    record.values = {{"a", value}};
    write_file(scripted_.folder() / (one.spec.solver + ".json"), to_json(record));
  }
  /// Numbers of sweeps of the started cases, in order.
  std::vector<int> order() const {
    std::vector<int> all;
    std::istringstream lines(scripted_.told("order"));
    for (std::string line; std::getline(lines, line);)
      all.push_back(parse_solver(line).params.integer("iterations"));
    return all;
  }
  /// Whether no case has left anything in the store's staging folder: it contains this test's own
  /// entry alone.
  bool nothing_staged() {
    const fs::path mine = store_.stage("mine");
    const auto entries = std::distance(fs::directory_iterator(mine.parent_path()), {});
    fs::remove(mine);
    return entries == 1;
  }

  Scripted scripted_{kCopy};
  const Scratch scratch_;
  Store store_{scratch_.path() / "results"};
  std::vector<CampaignProgress> told_;
  std::vector<std::string> ended_;
};

TEST_F(Runs, TheLongestGoesFirstAndNothingRunsTwice) {
  std::vector<Case> cases;
  double work = 0;
  for (const int n : {2, 9, 1, 5}) {
    cases.push_back(scripted_case(n));
    give(cases.back());
    work += estimated_work(cases.back());
  }
  const CampaignProgress done = run(cases);
  EXPECT_EQ(order(), (std::vector<int>{9, 5, 2, 1}));
  EXPECT_EQ(
      (std::tuple{done.cases, done.ran, done.reused, done.conflicts, done.done()}),
      (std::tuple{std::size_t{4}, std::size_t{4}, std::size_t{0}, std::size_t{0}, std::size_t{4}}));
  EXPECT_EQ(done.by_status, (std::map<Kind, std::size_t>{{Kind::ok, 4}}));
  EXPECT_NEAR(done.work, work, 1e-9 * work);
  EXPECT_NEAR(done.work_done, work, 1e-9 * work);
  EXPECT_FALSE(done.interrupted);
  EXPECT_EQ(told_.front().work_done, 0);
  EXPECT_EQ(told_.front().cases, 4u);
  EXPECT_EQ(ended_.size(), 4u);
  EXPECT_EQ(ended_.front(), cases[1].id);
  EXPECT_TRUE(nothing_staged());
  cases.push_back(scripted_case(3));
  give(cases.back(), Kind::timeout);
  const CampaignProgress more = run(cases);
  EXPECT_EQ(order(), (std::vector<int>{9, 5, 2, 1, 3}));
  EXPECT_EQ((std::tuple{more.cases, more.ran, more.reused}),
            (std::tuple{std::size_t{5}, std::size_t{1}, std::size_t{4}}));
  EXPECT_EQ(more.by_status, (std::map<Kind, std::size_t>{{Kind::ok, 4}, {Kind::timeout, 1}}));
  EXPECT_NEAR(more.work, estimated_work(cases.back()), 1e-9);
}

TEST_F(Runs, OfEqualWorkTheLesserKeyGoesFirst) {
  std::vector<Case> cases;
  for (const char* variant : {"omega=1.1", "omega=1.2", "omega=1.3", "omega=1.4"}) {
    cases.push_back(make_case(
        {"hang", {"cloth.grid=[4, 4]", "time.duration=0.25"}, "scripted:" + std::string(variant)}));
    give(cases.back());
  }
  run(cases);
  std::ranges::sort(cases, {}, &Case::key);
  std::string expected;
  for (const Case& one : cases) expected += one.spec.solver + "\n";
  EXPECT_EQ(scripted_.told("order"), expected);
}

TEST_F(Runs, OnlyFailuresAreRunAgainOnRequest) {
  const std::vector<Case> cases{scripted_case(1), scripted_case(2), scripted_case(3)};
  give(cases[0]);
  give(cases[1], Kind::crash);
  run({cases[0], cases[1]});
  give(cases[1]);
  give(cases[2]);
  EXPECT_EQ(run({cases[0], cases[1]}).ran, 0u) << "a stored failure is kept";
  const CampaignProgress again = run(cases, {.only_failed = true});
  EXPECT_EQ((std::tuple{again.cases, again.ran, again.reused}),
            (std::tuple{std::size_t{1}, std::size_t{1}, std::size_t{0}}));
  EXPECT_EQ(order(), (std::vector<int>{2, 1, 2}));
  EXPECT_EQ(store_.find(cases[1].key)->status.kind, Kind::ok);
  EXPECT_FALSE(store_.find(cases[2].key)) << "what was never run is no failure";
}

TEST_F(Runs, WhatIsStoredWithoutItsMotionIsRunAgain) {
  const std::vector<Case> cases{scripted_case(2), scripted_case(1)};
  give(cases[0]);
  give(cases[1], Kind::oom);
  run(cases);
  scripted_.write(kCopy + "echo \"$*\" >>$folder/words; echo motion >$5/frames\n");
  const CampaignProgress with = run(cases, {.frames = true});
  EXPECT_EQ((std::tuple{with.ran, with.reused}), (std::tuple{std::size_t{1}, std::size_t{1}}));
  EXPECT_NE(scripted_.told("words").find("--frames 32\n"), std::string::npos);
  EXPECT_TRUE(store_.has_frames(cases[0].key));
  EXPECT_EQ(run(cases, {.frames = true}).ran, 0u);
}

TEST_F(Runs, AnotherResultThanTheStoredOneIsCounted) {
  const Case one = scripted_case(2);
  give(one);
  EXPECT_EQ(run({one}).conflicts, 0u);
  give(one, Kind::ok, 2);
  scripted_.write(kCopy + "echo motion >$5/frames\n");
  EXPECT_EQ(run({one}, {.frames = true}).conflicts, 1u);
  EXPECT_EQ(store_.find(one.key)->values.at("a"), 1);
  EXPECT_EQ(store_.conflicts(), std::vector{one.key});
}

TEST_F(Runs, AShardIsItsPartAlone) {
  std::vector<Case> cases;
  std::set<int> expected;
  for (int n = 1; n <= 6; ++n) {
    cases.push_back(scripted_case(n));
    give(cases.back());
    if (Shard{2, 2}.has(cases.back().key)) expected.insert(n);
  }
  const CampaignProgress part = run(cases, {.jobs = 3, .shard = {2, 2}});
  const auto ran = order();
  EXPECT_EQ(std::set<int>(ran.begin(), ran.end()), expected);
  EXPECT_EQ(part.cases, expected.size());
}

TEST_F(Runs, NoMoreAtATimeThanAreAllowed) {
  // Each case waits until there are two, and a moment longer in case a third starts.
  scripted_.write(
      "touch $folder/on.$$\nfor i in 1 2 3 4 5 6 7 8 9; do\n[ $(ls $folder/on.* | wc -l) -ge 2 ] "
      "&& break\nsleep 0.05\n"
      "done\nsleep 0.1\nls $folder/on.* | wc -l >>$folder/counts\nrm $folder/on.$$\n" +
      kCopy);
  std::vector<Case> cases;
  for (int n = 1; n <= 4; ++n) {
    cases.push_back(scripted_case(n));
    give(cases.back());
  }
  EXPECT_EQ(run(cases, {.jobs = 2}).ran, 4u);
  std::istringstream counts(scripted_.told("counts"));
  int most = 0;
  for (int n = 0; counts >> n;) most = std::max(most, n);
  EXPECT_EQ(most, 2);
}

TEST_F(Runs, WhatMissesTheDeadlineIsKilledAndNotStored) {
  const std::vector<Case> cases{scripted_case(2), scripted_case(1)};
  const CampaignProgress none = run(cases, {.deadline = SteadyClock::now()});
  EXPECT_EQ((std::tuple{none.cases, none.ran}), (std::tuple{std::size_t{2}, std::size_t{0}}));
  EXPECT_EQ(scripted_.told("order"), "");
  scripted_.write("echo \"$3\" >>$folder/order; exec sleep 1000\n");
  const auto start = SteadyClock::now();
  EXPECT_EQ(run(cases, {.deadline = in_seconds(0.3)}).done(), 0u);
  EXPECT_LT(seconds_since(start), 5);
  EXPECT_EQ(order(), std::vector<int>{2});
  EXPECT_TRUE(nothing_staged());
  EXPECT_TRUE(store_.keys().empty());
}

TEST_F(Runs, OneCaseIsTakenFromTheStoreOrRunAndKept) {
  const Case one = scripted_case(2);
  give(one, Kind::unsettled);
  store_.prepare();
  EXPECT_EQ(run_again(one, store_).status.kind, Kind::unsettled);
  EXPECT_TRUE(store_.keys().empty()) << "run apart from the store";
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(run_stored(one, store_)->status.kind, Kind::unsettled);
    EXPECT_EQ(order().size(), 2u) << "once";
  }
  EXPECT_EQ(run_again(one, store_).id, one.id);
  EXPECT_EQ(order().size(), 3u);
  scripted_.write("exec sleep 1000\n");
  EXPECT_FALSE(run_stored(scripted_case(3), store_, {}, in_seconds(0.1)));
  EXPECT_TRUE(nothing_staged());
  EXPECT_EQ(store_.keys(), std::vector{one.key});
}

TEST_F(Runs, OfAStudyResultsComeInThePlansOrder) {
  Study study;
  study.scenes = {"hang"};
  study.solvers = {"scripted"};
  study.settings = {"cloth.grid=[4, 4]", "time.duration=0.25"};
  study.axes = {{"iterations", {"3", "1", "2"}}};
  give(scripted_case(2));
  give(scripted_case(3));
  run({scripted_case(2), scripted_case(3)});
  const StudyRecords found = collect(study, store_);
  ASSERT_EQ(found.cases.size(), 3u);
  ASSERT_EQ(found.records.size(), 2u);
  EXPECT_EQ(found.records[0].id, scripted_case(3).id);
  EXPECT_EQ(found.records[1].id, scripted_case(2).id);
}

TEST(FrontierOfCases, LooksAtFourPlacesAboveEvenlySpread) {
  const Frontier found = find_frontier({.from = 1, .to = 100, .tolerance = 1e-3, .coarse = 2},
                                       [](const std::vector<double>& values) {
                                         std::vector<Outcome> all;
                                         for (const double value : values)
                                           all.push_back({{value < 3 ? Kind::ok : Kind::exploded}});
                                         return all;
                                       });
  std::vector<double> above;
  for (const auto& probe : found.probes)
    if (probe.value >= found.unstable) above.push_back(probe.value);
  ASSERT_GE(above.size(), 6u);
  EXPECT_EQ(found.above, above.size() - 1);
  const double next = above[5];  // smallest value above the bracket that was tried earlier
  for (std::size_t i = 1; i < 5; ++i)
    EXPECT_NEAR(above[i], above[0] * std::pow(next / above[0], static_cast<double>(i) / 5),
                1e-4 * above[i])
        << i;
}

// Cases run by the test program itself: a mass on a spring, whose longest stable step is known.
TEST(FrontierOfCases, BracketsWhatTheoryPredictsAndRunsNothingTwice) {
  const Scratch scratch;
  Store store(scratch.path());
  store.prepare();
  const FrontierQuestion question{
      {"chain",
       {"cloth.grid=[1, 2]", "time.duration=4", "forces.gravity=[0, -1e-3, 0]"},
       "mass-spring:substeps=1,structural=40"},
      "dt",
      {.from = 0.02, .to = 0.08, .tolerance = 0.08, .coarse = 2}};
  const auto predicted = predicted_frontier(question);
  ASSERT_TRUE(predicted);
  ASSERT_EQ(predicted->kind, Frontier::Kind::bracketed);
  const Case at = make_case(question.at(predicted->value));
  EXPECT_NEAR(linear_stability(*at.scene, at.choice)->margin, 1, 1e-5);
  for (const bool again : {false, true}) {
    const CaseFrontier found = find_frontier(question, store, {.jobs = 2});
    ASSERT_EQ(found.frontier.kind, Frontier::Kind::bracketed);
    EXPECT_NEAR(found.frontier.stable, predicted->value, 0.09 * predicted->value);
    EXPECT_NEAR(found.frontier.unstable, predicted->value, 0.09 * predicted->value);
    EXPECT_FALSE(found.interrupted);
    EXPECT_EQ(found.ran, again ? 0 : found.frontier.probes.size());
    ASSERT_EQ(found.records.size(), found.frontier.probes.size());
    for (std::size_t k = 0; k < found.records.size(); ++k)
      EXPECT_NEAR(found.records[k].dt, found.frontier.probes[k].value, 1e-8)
          << "ascending, as the probes";
  }
  const CaseFrontier judged =
      find_frontier(question, store, {}, [](const Case& one, const Record& r) {
        return one.scene->dt == r.dt && r.dt > 0.03 ? "odd" : "";
      });
  EXPECT_NEAR(judged.frontier.unstable, 0.0315, 0.0031);
  EXPECT_EQ(judged.frontier.at(judged.frontier.unstable)->symptom, "odd");
}

}  // namespace
}  // namespace taut::run_cases_test
