#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/solver/simd/kernels.hpp"

namespace taut {

/// L D L^T of a sparse symmetric positive definite matrix of blocks, in an order of elimination
/// that keeps L sparse: minimum degree, then a postorder of its elimination tree. Neighbouring
/// columns of L with nearly the same rows are a panel, which is stored and computed as a dense
/// matrix, row after row:
///
///     d           own rows, with the inverse of D on the diagonal
///     l d
///     l l d
///     l l l       rows below; 0 where a column has no entry of its own
///     l l l
///
/// Panels are factored one after the other; what each leaves for the rows below is added up in the
/// panel of the first of them (multifrontal: Duff, Reid, ACM TOMS 9, 1983). Every instruction set
/// gives the same bits.
class PanelFactor {
 public:
  using Pair = std::array<int, 2>;
  PanelFactor() = default;
  /// Of a matrix of 0 with a block of `block` x `block` numbers for every unknown and wherever one
  /// of `pairs` joins two.
  PanelFactor(std::size_t unknowns, std::span<const Pair> pairs, int block, Simd);

  std::size_t unknowns() const { return order_.size(); }
  /// The unknown that is eliminated k-th. All that follows counts in this order.
  const std::vector<int>& order() const { return order_; }

  /// Number (r, c) of the block in this row and column; row > column, or both the same and r >= c.
  /// (r, c + 1) comes after it. Precondition: the matrix has the block.
  double* at(std::size_t row, std::size_t column, std::size_t r = 0, std::size_t c = 0);
  void clear();  ///< the matrix is 0
  /// The matrix becomes its factor. False: it is not positive definite in double precision, and
  /// there is no factor.
  bool factor();

  /// Four right-hand sides beside each other in every row become the solutions. Block 1.
  void solve_four(double* rows) const;
  /// [unknowns * block] numbers, the right-hand side, become the solution.
  void solve_one(double* rows) const;

  std::size_t entries() const { return values_.size(); }
  std::size_t bytes() const;

 private:
  std::size_t columns_of(const FactorPanel& p) const { return p.columns * block_; }
  std::size_t rows_below(const FactorPanel& p) const { return p.rows * block_; }
  /// Of what a panel leaves for the rows below: a square.
  std::size_t side_of_update(const FactorPanel& p) const { return (rows_below(p) + 7) / 8 * 8; }
  std::size_t size_of_update(const FactorPanel& p) const {
    return side_of_update(p) * side_of_update(p);
  }
  void make_panels(std::span<const Pair> pairs);
  void find_parents();
  void add_update(const FactorPanel& child, const double* of_child, const FactorPanel&,
                  double* update);

  std::size_t block_ = 1;
  Simd simd_ = Simd::scalar;
  std::vector<int> order_;
  std::vector<FactorPanel> panels_;
  std::vector<std::uint32_t> panel_of_;  ///< [unknowns]
  std::vector<std::uint32_t> row_;       ///< of each row below, panel after panel
  std::vector<std::uint32_t> place_;     ///< [row_] its place among those of the parent
  std::vector<std::uint32_t> children_;  ///< [panels] how many
  std::vector<double> values_;           ///< [panels][rows][columns]
  std::vector<double> updates_;          ///< of panels whose parent has not come yet
  std::vector<double> scratch_;
};

}  // namespace taut
