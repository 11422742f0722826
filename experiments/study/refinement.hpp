#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace taut {

/// A cell of a map: column and row.
struct MapCell {
  std::size_t x = 0, y = 0;
  auto operator<=>(const MapCell&) const = default;
};

/// Chooses which cells of a grid to run so that every border between classes is found cell by cell
/// without running the grid: a coarse mesh of blocks first; then a block is split as long as two
/// cells known on it, its sides included, are of different class. A class that lies wholly inside a
/// block whose sides are of another is not seen.
///
///     X . . . X        X . X . X        X . X . X      a frontier through the middle of the first
///     . . . . .        . . . . .        . . . O O      block, and which cells were run
///     . . . . .   ->   X . X . O   ->   X . X O O
///     . . . . .        . . . . .        . . X O .
///     X . . . O        X . O . O        X X O . O
class Refinement {
 public:
  /// Precondition: both at least 1. `coarse` is the side of the first blocks in cells.
  Refinement(std::size_t columns, std::size_t rows, std::size_t coarse = 4);

  /// Cells to run now; empty when the map is finished. Each is asked for once.
  std::vector<MapCell> next();
  void tell(const MapCell&, int class_of_cell);

  /// What was told.
  std::optional<int> measured(const MapCell&) const;
  /// What was told, or what the sides of its block say.
  std::optional<int> inferred(const MapCell&) const;
  std::size_t run() const { return run_; }

 private:
  struct Block {
    std::size_t left, top, right, bottom;  ///< cells, inclusive; neighbours share their sides
  };
  std::optional<int>& at(const MapCell& c) { return classes_[c.y * columns_ + c.x]; }
  bool uniform(const Block&) const;
  std::vector<Block> split(const Block&) const;
  void ask(const Block&, std::vector<MapCell>&);

  std::size_t columns_, run_ = 0;
  std::vector<std::optional<int>> classes_;  ///< [columns x rows]
  std::vector<bool> asked_;
  std::vector<Block> blocks_;
};

}  // namespace taut
