// Path of the search behind `taut advise`, step by step as its header describes it, for costs and
// errors given by formulas. Every setting below was worked out by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/solver.hpp"
#include "experiments/timing/search.hpp"

namespace taut::search_path_test {
namespace {

struct Setting {
  double n;  ///< substeps
  double k;  ///< sweeps, or a stiffness
  bool in_double;
};
struct Outcome {
  double cost, error;  ///< NaN: the run explodes
};
using Law = std::function<Outcome(const Setting&)>;

/// Settings tried, as "substeps/sweeps"; a d is appended if the search itself chose double.
std::string way(const std::string& solver, const Target& target, const Law& law,
                std::vector<Candidate> known = {}) {
  const bool fixed = solver.find("precision") != std::string::npos;
  std::string all;
  const auto run = [&](const std::string& text) -> std::optional<Candidate> {
    const SolverChoice choice = parse_solver(text);
    const bool springs = choice.entry->name == std::string_view("mass-spring");
    const Setting one{static_cast<double>(choice.params.integer("substeps")),
                      springs ? choice.params.real("structural")
                              : static_cast<double>(choice.params.integer("iterations")),
                      choice.params.is("precision", "double")};
    EXPECT_TRUE(!springs || choice.params.real("shear") == one.k) << "both are stiffened together";
    all += (all.empty() ? "" : " ") + std::to_string(static_cast<int>(one.n)) + "/" +
           std::to_string(static_cast<int>(one.k)) + (one.in_double && !fixed ? "d" : "");
    const Outcome is = law(one);
    return Candidate{std::string(choice.entry->name),
                     text,
                     {is.cost / 7, is.cost, 9 * is.cost},
                     is.error,
                     std::isnan(is.error) ? "exploded" : ""};
  };
  search_settings(solver, target, run, std::move(known));
  return all;
}

Target within(double error) { return {error, {}}; }
Target budget(double cost) { return {{}, cost}; }

/// Model of stiff links: error 1/(n^2 k), cost n (overhead + k).
Law links(double overhead) {
  return [=](const Setting& s) { return Outcome{s.n * (overhead + s.k), 1 / (s.n * s.n * s.k)}; };
}

Candidate rival(double cost, double error) { return {"other", "other", {0, cost, 1e9}, error}; }

constexpr const char* kXpbd =
    "xpbd:method=sweeps,primal=off,order=coloured,tethers=off,precision=double";

// The target needs n^2 k = 100. The first column doubles. The second starts at half of the substeps
// found and goes down. So does the third, in which the next doubling would cost more than 1.3 times
// the best. Substeps of the two cheapest columns, 8/2 and 16/1, are then bisected.
TEST(SearchPath, ColumnsByDoublingThenBisection) {
  const std::string columns = "1/1 2/1 4/1 8/1 16/1 8/2 4/2 4/4", rest = " 6/2 7/2 12/1 10/1 9/1";
  EXPECT_EQ(way(kXpbd, within(0.01), links(0.5)), columns + rest);
  // The best costs 20 at this point: a rival that is ten times as cheap makes refinement pointless.
  EXPECT_EQ(way(kXpbd, within(0.01), links(0.5), {rival(1.9, 0.01)}), columns);
  EXPECT_EQ(way(kXpbd, within(0.01), links(0.5), {rival(2.1, 0.01)}), columns + rest);
  EXPECT_EQ(way(kXpbd, within(0.01), links(0.5), {rival(1.9, 0.011)}), columns + rest)
      << "one that is no rival";
}

// Where substeps are expensive more sweeps pay off. Settings that meet the error cost 176 (16/1),
// 96 (8/2), 112 (8/4) and 72 (4/8). The two cheapest columns are bisected, then the sweeps of the
// best setting.
TEST(SearchPath, TheTwoCheapestColumnsAreBisected) {
  EXPECT_EQ(way(kXpbd, within(0.01), links(10)),
            "1/1 2/1 4/1 8/1 16/1 8/2 4/2 4/4 8/4 4/8 2/8 2/16 3/8 6/2 7/2 4/6 4/7");
}

TEST(SearchPath, ACostThirtyTimesThatOfTheBestRivalIsNotPaid) {
  EXPECT_EQ(way(kXpbd, within(1e-4), links(0.5), {rival(5, 0), rival(1, 0)}),
            "1/1 2/1 4/1 8/1 16/1 8/2");
}

TEST(SearchPath, WithFixedSubstepsTheSweepsAloneAreSearched) {
  const Law law = [](const Setting& s) { return Outcome{s.k, 1 / s.k}; };
  EXPECT_EQ(
      way("xpbd:method=sweeps,primal=off,order=coloured,tethers=off,precision=double,substeps=4",
          within(0.11), law),
      "4/1 4/2 4/4 4/8 4/16 4/32 4/64 4/12 4/10 4/9")
      << "two columns without progress end it";
}

TEST(SearchPath, WithFixedSweepsTheSubstepsAreSearched) {
  const Law law = [](const Setting& s) { return Outcome{s.n, 1 / s.n}; };
  const std::string way_to_52 = "1/1 2/1 4/1 8/1 16/1 32/1 64/1 48/1 56/1 52/1";
  EXPECT_EQ(
      way("xpbd:method=sweeps,primal=off,order=coloured,tethers=off,iterations=1,precision=double",
          within(0.02), law),
      way_to_52);
  // Explosions below 48 substeps have no error, and do not tell whether more substeps help.
  const Law explosive = [](const Setting& s) {
    return Outcome{s.n, s.n < 48 ? std::nan("") : 1 / s.n};
  };
  EXPECT_EQ(
      way("xpbd:method=sweeps,primal=off,order=coloured,tethers=off,iterations=1,precision=double",
          within(0.02), explosive),
      way_to_52);
}

// The error has a floor at 0.3. Three doublings that gain less than a tenth end a column; two
// stiffnesses without a result end the search.
TEST(SearchPath, AFloorEndsAColumnAndTwoColumnsASearch) {
  const Law floor = [](const Setting& s) { return Outcome{s.n, std::max(1 / s.n, 0.3)}; };
  EXPECT_EQ(way("mass-spring:precision=double", within(0.1), floor),
            "1/50 2/50 4/50 8/50 16/50 32/50 1/200 2/200 4/200 8/200 16/200 32/200");
}

// Substeps fill 97 % of the budget, by the cost of settings already tried; at most four tries per
// column.
TEST(SearchPath, ABudgetIsFilledColumnByColumn) {
  EXPECT_EQ(way(kXpbd, budget(30), links(0.5)), "1/1 19/1 1/2 11/2 1/4 6/4");
  const auto one_column = [](const std::function<double(double)>& cost) {
    return way(
        "xpbd:method=sweeps,primal=off,order=coloured,tethers=off,precision=double,iterations=1",
        budget(30), [&](const Setting& s) {
          return Outcome{cost(s.n), 1 / s.n};
        });
  };
  EXPECT_EQ(one_column([](double n) { return n + n * n / 10; }), "1/1 26/1 8/1 16/1");
  EXPECT_EQ(one_column([](double n) { return 2 + n; }), "1/1 9/1 23/1")
      << "three more are less than 15 %";
  EXPECT_EQ(one_column([](double n) { return 1e-4 * n; }), "1/1 1024/1");
  EXPECT_EQ(one_column([](double n) { return 40 * n; }), "1/1");
}

/// Path if float costs n with an error of 1/n, and double has `cost` and `error` times as much.
std::string way_with_double(const Target& target, double cost, double error) {
  return way("xpbd:method=sweeps,primal=off,order=coloured,tethers=off,iterations=1", target,
             [=](const Setting& s) {
               return Outcome{s.n * (s.in_double ? cost : 1), (s.in_double ? error : 1) / s.n};
             });
}

TEST(SearchPath, AnAlternativeGetsAsManySubstepsAsItNeeds) {
  const std::string way_to_52 = "1/1 2/1 4/1 8/1 16/1 32/1 64/1 48/1 56/1 52/1";
  EXPECT_EQ(way_with_double(within(0.02), 1.2, 0.5), way_to_52 + " 52/1d 39/1d 29/1d 21/1d")
      << "three quarters while it is good enough";
  EXPECT_EQ(way_with_double(within(0.02), 0.25, 2), way_to_52 + " 52/1d 69/1d 92/1d 122/1d")
      << "a third more while that is cheaper";
  EXPECT_EQ(way_with_double(within(0.02), 0.75, 2), way_to_52 + " 52/1d")
      << "1.4 times its cost is more than the best's";
  EXPECT_EQ(way_with_double(budget(30), 0.5, 0.5), "1/1 29/1 29/1d 1/1d 58/1d");
  EXPECT_EQ(way_with_double(budget(30), 0.82, 0.5), "1/1 29/1 29/1d 1/1d 35/1d");
  EXPECT_EQ(way_with_double(budget(30), 0.84, 0.5), "1/1 29/1 29/1d")
      << "more than 80 % of the budget are spent";
}

}  // namespace
}  // namespace taut::search_path_test
