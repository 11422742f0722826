#include "core/solver/panel_factor.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>
#include <utility>

#include "core/model/index.hpp"

namespace taut {

namespace {

/// Largest number of columns of a panel: kWidest of single numbers, for which loops are unrolled,
/// and kWidestOfBlocks of blocks, where the update is most of the work.
constexpr std::uint32_t kWidest = kWidestPanel, kWidestOfBlocks = 4;
/// A column joins a panel if at most this share of the panel's numbers would then be 0.
constexpr double kMostZeros = 0.2;

using Columns = std::vector<std::vector<int>>;

/// Minimum-degree order of elimination.
std::vector<int> thin_order(int n, std::span<const PanelFactor::Pair> pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [a, b] : pairs) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
  return {order.indices().data(), order.indices().data() + n};
}

std::vector<int> inverse_of(const std::vector<int>& order) {
  std::vector<int> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[to_index(order[k])] = static_cast<int>(k);
  return rank;
}

/// For each row, the columns before it in which the matrix has an entry.
Columns columns_before(const std::vector<int>& order, std::span<const PanelFactor::Pair> pairs) {
  const std::vector<int> rank = inverse_of(order);
  Columns before(order.size());
  for (const auto& [a, b] : pairs) {
    const auto [low, high] = std::minmax({rank[to_index(a)], rank[to_index(b)]});
    if (low != high) before[to_index(high)].push_back(low);
  }
  return before;
}

/// Elimination tree (Liu, ACM TOMS 12, 1986): for each column of the factor, the first row below
/// its diagonal; -1: none.
std::vector<int> elimination_tree(const Columns& before) {
  std::vector<int> parent(before.size(), -1), ancestor(before.size(), -1);
  for (std::size_t row = 0; row < before.size(); ++row)
    for (int column : before[row])
      while (column >= 0 && column < static_cast<int>(row)) {
        int& next = ancestor[to_index(column)];
        if (next < 0) parent[to_index(column)] = static_cast<int>(row);
        column = std::exchange(next, static_cast<int>(row));
      }
  return parent;
}

/// Postorder of the tree: children before their parents, and subtrees together.
std::vector<int> postorder(const std::vector<int>& parent) {
  Columns children(parent.size());
  std::vector<int> open, order;
  for (std::size_t i = parent.size(); i-- > 0;)
    (parent[i] < 0 ? open : children[to_index(parent[i])]).push_back(static_cast<int>(i));
  while (!open.empty()) {  // parents first, from the last child on
    const int i = open.back();
    open.pop_back();
    order.push_back(i);
    for (const int child : children[to_index(i)]) open.push_back(child);
  }
  std::ranges::reverse(order);
  return order;
}

/// For each column of the factor, the rows below its diagonal.
Columns rows_of_columns(const Columns& before, const std::vector<int>& parent) {
  Columns below(before.size());
  for (std::size_t row = 0; row < before.size(); ++row)
    for (const int column : before[row]) below[to_index(column)].push_back(static_cast<int>(row));
  for (std::size_t column = 0; column < below.size(); ++column) {
    std::vector<int>& rows = below[column];
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (rows.empty()) continue;
    assert(rows.front() == parent[column]);
    std::vector<int>& up = below[to_index(parent[column])];
    up.insert(up.end(), rows.begin() + 1, rows.end());
  }
  return below;
}

}  // namespace

PanelFactor::PanelFactor(std::size_t unknowns, std::span<const Pair> pairs, int block, Simd simd)
    : block_(to_index(block)), simd_(simd) {
  if (unknowns == 0) return;
  order_ = thin_order(static_cast<int>(unknowns), pairs);
  const std::vector<int> tree = postorder(elimination_tree(columns_before(order_, pairs)));
  std::vector<int> order;
  for (const int k : tree) order.push_back(order_[to_index(k)]);
  order_ = std::move(order);
  make_panels(pairs);
  find_parents();
}

void PanelFactor::make_panels(std::span<const Pair> pairs) {
  const Columns before = columns_before(order_, pairs);
  const std::vector<int> parent = elimination_tree(before);
  const Columns below = rows_of_columns(before, parent);
  const std::uint32_t widest = block_ == 1 ? kWidest : kWidestOfBlocks;
  std::size_t values = 0;
  for (std::size_t first = 0; first < below.size();) {
    std::size_t last = first, own = below[first].size() + 1;
    while (last + 1 - first < widest && parent[last] == static_cast<int>(last) + 1) {
      const std::size_t more = own + below[last + 1].size() + 1, columns = last + 2 - first;
      const std::size_t all = columns * (columns + 1) / 2 + columns * below[last + 1].size();
      if (static_cast<double>(all - more) > kMostZeros * static_cast<double>(all)) break;
      own = more;
      ++last;
    }
    FactorPanel panel;
    panel.first = static_cast<std::uint32_t>(first);
    panel.columns = static_cast<std::uint32_t>(last + 1 - first);
    panel.first_row = static_cast<std::uint32_t>(row_.size());
    panel.rows = static_cast<std::uint32_t>(below[last].size());
    panel.first_value = values;
    values += columns_of(panel) * (columns_of(panel) + rows_below(panel));
    for (const int row : below[last]) row_.push_back(static_cast<std::uint32_t>(row));
    panel_of_.insert(panel_of_.end(), panel.columns, static_cast<std::uint32_t>(panels_.size()));
    panels_.push_back(panel);
    first = last + 1;
  }
  values_.assign(values, 0.0);
}

void PanelFactor::find_parents() {
  children_.assign(panels_.size(), 0);
  place_.reserve(row_.size());
  std::size_t top = 0, most = 0, widest_update = 0;
  std::vector<std::size_t> stack;
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const FactorPanel& panel = panels_[k];
    if (panel.rows > 0) {
      const std::uint32_t of = panel_of_[row_[panel.first_row]];
      ++children_[of];
      const FactorPanel& parent = panels_[of];
      const auto* const first = row_.data() + parent.first_row;
      for (std::size_t i = 0; i < panel.rows; ++i) {
        const std::uint32_t row = row_[panel.first_row + i];
        const std::uint32_t own = row - parent.first;
        place_.push_back(own < parent.columns
                             ? own
                             : parent.columns +
                                   static_cast<std::uint32_t>(
                                       std::lower_bound(first, first + parent.rows, row) - first));
      }
    }
    most = std::max(most, top + size_of_update(panel));
    widest_update = std::max(widest_update, columns_of(panel) * side_of_update(panel));
    for (std::uint32_t c = 0; c < children_[k]; ++c) {
      top -= stack.back();
      stack.pop_back();
    }
    stack.push_back(size_of_update(panel));
    top += stack.back();
    if (panel.rows == 0) stack.pop_back();
  }
  updates_.assign(most, 0.0);
  scratch_.assign(2 * widest_update, 0.0);
}

double* PanelFactor::at(std::size_t row, std::size_t column, std::size_t r, std::size_t c) {
  const FactorPanel& panel = panels_[panel_of_[column]];
  std::size_t place = row - panel.first;
  if (place >= panel.columns) {
    const auto* const first = row_.data() + panel.first_row;
    place = panel.columns +
            static_cast<std::size_t>(std::lower_bound(first, first + panel.rows, row) - first);
    assert(place < panel.columns + panel.rows && first[place - panel.columns] == row);
  }
  return values_.data() + panel.first_value + (block_ * place + r) * columns_of(panel) +
         block_ * (column - panel.first) + c;
}

void PanelFactor::clear() { std::ranges::fill(values_, 0.0); }

/// Adds the update of a child to the panel and to the panel's own update.
void PanelFactor::add_update(const FactorPanel& child, const double* of_child,
                             const FactorPanel& panel, double* update) {
  const std::uint32_t* const place = place_.data() + child.first_row;
  double* const own = values_.data() + panel.first_value;
  const std::size_t side = side_of_update(panel), columns = columns_of(panel);
  for (std::size_t i = 0; i < child.rows; ++i)
    for (std::size_t r = 0; r < block_; ++r) {
      const double* from = of_child + (block_ * i + r) * side_of_update(child);
      double* const to_own = own + (block_ * place[i] + r) * columns;
      // since j <= i, a row is beyond the panel's own columns wherever its column is
      double* const to_update = place[i] < panel.columns
                                    ? nullptr
                                    : update + (block_ * (place[i] - panel.columns) + r) * side;
      for (std::size_t j = 0; j <= i; ++j, from += block_) {
        double* const to = place[j] < panel.columns
                               ? to_own + block_ * place[j]
                               : to_update + block_ * (place[j] - panel.columns);
        for (std::size_t c = 0; c < block_; ++c) to[c] += from[c];
      }
    }
}

bool PanelFactor::factor() {
  const auto eliminate = kernels<double>(simd_).eliminate;
  double* top = updates_.data();
  std::vector<const FactorPanel*> waiting;
  for (std::size_t k = 0; k < panels_.size(); ++k) {
    const FactorPanel& panel = panels_[k];
    double* const update = top;
    std::fill_n(update, size_of_update(panel), 0.0);
    for (std::uint32_t c = 0; c < children_[k]; ++c) {
      const FactorPanel& child = *waiting.back();
      waiting.pop_back();
      top -= size_of_update(child);
      add_update(child, top, panel, update);
    }
    if (!eliminate(values_.data() + panel.first_value, columns_of(panel), rows_below(panel), update,
                   side_of_update(panel), scratch_.data()))
      return false;
    if (panel.rows == 0) continue;
    std::copy_n(update, size_of_update(panel), top);
    top += size_of_update(panel);
    waiting.push_back(&panel);
  }
  return true;
}

void PanelFactor::solve_four(double* rows) const {
  kernels<double>(simd_).solve_panels({.panels = panels_.data(),
                                       .count = panels_.size(),
                                       .row = row_.data(),
                                       .values = values_.data()},
                                      rows);
}

void PanelFactor::solve_one(double* x) const {
  for (const FactorPanel& panel : panels_) {
    const std::size_t columns = columns_of(panel);
    double* const own = x + panel.first * block_;
    const double* v = values_.data() + panel.first_value;
    for (std::size_t i = 0; i < columns; ++i, v += columns)
      for (std::size_t c = 0; c < i; ++c) own[i] -= v[c] * own[c];
    for (std::size_t i = 0; i < panel.rows; ++i)
      for (std::size_t r = 0; r < block_; ++r, v += columns) {
        double sum = 0;
        for (std::size_t c = 0; c < columns; ++c) sum += v[c] * own[c];
        x[row_[panel.first_row + i] * block_ + r] -= sum;
      }
  }
  for (std::size_t k = panels_.size(); k-- > 0;) {
    const FactorPanel& panel = panels_[k];
    const std::size_t columns = columns_of(panel);
    double* const own = x + panel.first * block_;
    const double* const values = values_.data() + panel.first_value;
    for (std::size_t c = 0; c < columns; ++c) own[c] *= values[c * columns + c];
    const double* v = values + columns * columns;
    for (std::size_t i = 0; i < panel.rows; ++i)
      for (std::size_t r = 0; r < block_; ++r, v += columns) {
        const double there = x[row_[panel.first_row + i] * block_ + r];
        for (std::size_t c = 0; c < columns; ++c) own[c] -= v[c] * there;
      }
    for (std::size_t i = columns; i-- > 0;)
      for (std::size_t c = 0; c < i; ++c) own[c] -= values[i * columns + c] * own[i];
  }
}

std::size_t PanelFactor::bytes() const {
  return values_.size() * sizeof values_[0] + panels_.size() * sizeof panels_[0] +
         (row_.size() + place_.size() + panel_of_.size() + children_.size()) * sizeof row_[0] +
         (updates_.size() + scratch_.size()) * sizeof updates_[0];
}

}  // namespace taut
