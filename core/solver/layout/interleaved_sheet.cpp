#include "core/solver/layout/interleaved_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/model/index.hpp"
#include "core/solver/simd/distance.hpp"

namespace taut {

namespace {

/// All directions in the order of the sweep: along u, along v, both diagonals, then every second
/// vertex.
constexpr std::array<RegularLinks::Direction, 6> kDirections{{{1, 0, Family::structural, 0},
                                                              {0, 1, Family::structural, 0},
                                                              {1, 1, Family::shear, 0},
                                                              {-1, 1, Family::shear, 0},
                                                              {2, 0, Family::bend, 0},
                                                              {0, 2, Family::bend, 0}}};

/// The rows in memory. They get a vector of padding where neighbouring rows would share cache sets.
SheetRows rows_of(const SheetSides& grid) {
  const int lanes = grid.columns >= 4 * kWide ? kWide : kNarrow;
  const int vectors = std::max((grid.columns + lanes - 1) / lanes, grid.reach + 1);
  const int padding = vectors % 32 == 0 ? 1 : 0;
  return {grid.rows, grid.columns, lanes, vectors, to_index((vectors + padding) * 3 * lanes)};
}

/// Chooses the side that lies along the lanes: one that fills them, otherwise one that is long
/// enough; the first side if both do.
std::optional<SheetSides> sides_of(const Grid& grid) {
  for (const int fewest : {2 * kNarrow + 1, kFewestColumns}) {
    if (grid.nu >= fewest) return SheetSides{grid.nu, grid.nv, false};
    if (grid.nv >= fewest && grid.nu >= 2) return SheetSides{grid.nv, grid.nu, true};
  }
  return {};
}

}  // namespace

std::optional<RegularLinks> regular_links(const Mesh& mesh, std::span<const Link> links) {
  if (!mesh.grid) return {};
  const auto sides = sides_of(*mesh.grid);
  if (!sides) return {};
  const SheetSides grid = *sides;
  if (mesh.triangles != make_sheet({.nu = mesh.grid->nu, .nv = mesh.grid->nv}).triangles) return {};
  RegularLinks regular{grid, {}};
  std::array<std::vector<bool>, kDirections.size()> seen;
  std::array<std::size_t, kDirections.size()> count{};
  std::array<double, kDirections.size()> rest{};
  for (const Link& link : links) {
    const bool forward = std::pair(grid.row(link.a), grid.column(link.a)) <
                         std::pair(grid.row(link.b), grid.column(link.b));
    const int from = forward ? link.a : link.b, to = forward ? link.b : link.a;
    const int columns = grid.column(to) - grid.column(from), rows = grid.row(to) - grid.row(from);
    std::size_t d = 0;
    while (d < kDirections.size() &&
           (kDirections[d].columns != columns || kDirections[d].rows != rows ||
            kDirections[d].family != link.family))
      ++d;
    if (d == kDirections.size()) return {};
    if (seen[d].empty()) {
      seen[d].resize(to_index(grid.size()));
      rest[d] = link.rest;
    }
    if (seen[d][to_index(from)] || !(std::abs(link.rest - rest[d]) <= 1e-9 * rest[d])) return {};
    seen[d][to_index(from)] = true;
    ++count[d];
  }
  for (std::size_t d = 0; d < kDirections.size(); ++d) {
    if (count[d] == 0) continue;
    RegularLinks::Direction direction = kDirections[d];
    const int complete =
        (grid.columns - std::abs(direction.columns)) * (grid.rows - direction.rows);
    if (count[d] != to_index(complete)) return {};
    direction.rest = rest[d];
    regular.grid.reach = std::max(regular.grid.reach, direction.columns);
    regular.directions.push_back(direction);
  }
  if (regular.directions.empty()) return {};
  return regular;
}

Layout interleaved_layout(const SheetSides& grid) {
  const SheetRows sheet = rows_of(grid);
  const auto [rows, columns, lanes, vectors, stride] = sheet;
  std::vector<std::uint32_t> slots(to_index(grid.size()));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      slots[to_index(grid.index(i, j))] = static_cast<std::uint32_t>(
          to_index(j) * stride + to_index(i % vectors * 3 * lanes + i / vectors));
  return Layout::interleaved(std::move(slots), sheet);
}

namespace {

/// The sweep's data for one direction, except its shares. multipliers: null for rigid links.
template <class Real>
SheetDirection<Real> direction_of(const RegularLinks::Direction& links, int rows,
                                  Real* multipliers) {
  return {.left = links.columns < 0 ? links.rows : 0,
          .right = links.columns < 0 ? 0 : links.rows,
          .columns = std::abs(links.columns),
          .rows = rows - links.rows,
          .rest = static_cast<Real>(std::max(links.rest, kTinyLength)),
          .equal_share = 0,
          .multiplier_share = 0,
          .multipliers = multipliers,
          .row = nullptr};
}

/// Shares of each link of a direction: of its left end, its right end and its multiplier.
template <class Real>
class LinkShares {
 public:
  LinkShares(const SheetSides& grid, std::span<const double> w, const SheetDirection<Real>& links,
             double omega, double soft)
      : grid_(grid), w_(w), links_(links), omega_(omega), soft_(soft) {}

  std::array<Real, 3> operator()(int i, int j) const {
    const double left = w_[to_index(grid_.index(i, j + links_.left))],
                 right = w_[to_index(grid_.index(i + links_.columns, j + links_.right))];
    if (left + right == 0) return {};
    const double all = left + right + soft_;
    return {static_cast<Real>(omega_ * (left / all)), static_cast<Real>(omega_ * (right / all)),
            static_cast<Real>(soft_ / all)};
  }

  /// Shares of row j as they lie in memory, [K][ends][lanes]. Every link with the same share at
  /// both ends casts a vote for the most common share.
  std::vector<Real> row(int j, int lanes, int vectors,
                        std::map<std::pair<Real, Real>, int>& votes) const {
    const int ends = links_.multipliers ? 3 : 2;
    std::vector<Real> row(to_index(ends * lanes * vectors), Real(0));
    for (int i = 0; i + links_.columns < grid_.columns; ++i) {
      const int k = i % vectors, lane = i / vectors;
      const auto of_link = (*this)(i, j);
      for (int e = 0; e < ends; ++e)
        row[to_index((ends * k + e) * lanes + lane)] = of_link[to_index(e)];
      if (of_link[0] == of_link[1]) ++votes[{of_link[0], of_link[2]}];
    }
    return row;
  }

 private:
  const SheetSides& grid_;
  std::span<const double> w_;
  const SheetDirection<Real>& links_;
  double omega_, soft_;
};

/// Whether all links of a row have the direction's equal share, except those that SheetRow
/// excludes.
template <class Real>
bool all_equal(const std::vector<Real>& shares, const SheetDirection<Real>& of,
               const SheetSweep<Real>& sweep, int columns) {
  const int ends = of.multipliers ? 3 : 2;
  const auto equal = [&](int k) {
    // Shares of padding do not matter: nothing reads its positions.
    const int real = std::min(sweep.lanes, (columns - k + sweep.vectors - 1) / sweep.vectors);
    const auto* s = shares.data() + ends * sweep.lanes * k;
    for (int e = 0; e < ends; ++e, s += sweep.lanes)
      if (!std::all_of(s, s + real, [&](Real share) {
            return share == (e < 2 ? of.equal_share : of.multiplier_share);
          }))
        return false;
    return true;
  };
  for (int k = 0; k < sweep.vectors - of.columns; ++k)
    if (!equal(k)) return false;
  return true;
}

}  // namespace

template <class Real>
InterleavedSheet<Real>::InterleavedSheet(const RegularLinks& links, std::span<const double> w,
                                         double omega, const Compliances& compliances)
    : row_count_(links.grid.rows) {
  const SheetSides& grid = links.grid;
  const SheetRows in_memory = rows_of(grid);
  sweep_.lanes = in_memory.lanes;
  sweep_.vectors = in_memory.vectors;
  sweep_.stride = in_memory.stride;
  sweep_.directions = static_cast<int>(links.directions.size());
  std::map<std::vector<Real>, std::size_t> known;
  std::vector<std::size_t> table;  // index into shares_ of each row of each direction
  for (std::size_t d = 0; d < links.directions.size(); ++d) {
    const RegularLinks::Direction& own = links.directions[d];
    const double soft = compliances.over_h2[static_cast<std::size_t>(own.family)];
    const bool kept = soft > 0 && compliances.multipliers;
    auto& multipliers = multipliers_.emplace_back();
    if (kept)
      multipliers.resize(to_index(grid.rows - own.rows) * to_index(sweep_.vectors * sweep_.lanes));
    SheetDirection<Real>& to = sweep_.direction[d];
    to = direction_of<Real>(own, grid.rows, kept ? multipliers.data() : nullptr);
    const LinkShares<Real> shares(grid, w, to, omega, soft);
    std::map<std::pair<Real, Real>, int> votes;
    for (int j = 0; j < to.rows; ++j) {
      const auto [place, is_new] =
          known.try_emplace(shares.row(j, sweep_.lanes, sweep_.vectors, votes), shares_.size());
      if (is_new) shares_.push_back(place->first);
      table.push_back(place->second);
    }
    const auto most =
        std::max_element(votes.begin(), votes.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != votes.end()) {
      to.equal_share = most->first.first;
      to.multiplier_share = most->first.second;
    }
  }
  std::size_t next = 0;
  for (std::size_t d = 0; d < links.directions.size(); ++d)
    for (int j = 0; j < sweep_.direction[d].rows; ++j) {
      const std::vector<Real>& shares = shares_[table[next++]];
      rows_.push_back(
          {shares.data(), all_equal(shares, sweep_.direction[d], sweep_, grid.columns)});
    }
  const SheetRow<Real>* row = rows_.data();
  for (std::size_t d = 0; d < links.directions.size(); row += sweep_.direction[d++].rows)
    sweep_.direction[d].row = row;
}

template <class Real>
std::size_t InterleavedSheet<Real>::bytes() const {
  std::size_t bytes = sizeof *this + rows_.size() * sizeof rows_[0];
  for (const auto& table : shares_) bytes += table.size() * sizeof(Real);
  for (const auto& table : multipliers_) bytes += table.size() * sizeof(Real);
  return bytes;
}

template class InterleavedSheet<float>;
template class InterleavedSheet<double>;

}  // namespace taut
