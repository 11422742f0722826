// The trade of cost against error: who is offered, and who is not.
#include "experiments/timing/trade.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace taut {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The ends of the interval fall as the cost rises: whoever takes one of them for the cost is seen.
Offer offer(const char* solver, double cost, double error, bool failed = false) {
  return {solver, solver, {0.01 / cost, cost, 100 / cost}, error, failed};
}

const std::vector<Offer> kOffers{offer("a", 1, 0.2),   offer("a", 2, 0.02),
                                 offer("a", 4, 0.05),  // dominated by the one before
                                 offer("b", 3, 0.02),  // as good, dearer
                                 offer("b", 8, 0.001), offer("c", 0.1, 0.0, true),  // failed fast
                                 offer("c", 0.2, kNaN)};

TEST(Trade, TheFrontHoldsWhatNobodyBeats) {
  EXPECT_EQ(pareto_front(kOffers), (std::vector<std::size_t>{0, 1, 4}));
}

TEST(Trade, AFastFailureNeverRanksFastest) {
  EXPECT_EQ(cheapest_within(kOffers, "", 1.0), 0u);
  EXPECT_EQ(cheapest_within(kOffers, "c", 1.0), std::nullopt);
  EXPECT_EQ(best_within(kOffers, "", 0.5), std::nullopt);
}

TEST(Trade, ALevelIsReachedByTheCheapestThatMeetsIt) {
  EXPECT_EQ(cheapest_within(kOffers, "a", 0.02), 1u);
  EXPECT_EQ(cheapest_within(kOffers, "b", 0.02), 3u);
  EXPECT_EQ(cheapest_within(kOffers, "a", 0.01), std::nullopt);  // never reached
}

TEST(Trade, ABudgetBuysTheSmallestError) {
  EXPECT_EQ(best_within(kOffers, "", 3.5), 1u);  // b's equal error costs more
  EXPECT_EQ(best_within(kOffers, "b", 100), 4u);
}

TEST(Trade, AnExactZeroIsAnOffer) {
  const std::vector<Offer> offers{offer("a", 1, 0.1), offer("a", 2, 0.0)};
  EXPECT_EQ(cheapest_within(offers, "", 0), 1u);
}

}  // namespace
}  // namespace taut
