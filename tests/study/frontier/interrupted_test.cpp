// An interrupted search for frontiers says so and stores nothing.
#include <gtest/gtest.h>

#include <csignal>

#include "experiments/results/session.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/signals.hpp"

namespace taut::interrupted_test {
namespace {

/// Returns 0 if the search was interrupted and stored nothing, 1 if it returned frontiers, 2 if it
/// stored results.
int search(CampaignOptions options, bool signal) {
  const Scratch scratch;
  Store store(scratch.path() / "results");
  store.prepare();
  static const GracefulStop stop;  // the signal may arrive after the search has ended
  if (signal) raise(SIGTERM);
  const auto found =
      find_frontiers("xpbd:substeps=2", store, options, [](std::size_t, std::size_t) {});
  return found ? 1 : !store.keys().empty() ? 2 : 0;
}

TEST(FrontiersDeathTest, AreInterruptedByASignal) {
  EXPECT_EXIT(_exit(search({}, true)), testing::ExitedWithCode(0), "");
}

TEST(Frontiers, AreInterruptedIfTheirTimeIsUp) {
  CampaignOptions options;
  options.deadline = SteadyClock::now();
  EXPECT_EQ(search(options, false), 0);
}

}  // namespace
}  // namespace taut::interrupted_test
