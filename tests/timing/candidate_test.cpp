// Candidates for a target: which is chosen and which is not.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "experiments/timing/judge.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::candidate_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Both ends of the interval fall as the cost rises, so that a search that mistakes an end for the
/// cost fails.
Candidate candidate(const char* solver, double cost, double error, const char* failure = "") {
  return {solver, solver, {0.01 / cost, cost, 100 / cost}, error, failure};
}

const std::vector<Candidate> kAll{
    candidate("a", 1, 0.2),   candidate("a", 2, 0.02),
    candidate("a", 4, 0.05),  // dominated by the candidate before
    candidate("b", 3, 0.02),  // same error at a higher cost
    candidate("b", 8, 0.001), candidate("c", 0.1, 0.0, "exploded (energy)"),  // failed fast
    candidate("c", 0.2, kNaN)};

Target within(double error) { return {error, {}}; }
Target budget(double cost) { return {{}, cost}; }

TEST(Candidates, AFastFailureNeverRanksFastest) {
  EXPECT_EQ(best_for(within(1), kAll), 0u);
  EXPECT_EQ(best_for(within(1), kAll, "c"), std::nullopt);
  EXPECT_EQ(best_for(budget(0.5), kAll), std::nullopt);
}

TEST(Candidates, ALevelIsReachedByTheCheapestThatMeetsIt) {
  EXPECT_EQ(best_for(within(0.02), kAll, "a"), 1u);
  EXPECT_EQ(best_for(within(0.02), kAll, "b"), 3u);
  EXPECT_EQ(best_for(within(0.01), kAll, "a"), std::nullopt);  // never reached
}

TEST(Candidates, ABudgetBuysTheSmallestError) {
  EXPECT_EQ(best_for(budget(3.5), kAll), 1u);  // b's equal error costs more
  EXPECT_EQ(best_for(budget(100), kAll, "b"), 4u);
}

TEST(Candidates, AnExactZeroMeetsAnErrorOfZero) {
  const std::vector<Candidate> two{candidate("a", 1, 0.1), candidate("a", 2, 0.0)};
  EXPECT_EQ(best_for(within(0), two), 1u);
}

Record with(const std::map<std::string, double>& values) {
  Record r = synthetic::record("hang", "jakobsen", 1, 1.0 / 64);
  r.values = values;
  return r;
}

TEST(Judge, AnErrorIsTheWorstOfPlaceStrainAndWhatTheReferenceKnows) {
  const auto error = [](const std::map<std::string, double>& values) {
    return error_of(with(values), kVerdict);
  };
  EXPECT_TRUE(std::isnan(error({{"stretch.rms", 0.01}}))) << "no reference";
  EXPECT_EQ(error({{"motion.error", 0.2}, {"stretch.rms", 0.01}}), 0.2);
  EXPECT_EQ(error({{"motion.error", 0.2}, {"stretch.rms", 0.3}}), 0.3);
  EXPECT_EQ(error({{"motion.error", 0.125}, {"stretch.rms", 0.25}, {"motion.strain", 0.5}}), 0.25);
  EXPECT_EQ(error({{"motion.error", 0.01}, {"motion.floor", 0.25}}), 0.75);
  const std::map<std::string, double> lying{{"ensemble.error", 0.1}, {"ensemble.floor", 0.0625}};
  EXPECT_EQ(error(lying), 0.1875);
  EXPECT_EQ(judged_by(with(lying)), JudgedBy::observables);
  EXPECT_EQ(error_of(with({{"energy.peak", -2}}), "energy.peak"), 2);
}

TEST(Judge, SaysWhyASettingDoesNotCount) {
  using enum Candidate::Refusal;
  const std::vector<Limit> limits{{"stretch.rms", 0.01}, {"tunnelling.events", 0}};
  Record good = with({{"motion.error", 0.04}, {"stretch.rms", 0.03}});
  EXPECT_EQ(judge(good, kVerdict, limits).failure, "") << "the error has the strain already";
  EXPECT_EQ(judge(good, "stretch.rms", limits).refusal, not_accepted);
  EXPECT_EQ(judge(good, kVerdict, {}).refusal, not_accepted) << "nobody determined the limits";
  EXPECT_FALSE(judge(good, kVerdict, {}).failure.empty());
  EXPECT_EQ(judge(good, kVerdict, limits, {}, "not timed").failure, "not timed");
  good.values["tunnelling.events"] = 1;
  EXPECT_EQ(judge(good, kVerdict, limits).refusal, not_accepted);

  const Candidate unknown = judge(with({{"stretch.rms", 0}}), kVerdict, limits);
  EXPECT_EQ(unknown.refusal, not_judged);
  EXPECT_FALSE(unknown.failure.empty());
  EXPECT_EQ(judge(with({{"stretch.rms", 0}}), "stretch.rms", limits).failure, "");
  // little strain is no merit of a cloth that is elsewhere
  EXPECT_EQ(judge(with({{"motion.error", 0.6}, {"stretch.rms", 0}}), "stretch.rms", limits).refusal,
            astray);
  // a rigid plate at rest on the body has 43 %
  std::map<std::string, double> lying{
      {"ensemble.error", 0.2}, {"ensemble.plate", 0.43}, {"stretch.rms", 0}};
  EXPECT_EQ(judge(with(lying), kVerdict, limits).failure, "");
  lying["ensemble.error"] = 0.22;
  EXPECT_EQ(judge(with(lying), kVerdict, limits).refusal, astray);
  Record exploded = with({{"motion.error", 0}, {"stretch.rms", 0}});
  synthetic::fail(exploded, Status::Kind::exploded, Reason::energy);
  EXPECT_EQ(judge(exploded, kVerdict, limits).refusal, failed);
}

TEST(Judge, SaysHowNearTheBestCame) {
  std::vector<Candidate> all{{"a", "jakobsen:iterations=1", {1, 1, 1}, 0.3},
                             {"a", "jakobsen:iterations=2", {2, 2, 2}, 0.2}};
  EXPECT_EQ(why_not(within(0.1), all, kVerdict).note, "at best 20 % (jakobsen:iterations=2)");
  EXPECT_EQ(why_not(within(0.1), all, kVerdict, "b").state, Cell::State::not_run);
  all.push_back({"a",
                 "jakobsen:iterations=3",
                 {3, 3, 3},
                 0.05,
                 "sinks in",
                 Candidate::Refusal::not_accepted});
  EXPECT_EQ(why_not(within(0.1), all, kVerdict).note, "sinks in");
  EXPECT_EQ(why_not(within(0.01), all, kVerdict).note, "at best 20 % (jakobsen:iterations=2)");
}

TEST(OffPrediction, IsAStretchMoreThanASeventhFromWhatSweepsLeave) {
  Record r;
  EXPECT_EQ(off_prediction(r), "") << "nothing is known";
  r.values = {{"stretch.rms", 0.02}};
  EXPECT_EQ(off_prediction(r), "") << "nothing is predicted";
  r.values["stretch.predicted"] = std::nan("");
  EXPECT_EQ(off_prediction(r), "");
  for (const double near : {0.0171, 0.0229}) {
    r.values["stretch.predicted"] = near;
    EXPECT_EQ(off_prediction(r), "") << near;
  }
  r.values["stretch.predicted"] = 0.016;
  EXPECT_TRUE(off_prediction(r).starts_with("off-prediction: its RMS stretch is 2"))
      << off_prediction(r);
  EXPECT_TRUE(off_prediction(r).ends_with(" less"));
  r.values["stretch.predicted"] = 0.024;
  EXPECT_TRUE(off_prediction(r).ends_with(" more"));
}

}  // namespace
}  // namespace taut::candidate_test
