// Relaxation line by line, and Chebyshev's semi-iteration, against closed forms on chains.
#include "core/solver/constraints/lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/cloths.hpp"

namespace taut::lines_test {
namespace {

/// Free masses along x whose link j has the strain 1e-3 strain(j). On a line every method is
/// linear.
template <class Strain>
Scene free_chain(int links, const Strain& strain) {
  Scene s = hanging_sheet(1, links + 1, {true, false, false}, Lumping::equal);
  s.pins.clear();
  s.gravity.setZero();
  double x = 0;
  for (int i = 0; i <= links; ++i) {
    s.start.x[static_cast<std::size_t>(i)] = {x, 0, 0};
    if (i < links) x += s.links[static_cast<std::size_t>(i)].rest * (1 + 1e-3 * strain(i));
  }
  return s;
}

/// Root mean square strain left after one step.
double left(const Scene& s, const std::string& solver) {
  const State end = simulate(s, solver, 1);
  double sum = 0;
  for (const Link& l : s.links)
    sum += std::pow(
        (end.x[static_cast<std::size_t>(l.b)] - end.x[static_cast<std::size_t>(l.a)]).norm() /
                l.rest -
            1,
        2);
  return std::sqrt(sum / static_cast<double>(s.links.size()));
}

std::string with_sweeps(const std::string& more, int sweeps) {
  return "jakobsen:substeps=1,precision=double,projection=exact,iterations=" +
         std::to_string(sweeps) + "," + more;
}

TEST(Chebyshev, OfJacobiFollowsItsRecurrenceAndItsRate) {
  constexpr int kLinks = 31;
  // spectral radius if all strains are relaxed at once (Jacobi)
  const double rho = std::cos(std::numbers::pi / (kLinks + 1));
  const Scene s = free_chain(
      kLinks, [&](int j) { return std::sin(std::numbers::pi * (j + 1) / (kLinks + 1)); });
  const double start = left(s, with_sweeps("method=jacobi", 0));
  EXPECT_NEAR(left(s, with_sweeps("method=jacobi", 40)) / start, std::pow(rho, 40), 1e-9);
  const std::string fast = "method=jacobi,chebyshev=" + std::to_string(rho);
  double before = 1, now = rho, omega = 1;
  for (int k = 2; k <= 60; ++k) {
    omega = k < 3 ? 1 : k == 3 ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * omega);
    const double next = k < 3 ? rho * now : omega * (rho * now - before) + before;
    before = now;
    now = next;
  }
  EXPECT_NEAR(left(s, with_sweeps(fast, 60)) / start, now, 1e-3 * now);
  const double rate = rho / (1 + std::sqrt(1 - rho * rho));
  EXPECT_NEAR(left(s, with_sweeps(fast, 141)) / left(s, with_sweeps(fast, 140)), rate, 0.01 * rate);
}

TEST(Chebyshev, OfColouredGaussSeidelHasTheRateOfRhoSquared) {
  constexpr int kLinks = 31;
  const double rho = std::pow(std::cos(std::numbers::pi / (kLinks + 1)), 2);
  const Scene s = free_chain(kLinks, [](int j) { return 1 + 0.3 * (j % 5); });
  const auto rate = [&](const std::string& more, int from, int to) {
    return std::pow(left(s, with_sweeps(more, to)) / left(s, with_sweeps(more, from)),
                    1.0 / (to - from));
  };
  EXPECT_NEAR(rate("order=coloured", 200, 300), rho, 1e-3);
  const double fast = rho / (1 + std::sqrt(1 - rho * rho));
  EXPECT_NEAR(rate("order=coloured,chebyshev=" + std::to_string(rho), 90, 140), fast, 0.01 * fast);
}

TEST(Lines, AStraightChainOfAnyMassesIsRightAfterOneSweep) {
  Scene s = free_chain(40, [](int j) { return 1 + 0.3 * (j % 5); });
  for (std::size_t i = 0; i < s.mesh.mass.size(); ++i)
    s.mesh.mass[i] *= 1 + static_cast<double>(i % 3);
  EXPECT_LT(left(s, with_sweeps("method=lines", 1)), 1e-5 * left(s, with_sweeps("order=mesh", 0)));
  EXPECT_GT(left(s, with_sweeps("order=mesh", 20)), 0.3 * left(s, with_sweeps("order=mesh", 0)));
}

TEST(Lines, AStraightChainBetweenPinsSharesItsStretch) {
  for (const auto& [precision, near] : {std::pair("float", 1e-4), std::pair("double", 1e-6)}) {
    Scene s = hanging_sheet(1, 13, {true, false, false});
    s.pins = {0, 12};
    s.gravity.setZero();
    for (Vec3& x : s.start.x) x *= 1.01;
    s.start.x[5].y() += 2e-3;
    const State end = simulate(s, std::string("jakobsen:method=lines,precision=") + precision, 20);
    for (std::size_t i = 0; i < 13; ++i)
      EXPECT_LT((end.x[i] - Vec3(0, -1.01 * static_cast<double>(i) / 12, 0)).norm(), near)
          << precision << ' ' << i;
  }
}

/// Chain on one pin with nearly all of its weight at the free end: the tension is constant along
/// it.
Scene weighted_chain() {
  Scene s = hanging_sheet(1, 33, {true, false, false}, Lumping::equal);
  s.mesh.mass.back() *= 1e6;
  for (std::size_t i = 1; i + 1 < s.start.x.size(); ++i)
    s.start.x[i].x() = i % 2 == 0 ? 1e-9 : -1e-9;
  return s;
}

TEST(Lines, AreStableUpToAThirdAsTheoryHasIt) {
  Scene s = weighted_chain();
  const double limit = s.dt * std::sqrt(kLargestLineTension / line_tension(s, s.dt));
  const auto width = [&](double factor) {
    s.dt = factor * limit;
    const State end = simulate(s, with_sweeps("method=lines", 1), 300);
    double most = 0;
    for (const Vec3& x : end.x) most = std::max(most, std::abs(x.x()));
    return most;
  };
  EXPECT_LT(width(0.98), 1e-7);
  EXPECT_GT(width(1.03), 1e-6);
}

TEST(Lines, AreRefusedWithoutAGridAndBeyondTheirLimit) {
  const SolverChoice choice = parse_solver("jakobsen:method=lines");
  const auto reasons = [&](const Scene& s) { return choice.entry->unsupported(s, choice.params); };
  Scene s = hanging_sheet(9, 9);
  EXPECT_TRUE(reasons(s).empty());
  s.mesh.grid.reset();
  ASSERT_EQ(reasons(s).size(), 1u);
  EXPECT_NE(reasons(s)[0].find("a grid"), std::string::npos);
  s = weighted_chain();
  ASSERT_EQ(reasons(s).size(), 1u);
  EXPECT_NE(reasons(s)[0].find("above 1/3"), std::string::npos) << reasons(s)[0];
  // The number of substeps in the message is the smallest that is accepted.
  const std::string said = reasons(s)[0].substr(reasons(s)[0].find("substeps="));
  const int enough = std::stoi(said.substr(9));
  const auto taken = [&](int substeps) {
    const SolverChoice with =
        parse_solver("jakobsen:precision=double,method=lines,substeps=" + std::to_string(substeps));
    return with.entry->unsupported(s, with.params).empty();
  };
  EXPECT_TRUE(taken(enough)) << said;
  EXPECT_FALSE(taken(enough - 1)) << said;
}

TEST(Lines, AndChebyshevAreCountedAsWhatTheyDo) {
  Scene s = hanging_sheet(9, 9);
  s.pins = {0, 1, 2, 3, 4, 5, 6, 7, 8};  // the upper row; its links do not move
  const auto costs_of = [&](const std::string& solver) {
    const SolverChoice choice = parse_solver(solver);
    return choice.entry->make(s, choice.params)->step_cost();
  };
  const auto projections = [&](const std::string& solver) {
    std::size_t count = 0;
    for (const PassCost& cost : costs_of(solver))
      if (cost.projections) count += cost.items * cost.repeats;
    return count;
  };
  EXPECT_EQ(projections("jakobsen:substeps=9,method=lines"), projections("jakobsen:substeps=9"));
  for (const std::string solver : {"jakobsen:order=mesh,chebyshev=0.9", "pd:chebyshev=0.9"}) {
    const auto costs = costs_of(solver);
    const auto one = std::ranges::find(costs, "Chebyshev", &PassCost::pass);
    ASSERT_NE(one, costs.end()) << solver;
    EXPECT_EQ(one->items, 81u) << solver;
    EXPECT_GE(one->bytes, 2 * 81 * 3 * sizeof(float)) << solver;
  }
}

TEST(Lines, AndChebyshevHaveTheSameBitsEverywhere) {
  const Scene s = crumpled(hanging_sheet(31, 33), 0.01);
  for (const std::string how : {"method=lines", "chebyshev=0.9", "chebyshev=0.9,layout=batches",
                                "method=jacobi-underrelaxed,chebyshev=0.9"})
    for (const std::string precision : {"float", "double"}) {
      const std::string solver = "jakobsen:" + how + ",precision=" + precision;
      const State one = simulate(s, solver + ",simd=scalar", 5);
      for (const char* other : {",simd=auto", ",threads=2", ",threads=5"})
        EXPECT_EQ(largest_distance(one.x, simulate(s, solver + other, 5).x), 0) << solver << other;
    }
}

TEST(Lines, TakeNoOmega) {
  const Scene s = hanging_sheet(9, 9);
  const auto reasons = [&](const std::string& solver) {
    const SolverChoice choice = parse_solver(solver);
    return choice.entry->unsupported(s, choice.params);
  };
  EXPECT_TRUE(reasons("jakobsen:method=lines,substeps=50").empty());
  EXPECT_EQ(reasons("jakobsen:method=lines,substeps=50,omega=1.3"),
            std::vector<std::string>{
                "method=lines solves its links at once, without omega: leave it at 1"});
}

/// Linear stability theory does not cover accelerators, and the solver says so.
TEST(Accelerators, HaveNoTheory) {
  const Scene s = hanging_sheet(9, 9);
  const auto known = [&](const std::string& more) {
    const SolverChoice choice = parse_solver("jakobsen:order=mesh" + more);
    return !std::holds_alternative<std::monostate>(choice.entry->linear_model(s, choice.params));
  };
  EXPECT_TRUE(known(""));
  for (const char* more : {",levels=3", ",tethers=on", ",chebyshev=0.9", ",method=lines"})
    EXPECT_FALSE(known(more)) << more;
}

}  // namespace
}  // namespace taut::lines_test
