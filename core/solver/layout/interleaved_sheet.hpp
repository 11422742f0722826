#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/model/mesh.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// A grid as it is laid out: its columns are cut into strips. across: these columns are the grid's
/// rows.
struct SheetSides {
  int columns = 0, rows = 0;
  bool across = false;
  int reach = 1;  ///< most columns between the ends of a link
  int size() const { return columns * rows; }
  /// The vertex in column i of row j; column() and row() are its inverse.
  int index(int i, int j) const { return across ? i * rows + j : j * columns + i; }
  int column(int v) const { return across ? v / rows : v % columns; }
  int row(int v) const { return across ? v % rows : v / columns; }
};

/// The links of a regular sheet: all links of each direction that is present, with one length for
/// each direction.
struct RegularLinks {
  struct Direction {
    int columns = 0, rows = 0;  ///< from (i, j) to (i + columns, j + rows)
    Family family = Family::structural;
    double rest = 0;  ///< m
  };
  SheetSides grid;
  std::vector<Direction> directions;  ///< in the order of the sweep
};

/// Fewest columns, or else rows, of an interleaved sheet.
inline constexpr int kFewestColumns = kNarrow;
/// The regular links that `links` are, or nothing if an interleaved sheet cannot hold them. It can
/// hold some or all of the six directions, each complete, without duplicates and of one length to
/// 1e-9. The mesh needs at least kFewestColumns columns, or as many rows and 2 columns, and the
/// faces of make_sheet.
std::optional<RegularLinks> regular_links(const Mesh&, std::span<const Link>);

/// First row of a block of rows that own links or quads, and the end. These reach into the first
/// rows of the next block.
inline std::pair<int, int> rows_of_block(std::size_t block, int rows) {
  const int first = std::min(static_cast<int>(block) * kBlockRows, rows);
  return {first, std::min(first + kBlockRows, rows)};
}

/// Layout of an interleaved sheet (simd/kernels.hpp). Vertices past the last column are padding,
/// which falls freely and is never read. A link at the end of a strip pairs a vector with another
/// one, so a row has at least one vector more than the number of columns that a link spans. Small
/// sheets thus leave lanes empty, which still takes less time than colour batches
/// (results/benchmarks/kernels.md).
Layout interleaved_layout(const SheetSides&);

/// A Gauss-Seidel sweep over an interleaved sheet: the even blocks, then the odd ones. Within a
/// block the directions come one after another.
template <class Real>
class InterleavedSheet {
 public:
  InterleavedSheet(const RegularLinks&, std::span<const double> w, double omega,
                   const Compliances& = {});
  InterleavedSheet(InterleavedSheet&&) = default;
  InterleavedSheet(const InterleavedSheet&) = delete;  // it points into itself

  const SheetSweep<Real>& sweep() const { return sweep_; }
  int rows() const { return row_count_; }
  /// Sets all multipliers to 0.
  void clear_multipliers() {
    for (auto& of_direction : multipliers_) std::ranges::fill(of_direction, Real(0));
  }
  std::size_t bytes() const;

 private:
  int row_count_;
  SheetSweep<Real> sweep_{};
  std::vector<SheetRow<Real>> rows_;
  std::vector<std::vector<Real>> shares_;  ///< distinct tables of shares, each kept once
  std::vector<std::vector<Real, CacheLineAllocator<Real>>> multipliers_;  ///< [directions]
};

}  // namespace taut
