#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/solver/simd/kernels.hpp"

namespace taut {

/// L D L^T factor of a sparse symmetric positive definite matrix of blocks. The order of
/// elimination keeps L sparse: minimum degree, then a postorder of its elimination tree.
/// Neighbouring columns of L with nearly the same rows form a panel, which is stored and computed
/// as a dense matrix, row after row:
///
///     d           own rows, with the inverse of D on the diagonal
///     l d
///     l l d
///     l l l       rows below; 0 where a column has no entry of its own
///     l l l
///
/// Panels are factored one after another. The update that a panel leaves for the rows below is
/// added to the panel of the first of them (multifrontal: Duff, Reid, ACM TOMS 9, 1983). Every
/// instruction set gives the same bits.
class PanelFactor {
 public:
  using Pair = std::array<int, 2>;
  PanelFactor() = default;
  /// A matrix of zeros with a block of `block` x `block` numbers for every unknown and for every
  /// pair of unknowns in `pairs`.
  PanelFactor(std::size_t unknowns, std::span<const Pair> pairs, int block, Simd);

  std::size_t unknowns() const { return order_.size(); }
  /// The unknowns in the order of elimination. All rows and columns below count in this order.
  const std::vector<int>& order() const { return order_; }

  /// Number (r, c) of the block in this row and column; (r, c + 1) comes after it. Preconditions:
  /// the matrix has the block; row > column, or row = column and r >= c.
  double* at(std::size_t row, std::size_t column, std::size_t r = 0, std::size_t c = 0);
  void clear();  ///< sets the matrix to 0
  /// Turns the matrix into its factor. Returns false, without a factor, if the matrix is not
  /// positive definite in double precision.
  bool factor();

  /// Solves in place for four right-hand sides, which lie side by side in every row. Precondition:
  /// block is 1.
  void solve_four(double* rows) const;
  /// Solves in place for one right-hand side of [unknowns * block] numbers.
  void solve_one(double* rows) const;

  std::size_t entries() const { return values_.size(); }
  std::size_t bytes() const;

 private:
  std::size_t columns_of(const FactorPanel& p) const { return p.columns * block_; }
  std::size_t rows_below(const FactorPanel& p) const { return p.rows * block_; }
  /// Side of the square that is a panel's update of the rows below.
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
  std::vector<std::uint32_t> row_;       ///< rows below, panel after panel
  std::vector<std::uint32_t> place_;     ///< [row_] its position among the rows of the parent
  std::vector<std::uint32_t> children_;  ///< [panels] number of children
  std::vector<double> values_;           ///< [panels][rows][columns]
  std::vector<double> updates_;          ///< updates of panels whose parent is yet to come
  std::vector<double> scratch_;
};

}  // namespace taut
