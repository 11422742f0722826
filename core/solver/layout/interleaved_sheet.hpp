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

/// A grid as it is laid out: its columns are cut into strips. `across`: they are the grid's rows.
struct SheetSides {
  int columns = 0, rows = 0;
  bool across = false;
  int reach = 1;  ///< columns between the ends of a link, at most
  int size() const { return columns * rows; }
  /// The vertex in column i of row j, and back.
  int index(int i, int j) const { return across ? i * rows + j : j * columns + i; }
  int column(int v) const { return across ? v / rows : v % columns; }
  int row(int v) const { return across ? v % rows : v / columns; }
};

/// The links of a regular sheet: every link of the directions that are present, of one length each.
struct RegularLinks {
  struct Direction {
    int columns = 0, rows = 0;  ///< from (i, j) to (i + columns, j + rows)
    Family family = Family::structural;
    double rest = 0;  ///< m
  };
  SheetSides grid;
  std::vector<Direction> directions;  ///< in the order of the sweep
};

/// What `links` are if an interleaved sheet can hold them: all six directions or some, each
/// complete, without duplicates, of one length to 1e-9; at least kFewestColumns columns, or else
/// as many rows and 2 columns; and the faces are those of make_sheet.
inline constexpr int kFewestColumns = kNarrow;
std::optional<RegularLinks> regular_links(const Mesh&, std::span<const Link>);

/// The first row of a block of rows that own links or quads, and their end: these reach into the
/// first rows of the block after it.
inline std::pair<int, int> rows_of_block(std::size_t block, int rows) {
  const int first = std::min(static_cast<int>(block) * kBlockRows, rows);
  return {first, std::min(first + kBlockRows, rows)};
}

/// Where an interleaved sheet (simd/kernels.hpp) keeps each vertex. Vertices past the last column
/// are padding that falls freely and that nobody looks at. A link at the end of a strip pairs a
/// vector with another one, so a row has one vector more than links reach columns: small sheets
/// leave lanes empty, which still takes less time than colour batches
/// (results/benchmarks/kernels.md).
Layout interleaved_layout(const SheetSides&);

/// A Gauss-Seidel sweep over an interleaved sheet, the even blocks, then the odd ones; the
/// directions one after the other within a block.
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
  std::vector<std::vector<Real>> shares_;  ///< different rows' tables, each kept once
  std::vector<std::vector<Real, CacheLineAllocator<Real>>> multipliers_;  ///< by direction
};

}  // namespace taut
