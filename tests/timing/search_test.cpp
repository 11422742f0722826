// The search behind `taut advise` with solvers whose error and cost are formulas.
#include "experiments/timing/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/model/solver.hpp"

namespace taut::timing_search_test {
namespace {

/// Model of stiff links: error = 1 / (n^2 k), cost = n (a + k).
struct Formula {
  double overhead = 0.5;
  int runs = 0;
  int most = 1000;

  std::optional<Candidate> operator()(const std::string& setting) {
    if (++runs > most) return {};
    const SolverChoice choice = parse_solver(setting);
    const double n = choice.params.integer("substeps"), k = choice.params.integer("iterations");
    const double cost = n * (overhead + k), error = 1 / (n * n * k);
    const bool explodes = n * k < 4;
    return Candidate{std::string(choice.entry->name),
                     setting,
                     {1e-6 / cost, cost, 1e6 / cost},  // only the middle of the interval counts
                     explodes ? std::nan("") : error,
                     explodes ? "exploded" : ""};
  }

  /// Cost of the best setting of a full grid of 1024 x 128 runs.
  double cheapest(double error) const {
    double best = 1e300;
    for (int n = 1; n <= 1024; ++n)
      for (int k = 1; k <= 128; ++k)
        if (n * k >= 4 && 1.0 / (n * n * k) <= error) best = std::min(best, n * (overhead + k));
    return best;
  }
};

Candidate best_of(const std::vector<Candidate>& tried, const Target& target) {
  return *std::min_element(tried.begin(), tried.end(), [&](const Candidate& a, const Candidate& b) {
    return target.prefers(a, b);
  });
}

constexpr const char* kPlain = "xpbd:precision=double";

TEST(Search, FindsNearlyWhatAFullGridWouldFind) {
  for (const double overhead : {0.1, 1.0, 10.0})
    for (const double error : {0.1, 0.01, 1e-3, 1e-4}) {
      Formula formula{overhead};
      const Target target{error, {}};
      const Candidate best = best_of(search_settings(kPlain, target, std::ref(formula)), target);
      EXPECT_TRUE(target.meets(best));
      EXPECT_LE(best.cost.mid, 1.25 * formula.cheapest(error)) << overhead << " " << error;
      EXPECT_LE(formula.runs, 40);
    }
}

TEST(Search, StartsWhereTheErrorIsExpected) {
  for (const double error : {0.01, 1e-3, 1e-4}) {
    Formula alone, told, misled;
    const Target target{error, {}};
    search_settings(kPlain, target, std::ref(alone));
    const auto expected = [](double factor) {
      return [factor](const std::string& setting, double wanted) -> std::optional<int> {
        const auto k = parse_solver(setting).params.integer("iterations");
        return std::max(1, static_cast<int>(std::ceil(factor / std::sqrt(wanted * k))));
      };
    };
    const auto of = [&](Formula& formula, double factor) {
      return best_of(search_settings(kPlain, target, std::ref(formula), {}, SearchDepth::refined,
                                     std::numeric_limits<double>::infinity(), expected(factor)),
                     target);
    };
    EXPECT_LE(of(told, 1).cost.mid, 1.25 * told.cheapest(error)) << error;
    EXPECT_LT(told.runs, alone.runs) << error;
    for (const double wrong : {0.3, 3.0}) {
      const Candidate best = of(misled, wrong);
      EXPECT_TRUE(target.meets(best));
      EXPECT_LE(best.cost.mid, 1.25 * misled.cheapest(error)) << error << " " << wrong;
    }
  }
}

TEST(Search, SpendsABudgetButNotMore) {
  Formula formula;
  const Target target{{}, 30};
  const Candidate best = best_of(search_settings(kPlain, target, std::ref(formula)), target);
  EXPECT_LE(best.cost.mid, 30);
  EXPECT_LE(best.error, 1.1 / (19 * 19));  // n = 20 at k = 1 fills the budget
  EXPECT_LE(formula.runs, 30);
}

TEST(Search, WhatNoSettingReachesMeetsNothing) {
  Formula formula;
  const Target target{0, {}};
  const auto tried = search_settings(kPlain, target, std::ref(formula));
  EXPECT_GT(tried.size(), 5u);
  for (const Candidate& o : tried) EXPECT_FALSE(target.meets(o)) << o.setting;
}

TEST(Search, ARivalThatIsFarCheaperEndsItEarly) {
  Formula alone, beaten;
  const Target target{1e-4, {}};
  search_settings(kPlain, target, std::ref(alone));
  search_settings(kPlain, target, std::ref(beaten), {{"other", "other", {0.1, 0.1, 0.1}, 1e-5}});
  EXPECT_LT(beaten.runs, alone.runs / 2);
}

TEST(Search, WithoutRefinementItOnlyDoubles) {
  Formula coarse, whole;
  const Target target{1e-3, {}};
  const auto columns = search_settings(kPlain, target, std::ref(coarse), {}, SearchDepth::columns);
  search_settings(kPlain, target, std::ref(whole));
  EXPECT_LT(coarse.runs, whole.runs);
  EXPECT_TRUE(target.meets(best_of(columns, target)));
  for (const Candidate& o : columns)
    for (const char* name : {"substeps", "iterations"})
      EXPECT_TRUE(
          std::has_single_bit(static_cast<unsigned>(parse_solver(o.setting).params.integer(name))))
          << o.setting;
}

TEST(Search, StopsWhenTimeIsUp) {
  Formula formula{.most = 3};
  EXPECT_EQ(search_settings(kPlain, {1e-4, {}}, std::ref(formula)).size(), 3u);
  EXPECT_EQ(formula.runs, 4);
}

TEST(Search, BeginsWithWhatCostsLeast) {
  const auto run = [](const std::string& setting) -> std::optional<Candidate> {
    EXPECT_TRUE(setting == "jakobsen:iterations=1,substeps=1" ||
                setting == "xpbd:substeps=4,iterations=1" ||
                setting == "mass-spring:shear=50,structural=50,substeps=1")
        << setting;
    const std::string solver = setting.substr(0, setting.find(':'));
    if (solver == "mass-spring") return {};  // the time is up
    const double cost = solver == "xpbd" ? 2 : 1;
    return Candidate{solver, setting, {cost, cost, cost}};
  };
  EXPECT_EQ(cheapest_first({"mass-spring", "xpbd:substeps=4", "jakobsen"}, run),
            (std::vector<std::string>{"jakobsen", "xpbd:substeps=4", "mass-spring"}));
}

/// Springs of stiffness K have an error of 20/K for any number of substeps, and stiffer springs
/// need more work.
TEST(Search, StiffensOnlySpringsThatCannotReachTheError) {
  const auto run = [](const std::string& setting) -> std::optional<Candidate> {
    const Params params = parse_solver(setting).params;
    EXPECT_EQ(params.real("structural"), params.real("shear")) << "both together";
    const double stiffness = params.real("structural");
    const double work = params.integer("substeps") * params.integer("iterations");
    return Candidate{"vbd", setting, {work, work, work}, 20 / stiffness + stiffness / 1e5 / work};
  };
  const auto stiffest = [&](double error) {
    double most = 0;
    for (const Candidate& o : search_settings("vbd", {error, {}}, run, {}, SearchDepth::columns))
      most = std::max(most, parse_solver(o.setting).params.real("structural"));
    return most;
  };
  EXPECT_EQ(stiffest(0.01), 10000) << "the default does";
  EXPECT_EQ(stiffest(0.001), 30000);
  const Target soft{0.02, {}};
  const Candidate best = best_of(search_settings("vbd", soft, run), soft);
  EXPECT_LT(parse_solver(best.setting).params.real("structural"), 10000) << "an alternative";
}

/// More sweeps only pay with the alternative penalty, which is better in itself.
TEST(Search, RepeatedItGoesOnFromWhatAnAlternativeMadeBest) {
  int runs = 0;
  const auto run = [&](const std::string& setting) -> std::optional<Candidate> {
    ++runs;
    const Params params = parse_solver(setting).params;
    const double n = params.integer("substeps"), k = params.integer("iterations");
    const bool fit = params.real("penalty") == 300;
    const double cost = n * (20 + k), error = 1 / (n * (fit ? 2 * k : 1));
    return Candidate{"admm", setting, {cost, cost, cost}, error};
  };
  const Target target{1.0 / 256, {}};
  const auto found = [&](SearchDepth depth) {
    return best_of(search_settings("admm", target, run, {}, depth), target);
  };
  const double once = found(SearchDepth::refined).cost.mid;
  const double again = found(SearchDepth::repeated).cost.mid;
  EXPECT_LT(again, 0.5 * once);
  EXPECT_LE(again, 1.3 * (20 + 128)) << "128 sweeps of one substep";
  EXPECT_LT(runs, 200) << "and it ends";
}

/// AVBD explodes at its default smallest stiffness: no setting reaches the error before that is
/// changed.
TEST(Search, RepeatedItTriesAlternatives) {
  const auto run = [](const std::string& setting) -> std::optional<Candidate> {
    const Params params = parse_solver(setting).params;
    const double work = params.integer("substeps") * params.integer("iterations");
    const bool stiff = params.real("k-min") == 100;
    return Candidate{"avbd", setting, {work, work, work}, stiff ? 1 / work : 1, ""};
  };
  const Target target{0.1, {}};
  EXPECT_FALSE(target.meets(best_of(search_settings("avbd", target, run), target)));
  EXPECT_TRUE(target.meets(
      best_of(search_settings("avbd", target, run, {}, SearchDepth::repeated), target)));
}

TEST(Search, LeavesAloneWhatTheUserFixed) {
  Formula formula;
  const auto tried =
      search_settings("xpbd:precision=double,iterations=2", {0.01, {}}, std::ref(formula));
  EXPECT_GT(tried.size(), 3u);
  for (const Candidate& o : tried)
    EXPECT_EQ(parse_solver(o.setting).params.integer("iterations"), 2) << o.setting;
}

}  // namespace
}  // namespace taut::timing_search_test
