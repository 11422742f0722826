// Costs measured on two hosts: each host keeps its own, without pooling or comparison across hosts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/model/solver.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/report.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"

namespace taut::report::hosts_test {
namespace {

Study two_cases() {
  Study study;
  study.name = "made-up";
  study.question = "?";
  study.scenes = {"hang"};
  study.solvers = {"jakobsen", "bullet"};
  study.settings = {"cloth.grid=[4, 4]", "time.duration=0.1"};
  return study;
}

/// Two cases in a store, timed on one host per given cost of a step [s].
class Timed {
 public:
  explicit Timed(const std::vector<std::pair<std::string, double>>& hosts)
      : store(scratch.path() / "results") {
    store.prepare();
    std::vector<Record> records;
    for (const Case& one : cases_of(study)) {
      records.push_back(run_case(one, {}).record);
      store.commit(records.back());
    }
    for (const auto& [host, seconds] : hosts) {
      StudyBench session = StudyBench::here(study.name);
      if (!host.empty()) {
        session.host = host;
        session.machine = "the processor of " + host;
      }
      SceneBench scene{"hang", {0.99, 1, 1.01}, {}};
      for (std::size_t i = 0; i < records.size(); ++i) {
        const std::vector<double> samples(10, seconds * static_cast<double>(i + 1));
        scene.cases.push_back({records[i], {samples, samples, 4096, "", ""}});
      }
      session.scenes = {scene};
      keep(store, session);
    }
  }
  /// CPU seconds per step of each case in the model of the page.
  std::vector<double> costs() const {
    const auto model = nlohmann::json::parse(make_model(stored_results({study}, store)));
    std::vector<double> all;
    for (const auto& one : model["cases"]) all.push_back(one["cost"]["cpu.per_step"]["mid"]);
    return all;
  }

  const Scratch scratch;
  const Study study = two_cases();
  Store store;
};

TEST(Hosts, TheModelHasTheCostOfOneHostAndNamesTheOthers) {
  const Timed both({{"zeus", 5e-3}, {"", 1e-3}, {"ares", 9e-3}});
  EXPECT_EQ(both.costs(), (std::vector{1e-3, 2e-3})) << "of this host, whatever others measured";
  const ReportInput input = stored_results({both.study}, both.store);
  EXPECT_EQ(input.bench->machine, StudyBench::here("").machine);
  ASSERT_EQ(input.bench->scenes.size(), 1u);
  EXPECT_TRUE(input.bench->scenes[0].limits) << "without them no case can win anything";
  ASSERT_EQ(input.cost_hosts.size(), 3u);
  EXPECT_NE(input.cost_hosts[0].find("; shown"), std::string::npos);
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
    EXPECT_TRUE(input.cost_hosts[i].starts_with(i == 1 ? "ares" : "zeus"));
    EXPECT_NE(input.cost_hosts[i].find("not shown and not pooled"), std::string::npos);
  }
  EXPECT_EQ(Timed({{"zeus", 5e-3}, {"ares", 9e-3}}).costs(), (std::vector{9e-3, 18e-3}))
      << "of one other host, if this one has none";
}

TEST(Hosts, TwoFoldersAreComparedInCostHostByHost) {
  const Timed a({{"zeus", 5e-3}, {"ares", 9e-3}}), b({{"zeus", 4e-3}}), c({{"", 1e-3}});
  const auto pairs = stored_differences(a.store, b.store).timed;
  ASSERT_EQ(pairs.size(), 2u);
  for (const auto& [before, after] : pairs)
    EXPECT_NEAR(after.timing.samples[0] / before.timing.samples[0], 0.8, 1e-12);
  EXPECT_TRUE(stored_differences(a.store, c.store).timed.empty());
}

}  // namespace
}  // namespace taut::report::hosts_test
