#include "experiments/study/refinement.hpp"

#include <algorithm>

namespace taut {

namespace {

/// Ends of blocks of `side` cells that cover 0 to count - 1: {0, side, ..., count - 1}.
std::vector<std::size_t> ends(std::size_t count, std::size_t side) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i + 1 < count; i += side) all.push_back(i);
  all.push_back(count - 1);
  return all;
}

}  // namespace

Refinement::Refinement(std::size_t columns, std::size_t rows, std::size_t coarse)
    : columns_(columns), classes_(columns * rows), asked_(columns * rows, false) {
  const std::vector<std::size_t> xs = ends(columns, coarse), ys = ends(rows, coarse);
  const auto pairs = [](const std::vector<std::size_t>& e) {
    return std::max<std::size_t>(1, e.size() - 1);
  };
  for (std::size_t j = 0; j < pairs(ys); ++j)
    for (std::size_t i = 0; i < pairs(xs); ++i)
      blocks_.push_back(
          {xs[i], ys[j], xs[std::min(i + 1, xs.size() - 1)], ys[std::min(j + 1, ys.size() - 1)]});
}

bool Refinement::uniform(const Block& block) const {
  std::optional<int> first;
  for (std::size_t y = block.top; y <= block.bottom; ++y)
    for (std::size_t x = block.left; x <= block.right; ++x) {
      const std::optional<int> here = measured({x, y});
      if (!here) continue;
      if (first && *first != *here) return false;
      first = here;
    }
  return true;
}

std::vector<Refinement::Block> Refinement::split(const Block& b) const {
  const std::size_t x = (b.left + b.right) / 2, y = (b.top + b.bottom) / 2;
  std::vector<Block> parts;
  for (const auto& [top, bottom] : {std::pair{b.top, y}, std::pair{y, b.bottom}}) {
    if (top == bottom && b.top != b.bottom) continue;
    for (const auto& [left, right] : {std::pair{b.left, x}, std::pair{x, b.right}}) {
      if (left == right && b.left != b.right) continue;
      parts.push_back({left, top, right, bottom});
      if (b.left == b.right) break;
    }
    if (b.top == b.bottom) break;
  }
  return parts;
}

void Refinement::ask(const Block& b, std::vector<MapCell>& cells) {
  for (const MapCell& corner : {MapCell{b.left, b.top}, MapCell{b.right, b.top},
                                MapCell{b.left, b.bottom}, MapCell{b.right, b.bottom}}) {
    const std::size_t index = corner.y * columns_ + corner.x;
    if (asked_[index]) continue;
    asked_[index] = true;
    cells.push_back(corner);
  }
}

std::vector<MapCell> Refinement::next() {
  std::vector<MapCell> cells;
  for (const Block& block : blocks_) ask(block, cells);
  while (cells.empty()) {
    std::vector<Block> finer;
    bool any = false;
    for (const Block& block : blocks_) {
      const bool smallest = block.right - block.left <= 1 && block.bottom - block.top <= 1;
      if (smallest || uniform(block)) {
        finer.push_back(block);
        continue;
      }
      any = true;
      for (const Block& part : split(block)) finer.push_back(part);
    }
    if (!any) break;
    blocks_ = std::move(finer);
    for (const Block& block : blocks_) ask(block, cells);
  }
  return cells;
}

void Refinement::tell(const MapCell& cell, int class_of_cell) {
  if (!at(cell)) ++run_;
  at(cell) = class_of_cell;
}

std::optional<int> Refinement::measured(const MapCell& cell) const {
  return classes_[cell.y * columns_ + cell.x];
}

std::optional<int> Refinement::inferred(const MapCell& cell) const {
  if (measured(cell)) return measured(cell);
  for (const Block& b : blocks_)
    if (b.left <= cell.x && cell.x <= b.right && b.top <= cell.y && cell.y <= b.bottom)
      return measured({b.left, b.top});
  return {};
}

}  // namespace taut
