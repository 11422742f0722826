// The conformance suite names the errors that are planted in a toy solver, and finds none in the
// sound toy, which claims all but bending.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/external/external.hpp"
#include "experiments/external/program.hpp"
#include "experiments/truths/verify.hpp"
#include "tests/conformance/planted.hpp"

namespace taut::conformance_test {
namespace {

/// At least so many of the errors are named: one less fails.
constexpr std::size_t kNamed = 82;

std::vector<const TruthEntry*> suite() {
  std::vector<const TruthEntry*> all = truths_in_order();
  std::erase_if(all, [](const TruthEntry* t) { return t->phenomenon.empty(); });
  return all;
}

class Conformance : public testing::Test {
 protected:
  void SetUp() override {
    external::enable();
    external::run_unprobed();
  }
  void TearDown() override {
    external::set_probe_required(true);
    set_solver_source({});
  }
  static std::string toy(std::string_view fault) {
    const std::string program = TAUT_BINARY_DIR "/tests/taut_planted_solver";
    std::string text = "external:cmd='" + program + "',fault=" + std::string(fault);
    admit_solver(text);
    return text;
  }
  /// The phenomenon of the first test that a solver fails; "": it passes all.
  static std::string first_failed(const std::string& solver) {
    for (const TruthEntry* test : suite()) {
      Findings findings({solver});
      test->check(findings);
      if (std::ranges::count(findings.all(), TruthVerdict::broken, &Finding::verdict) > 0)
        return std::string(test->phenomenon);
    }
    return "";
  }
};

TEST_F(Conformance, EachPhenomenonHasOneTest) {
  std::set<std::string_view> phenomena;
  for (const TruthEntry* test : suite())
    EXPECT_TRUE(phenomena.insert(test->phenomenon).second) << test->phenomenon;
  EXPECT_GE(phenomena.size(), 33u);
  for (const auto& [name, phenomenon] : kPlantedErrors)
    EXPECT_TRUE(phenomena.contains(phenomenon)) << name;
}

TEST_F(Conformance, TheSoundToyPassesAllThatItClaims) {
  const std::string solver = toy("none");
  for (const TruthEntry* test : suite()) {
    Findings findings({solver});
    test->check(findings);
    std::size_t compared = 0;
    for (const Finding& f : findings.all()) {
      EXPECT_NE(f.verdict, TruthVerdict::broken) << test->name << ": " << f.quantity;
      compared += f.verdict != TruthVerdict::not_applicable;
    }
    EXPECT_EQ(compared > 0, test->phenomenon != "elastica") << test->name;
  }
}

TEST_F(Conformance, NamesPlantedErrors) {
  std::size_t named = 0;
  for (const auto& [name, phenomenon] : kPlantedErrors) {
    const std::string failed = first_failed(toy(name));
    named += failed == phenomenon;
    if (failed != phenomenon)
      std::cout << name << ": " << (failed.empty() ? "not found" : failed) << " instead of "
                << phenomenon << '\n';
  }
  std::cout << named << " of " << kPlantedErrors.size() << " errors are named\n";
  EXPECT_GE(named, kNamed);
}

}  // namespace
}  // namespace taut::conformance_test
