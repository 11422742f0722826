// The sparse factor against a dense one.
#include "core/solver/panel_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

namespace taut::panel_factor_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Random block matrix in the order of elimination, with a diagonal that makes it positive
/// definite.
struct Problem {
  std::vector<PanelFactor::Pair> pairs;
  std::size_t unknowns;
  int block;

  /// Grid with scrambled numbers, and a few pairs of distant unknowns.
  Problem(int columns, int rows, int of_block)
      : unknowns(static_cast<std::size_t>(columns * rows)), block(of_block) {
    const int n = columns * rows;
    const auto at = [&](int i, int j) { return (7 * (j * columns + i) + 3) % n; };
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        if (i + 1 < columns) pairs.push_back({at(i, j), at(i + 1, j)});
        if (j + 1 < rows) pairs.push_back({at(i, j + 1), at(i, j)});
        if (i + 1 < columns && j + 1 < rows) pairs.push_back({at(i, j), at(i + 1, j + 1)});
      }
    pairs.push_back({at(0, 0), at(columns - 1, rows - 1)});
    pairs.push_back(pairs.front());
  }

  MatrixXd fill(PanelFactor& factor, double diagonal) const {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<std::size_t> rank(unknowns);
    for (std::size_t k = 0; k < unknowns; ++k)
      rank[static_cast<std::size_t>(factor.order()[k])] = k;
    const auto b = static_cast<std::size_t>(block);
    MatrixXd dense =
        MatrixXd::Zero(static_cast<Index>(unknowns * b), static_cast<Index>(unknowns * b));
    factor.clear();
    const auto add = [&](std::size_t row, std::size_t column) {
      for (std::size_t r = 0; r < b; ++r)
        for (std::size_t c = 0; c < (row == column ? r + 1 : b); ++c) {
          double value = number(random);
          if (row == column && r == c) value = diagonal;
          *factor.at(row, column, r, c) += value;
          const auto i = static_cast<Index>(row * b + r), j = static_cast<Index>(column * b + c);
          dense(i, j) += value;
          if (i != j) dense(j, i) += value;
        }
    };
    for (std::size_t k = 0; k < unknowns; ++k) add(k, k);
    for (const auto& [i, j] : pairs) {
      const auto [low, high] =
          std::minmax(rank[static_cast<std::size_t>(i)], rank[static_cast<std::size_t>(j)]);
      add(high, low);
    }
    return dense;
  }
};

std::vector<Simd> all_available() {
  std::vector<Simd> all;
  for (const Simd simd : {Simd::scalar, Simd::sse2, Simd::avx2, Simd::avx512})
    if (available(simd)) all.push_back(simd);
  return all;
}

TEST(PanelFactor, SolvesWhatADenseFactorSolves) {
  for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 30}, {9, 11}, {23, 20}}) {
    const Problem problem(columns, rows, 1);
    std::vector<double> first;
    for (const Simd simd : all_available()) {
      PanelFactor factor(problem.unknowns, problem.pairs, 1, simd);
      for (int again = 0; again < 2; ++again) {  // one factor is used for several matrices
        const MatrixXd dense = problem.fill(factor, 9 + again);
        ASSERT_TRUE(factor.factor());
        std::vector<double> rows_of_four(4 * problem.unknowns);
        for (std::size_t i = 0; i < rows_of_four.size(); ++i)
          rows_of_four[i] = static_cast<double>((i * i) % 17) - 8;
        const MatrixXd right =
            Eigen::Map<const MatrixXd>(rows_of_four.data(), 4, static_cast<Index>(problem.unknowns))
                .transpose();
        factor.solve_four(rows_of_four.data());
        const MatrixXd mine =
            Eigen::Map<const MatrixXd>(rows_of_four.data(), 4, static_cast<Index>(problem.unknowns))
                .transpose();
        const MatrixXd want = dense.ldlt().solve(right);
        EXPECT_LT((mine - want).norm(), 1e-13 * want.norm()) << columns << ' ' << rows;
        if (again == 0) continue;
        if (first.empty()) first = rows_of_four;
        EXPECT_EQ(rows_of_four, first) << to_string(simd);
      }
    }
  }
}

TEST(PanelFactor, SolvesMatricesOfBlocks) {
  for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 30}, {9, 11}, {17, 13}}) {
    const Problem problem(columns, rows, 3);
    std::vector<double> first;
    for (const Simd simd : all_available()) {
      PanelFactor factor(problem.unknowns, problem.pairs, 3, simd);
      const MatrixXd dense = problem.fill(factor, 25);
      ASSERT_TRUE(factor.factor());
      std::vector<double> x(3 * problem.unknowns);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>((i * i) % 17) - 8;
      const VectorXd right = Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()));
      factor.solve_one(x.data());
      const VectorXd mine = Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()));
      const VectorXd want = dense.ldlt().solve(right);
      EXPECT_LT((mine - want).norm(), 1e-13 * want.norm()) << columns << ' ' << rows;
      if (first.empty()) first = x;
      EXPECT_EQ(x, first) << to_string(simd);
    }
  }
}

TEST(PanelFactor, SaysWhereThereIsNone) {
  for (const int block : {1, 3}) {
    const Problem problem(6, 5, block);
    PanelFactor factor(problem.unknowns, problem.pairs, block, Simd::scalar);
    problem.fill(factor, 0.1);
    EXPECT_FALSE(factor.factor());
    problem.fill(factor, 30);
    EXPECT_TRUE(factor.factor());
  }
}

/// Minimum degree ordering; in row order a grid of 30 x 30 has 31 entries per column.
TEST(PanelFactor, KeepsItsFactorSparse) {
  const Problem problem(30, 30, 1);
  EXPECT_LT(PanelFactor(problem.unknowns, problem.pairs, 1, Simd::scalar).entries(), 20u * 900);
}

}  // namespace
}  // namespace taut::panel_factor_test
