#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <type_traits>

#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Rigid links of one length. at(row, vector)(l) is the excess of the lanes from l on, which
/// move_ends() asks for.
template <class T, Projection kind>
struct RigidLinks {
  T rest;
  template <class Shares>
  [[gnu::always_inline]] auto at(int, int, const Shares&) const {
    return [r = rest](int) __attribute__((always_inline)) {
      return [r](T length2) __attribute__((always_inline)) { return excess<kind>(length2, r); };
    };
  }
};

/// Compliant links, each with a multiplier.
template <class T, int lanes, class Real>
struct CompliantLinks {
  T rest, keep;
  Real* multipliers;
  int vectors;
  template <class Shares>
  [[gnu::always_inline]] auto at(int row, int vector, const Shares& shares) const {
    Real* const of_vector =
        multipliers + (static_cast<std::size_t>(row) * static_cast<std::size_t>(vectors) +
                       static_cast<std::size_t>(vector)) *
                          lanes;
    return [ r = rest, k = keep, of_vector, shares ](int l) __attribute__((always_inline)) {
      return [ r, k, at = of_vector + l, share = shares(2 * lanes + l) ](T length2)
          __attribute__((always_inline)) {
        T multiplier = load<T>(at) * k;
        const T f = compliant_excess(length2, r, share, multiplier);
        store(at, multiplier);
        return f;
      };
    };
  }
};

/// Projects all links between two vectors of an interleaved sheet.
template <class T, int lanes, class Real, class Shares, class Excess>
[[gnu::always_inline]] inline void project_vectors(Real* a, Real* b, const Shares& shares,
                                                   const Excess& excess_of) {
  for (int l = 0; l < lanes; l += kWidth<T>) {
    Vec3T<T> x1 = load_vec3<T, lanes>(a + l), x2 = load_vec3<T, lanes>(b + l);
    move_ends(x1, x2, T(shares(l)), T(shares(lanes + l)), excess_of(l));
    // b first: shifted by a lane it ends one number inside the next vector, which may be a's
    store_vec3<T, lanes>(b + l, x2);
    store_vec3<T, lanes>(a + l, x1);
  }
}

/// Projects the links at the end of the lanes' strips: lane l of a is linked with lane l + 1 of b.
template <class T, int lanes, class Real, class Shares, class Excess>
[[gnu::always_inline]] inline void project_shifted(Real* a, Real* b, const Shares& shares,
                                                   const Excess& excess_of) {
  if constexpr (kWidth<T> != lanes) {
    project_vectors<T, lanes>(a, b + 1, shares, excess_of);
  } else {
    // Rotated in registers: an unaligned load would wait for the stores before it.
    const Vec3T<T> b0 = load_vec3<T, lanes>(b);
    Vec3T<T> x1 = load_vec3<T, lanes>(a);
    Vec3T<T> x2{b0.x.template rotated<1>(), b0.y.template rotated<1>(), b0.z.template rotated<1>()};
    move_ends(x1, x2, T(shares(0)), T(shares(lanes)), excess_of(0));
    store_vec3<T, lanes>(b, Vec3T<T>{x2.x.template rotated<-1>(), x2.y.template rotated<-1>(),
                                     x2.z.template rotated<-1>()});
    store_vec3<T, lanes>(a, x1);
  }
}

/// Calls f(i) for every i of [begin, end) that belongs to this pass of two: i and i + lag belong to
/// different passes. Lag 0: for every i.
template <int lag, class F>
[[gnu::always_inline]] inline void in_pass(int pass, int begin, int end, const F& f) {
  if constexpr (lag == 0)
    for (int i = begin; i < end; ++i) f(i);
  else if constexpr (lag == 1)
    for (int i = begin + ((begin ^ pass) & 1); i < end; i += 2) f(i);
  else
    for (int i = begin; i < end; ++i)
      if (i / lag % 2 == pass) f(i);
}

/// Calls f(j, at_end, vectors) for the links of rows [begin, end) of a direction in the order of
/// the sweep, where vectors(g) calls g(k) for some of the vectors of row j. Rows of a pass share no
/// particle, but vectors of a row may. Those at the end of the lanes' strips (at_end, a constant)
/// come after all others of their pass, over all rows, so that few projections wait for the one
/// before.
template <int columns, int rows, class F>
[[gnu::always_inline]] inline void visit_direction(int all_vectors, int begin, int end,
                                                   const F& f) {
  static_assert(columns > 0 || rows > 0);
  constexpr int lag = rows == 0 ? columns : 0;  // of vectors
  const int inner = all_vectors - columns;
  for (int pass = 0; pass < 2; ++pass) {
    const auto visit = [&](auto at_end, int first, int last) __attribute__((always_inline)) {
      const auto vectors = [&](const auto& g) __attribute__((always_inline)) {
        in_pass<lag>(pass, first, last, g);
      };
      const auto row = [&](int j) __attribute__((always_inline)) { f(j, at_end, vectors); };
      in_pass<rows>(pass, begin, end, row);
    };
    visit(std::false_type{}, 0, inner);
    if constexpr (columns > 0) visit(std::true_type{}, inner, all_vectors);
  }
}

/// Calls f(columns, rows, direction) for each direction, with the reach of its links as constants.
template <class Real, class F>
[[gnu::always_inline]] inline void visit_directions(const SheetSweep<Real>& sweep, const F& f) {
  constexpr std::integral_constant<int, 0> none;
  constexpr std::integral_constant<int, 1> one;
  constexpr std::integral_constant<int, 2> two;
  for (int n = 0; n < sweep.directions; ++n) {
    const SheetDirection<Real>& d = sweep.direction[n];
    if (d.left == 0 && d.right == 0)
      d.columns == 1 ? f(one, none, d) : f(two, none, d);
    else if (d.columns == 0)
      d.right == 1 ? f(none, one, d) : f(none, two, d);
    else
      f(one, one, d);
  }
}

/// Sweeps over rows [begin, end) of the links of one direction. ends: number of shares of a link.
/// Not inlined, so that everything it needs stays in registers.
template <class T, int lanes, int ends, int columns, int rows, class Links, class Real>
[[gnu::noinline]] void sweep_direction(const SheetDirection<Real> d, const Links links,
                                       Real* const x, int vectors, std::size_t stride, int begin,
                                       int end) {
  constexpr int vector = 3 * lanes;
  const T equal_share(d.equal_share), multiplier_share(d.multiplier_share);
  visit_direction<columns, rows>(
      vectors, begin, end < d.rows ? end : d.rows,
      [&](int j, auto at_end, const auto& some) __attribute__((always_inline)) {
        Real* const left = x + static_cast<std::size_t>(j + d.left) * stride;
        Real* const right = x + static_cast<std::size_t>(j + d.right) * stride + columns * vector;
        const Real* const shares = d.row[j].shares;
        const auto own = [&](int k) __attribute__((always_inline)) {
          return [from = shares + ends * lanes * k](int l) __attribute__((always_inline)) {
            return load<T>(from + l);
          };
        };
        const auto equal = [ equal_share, multiplier_share ](int l) __attribute__((always_inline)) {
          return ends == 2 || l < 2 * lanes ? equal_share : multiplier_share;
        };
        if constexpr (at_end)
          some([&](int k) __attribute__((always_inline)) {
            project_shifted<T, lanes>(left + k * vector, right + (k - vectors) * vector, own(k),
                                      links.at(j, k, own(k)));
          });
        else if (d.row[j].all_equal)
          some([&](int k) __attribute__((always_inline)) {
            project_vectors<T, lanes>(left + k * vector, right + k * vector, equal,
                                      links.at(j, k, equal));
          });
        else
          some([&](int k) __attribute__((always_inline)) {
            project_vectors<T, lanes>(left + k * vector, right + k * vector, own(k),
                                      links.at(j, k, own(k)));
          });
      });
}

/// Rows [begin, end) of a Gauss-Seidel sweep over a regular sheet.
template <class T, int lanes, Projection kind, class Real>
void sweep_sheet(const SheetSweep<Real>& sweep, Real* x, int begin, int end) {
  visit_directions(sweep, [&](auto columns, auto rows, const SheetDirection<Real>& d) {
    sweep_direction<T, lanes, 2, columns, rows>(d, RigidLinks<T, kind>{T(d.rest)}, x, sweep.vectors,
                                                sweep.stride, begin, end);
  });
}
template <class T, int lanes, class Real>
void sweep_compliant_sheet(const SheetSweep<Real>& sweep, Real* x, Real keep, int begin, int end) {
  visit_directions(sweep, [&](auto columns, auto rows, const SheetDirection<Real>& d) {
    if (d.multipliers)
      sweep_direction<T, lanes, 3, columns, rows>(
          d, CompliantLinks<T, lanes, Real>{T(d.rest), T(keep), d.multipliers, sweep.vectors}, x,
          sweep.vectors, sweep.stride, begin, end);
    else
      sweep_direction<T, lanes, 2, columns, rows>(d, RigidLinks<T, Projection::exact>{T(d.rest)}, x,
                                                  sweep.vectors, sweep.stride, begin, end);
  });
}

}  // namespace taut
