// A search for extremes that is ended early says so and keeps nothing.
#include <gtest/gtest.h>

#include <csignal>

#include "experiments/study/extremes/extremes.hpp"
#include "experiments/study/session.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/signals.hpp"

namespace taut::interrupted_test {
namespace {

/// 0: nothing was found and it says that it was interrupted; else what is wrong.
int search(CampaignOptions options, bool signal) {
  const Scratch scratch;
  const Store store(scratch.path() / "results");
  store.prepare();
  const GracefulStop stop;
  if (signal) raise(SIGTERM);
  const Extremes found = find_extremes("xpbd:substeps=2", store, Session(store, "a test", {}, {}),
                                       options, [](std::size_t, std::size_t) {});
  return !found.interrupted ? 1 : !store.keys().empty() ? 2 : 0;
}

TEST(ExtremesDeathTest, AreInterruptedByASignal) {
  EXPECT_EXIT(_exit(search({}, true)), testing::ExitedWithCode(0), "");
}

TEST(Extremes, AreInterruptedIfTheirTimeIsUp) {
  CampaignOptions options;
  options.deadline = SteadyClock::now();
  EXPECT_EQ(search(options, false), 0);
}

}  // namespace
}  // namespace taut::interrupted_test
