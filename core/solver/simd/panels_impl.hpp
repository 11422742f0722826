#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <cstring>
#include <utility>

#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Factors a panel. Computes u = l d and l of the rows below, [columns][side] each, column after
/// column; then subtracts the sum of u_i l_j over the columns, in their order, from the update. No
/// sum runs over lanes.
template <class T>
bool eliminate(double* panel, std::size_t columns, std::size_t rows, double* update,
               std::size_t side, double* scratch) {
  constexpr std::size_t width = kWidth<T>;
  for (std::size_t c = 0; c < columns; ++c) {
    double* const pivot = panel + c * columns + c;
    if (!(*pivot > 0)) return false;
    const double inverse = 1 / *pivot;
    for (std::size_t i = c + 1; i < columns; ++i)
      for (std::size_t k = c + 1; k <= i; ++k)
        panel[i * columns + k] -= panel[i * columns + c] * (panel[k * columns + c] * inverse);
    for (std::size_t i = c + 1; i < columns; ++i) panel[i * columns + c] *= inverse;
    *pivot = inverse;
  }
  if (rows == 0) return true;
  double* const below = panel + columns * columns;
  double *const u = scratch, *const l = scratch + columns * side;
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < rows; ++i) u[c * side + i] = below[i * columns + c];
    for (std::size_t i = rows; i < side; ++i) u[c * side + i] = 0;
  }
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t i = 0; i < side; i += width) {
      T sum = load<T>(u + c * side + i);
      for (std::size_t k = 0; k < c; ++k)
        sum -= load<T>(u + k * side + i) * T(panel[c * columns + k]);
      store(u + c * side + i, sum);
      store(l + c * side + i, sum * T(panel[c * columns + c]));
    }
  for (std::size_t i = 0; i < rows; i += 4)
    for (std::size_t j = 0; j < i + 4; j += width) {
      T sum[4];
      four_times([&](auto k) { sum[k] = load<T>(update + (i + k) * side + j); });
      for (std::size_t c = 0; c < columns; ++c) {
        const T right = load<T>(l + c * side + j);
        four_times([&](auto k) { sum[k] -= T(u[c * side + i + k]) * right; });
      }
      four_times([&](auto k) { store(update + (i + k) * side + j, sum[k]); });
    }
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t c = 0; c < columns; ++c) below[i * columns + c] = l[c * side + i];
  return true;
}

/// Calls f(n) for n = 0 .. count - 1 as constants.
template <int count, class F>
[[gnu::always_inline]] inline void unrolled(const F& f) {
  [&]<int... n>(std::integer_sequence<int, n...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, n>{}), ...);
  }
  (std::make_integer_sequence<int, count>{});
}

/// Four numbers of a row. T separates the code of one instruction set from that of another.
template <class T>
struct RowOf {
  using V [[gnu::vector_size(4 * sizeof(double))]] = double;
  V v;
};

template <class T, int columns>
[[gnu::always_inline]] inline void solve_down(const PanelSolve& s, const FactorPanel& panel,
                                              double* x) {
  using V = typename RowOf<T>::V;
  const double* v = s.values + panel.first_value;
  const std::uint32_t* const row = s.row + panel.first_row;
  double* const own = x + 4 * static_cast<std::size_t>(panel.first);
  V at[columns];
  unrolled<columns>([&](auto c) __attribute__((always_inline)) {
    std::memcpy(&at[c], own + 4 * c, sizeof(V));
    unrolled<c>([&](auto k)
                    __attribute__((always_inline)) { at[c] -= v[c * columns + k] * at[k]; });
    std::memcpy(own + 4 * c, &at[c], sizeof(V));
  });
  v += columns * columns;
  for (std::uint32_t i = 0; i < panel.rows; ++i, v += columns) {
    double* const to = x + 4 * static_cast<std::size_t>(row[i]);
    V there;
    std::memcpy(&there, to, sizeof there);
    unrolled<columns>([&](auto c) __attribute__((always_inline)) { there -= v[c] * at[c]; });
    std::memcpy(to, &there, sizeof there);
  }
}

template <class T, int columns>
[[gnu::always_inline]] inline void solve_up(const PanelSolve& s, const FactorPanel& panel,
                                            double* x) {
  using V = typename RowOf<T>::V;
  const double* const values = s.values + panel.first_value;
  const std::uint32_t* const row = s.row + panel.first_row;
  double* const own = x + 4 * static_cast<std::size_t>(panel.first);
  V at[columns];
  unrolled<columns>([&](auto c) __attribute__((always_inline)) {
    std::memcpy(&at[c], own + 4 * c, sizeof(V));
    at[c] = values[c * columns + c] * at[c];
  });
  const double* v = values + columns * columns;
  for (std::uint32_t i = 0; i < panel.rows; ++i, v += columns) {
    V there;
    std::memcpy(&there, x + 4 * static_cast<std::size_t>(row[i]), sizeof there);
    unrolled<columns>([&](auto c) __attribute__((always_inline)) { at[c] -= v[c] * there; });
  }
  unrolled<columns>([&](auto n) __attribute__((always_inline)) {
    constexpr int c = columns - 1 - n;
    unrolled<c>([&](auto k)
                    __attribute__((always_inline)) { at[k] -= values[c * columns + k] * at[c]; });
    std::memcpy(own + 4 * c, &at[c], sizeof(V));
  });
}

/// Solves with L, D and L^T for four right-hand sides, which lie side by side.
template <class T>
void solve_panels(const PanelSolve& solve, double* x) {
  static_assert(kWidestPanel == 4);
  const PanelSolve s = solve;
  for (std::size_t k = 0; k < s.count; ++k) {
    const FactorPanel panel = s.panels[k];
    switch (panel.columns) {
      case 1:
        solve_down<T, 1>(s, panel, x);
        break;
      case 2:
        solve_down<T, 2>(s, panel, x);
        break;
      case 3:
        solve_down<T, 3>(s, panel, x);
        break;
      default:
        solve_down<T, 4>(s, panel, x);
    }
  }
  for (std::size_t k = s.count; k-- > 0;) {
    const FactorPanel panel = s.panels[k];
    switch (panel.columns) {
      case 1:
        solve_up<T, 1>(s, panel, x);
        break;
      case 2:
        solve_up<T, 2>(s, panel, x);
        break;
      case 3:
        solve_up<T, 3>(s, panel, x);
        break;
      default:
        solve_up<T, 4>(s, panel, x);
    }
  }
}

}  // namespace taut
