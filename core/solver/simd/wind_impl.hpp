#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Force on each corner of a face [N]: wind_on_corner() of core/model/wind.hpp. moved: sum of the
/// corners' motions [m]. The force is 0 on a face without area and where there is no face.
template <class T, class Mask, class Real>
[[gnu::always_inline]] inline Vec3T<T> wind_on_corner(const WindStep<Real>& wind,
                                                      const Vec3T<T>& twice_area,
                                                      const Vec3T<T>& moved, const Mask& is_face) {
  const T length = norm(twice_area);
  const auto blows = is_face && length > T(0);
  const Vec3T<T> d = spread_out<T>(wind.velocity) - T(wind.per_moved) * moved;
  const T pressure = T(wind.sixth) * dot(twice_area, d) / select(blows, length, T(1));
  return select(blows, pressure * twice_area, Vec3T<T>{T(0), T(0), T(0)});
}

template <class T>
[[gnu::always_inline]] inline Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Wind on the quads of one vector, given by their corners; each lane splits its quad along one
/// diagonal.
///
///     0 - 1     along 02: faces 012 and 023, both with corners 0 and 2
///     |   |     along 13: faces 123 and 130
///     3 - 2
template <class T, int lanes, class Real>
[[gnu::always_inline]] inline void wind_on_quads(const WindStep<Real>& wind,
                                                 const std::size_t (&place)[4],
                                                 const Real* const (&w)[4], T diagonal) {
  Vec3T<T> x[4], moved[4];
  four_times([&](auto c) {
    x[c] = load_vec3<T, lanes>(wind.x + place[c]);
    moved[c] = x[c] - load_vec3<T, lanes>(wind.previous + place[c]);
  });
  const auto along02 = diagonal > T(0), is_quad = diagonal > T(0) || diagonal < T(0);
  const auto either = [&](const Vec3T<T>& a, const Vec3T<T>& b) __attribute__((always_inline)) {
    return select(along02, a, b);
  };
  const Vec3T<T> across = either(x[2] - x[0], x[3] - x[1]);
  const Vec3T<T> both = either(moved[0] + moved[2], moved[1] + moved[3]);
  const Vec3T<T> f = wind_on_corner(wind, cross(either(x[1] - x[0], x[2] - x[1]), across),
                                    both + either(moved[1], moved[2]), is_quad);
  const Vec3T<T> g = wind_on_corner(wind, cross(across, either(x[3] - x[0], x[0] - x[1])),
                                    both + either(moved[3], moved[0]), is_quad);
  const Vec3T<T> sum = f + g;
  const Vec3T<T> force[4] = {either(sum, g), either(f, sum), either(sum, f), either(g, sum)};
  four_times([&](auto c) {
    Real* const a = wind.a + place[c];
    store_vec3<T, lanes>(a, load_vec3<T, lanes>(a) + load<T>(w[c]) * force[c]);
  });
}

/// Wind on rows [begin, end) of the quads of an interleaved sheet.
template <class T, int lanes, class Real>
void wind_on_sheet(const WindStep<Real>& wind_in, const SheetFaces<Real>& faces_in, int begin,
                   int end) {
  const WindStep<Real> wind = wind_in;  // copies, which no store changes
  const SheetFaces<Real> faces = faces_in;
  const int vectors = faces.vectors;
  for (int j = begin; j < end; ++j) {
    const std::size_t row = static_cast<std::size_t>(j) * faces.stride;
    const Real* const w = faces.w + j * vectors * lanes;
    for (int k = 0; k < vectors; ++k)
      for (int l = 0; l < lanes; l += kWidth<T>) {
        // The column after the last vector's is the first vector's, in the next lane.
        const bool shifted = k + 1 == vectors;
        const int own = k * lanes + l, next = shifted ? l + 1 : own + lanes;
        const std::size_t left = row + static_cast<std::size_t>(3 * lanes * k + l);
        const std::size_t right =
            row + static_cast<std::size_t>(shifted ? l + 1 : 3 * lanes * (k + 1) + l);
        const Real* const below = w + vectors * lanes;
        wind_on_quads<T, lanes>(wind, {left, right, right + faces.stride, left + faces.stride},
                                {w + own, w + next, below + next, below + own},
                                load<T>(faces.diagonals[j % 2] + own));
      }
  }
}

/// Wind on faces of packed particles, in their order.
template <class T, class Real>
void wind_on_faces(const WindStep<Real>& wind_in, std::span<const FaceBatch<Real>> batches) {
  const WindStep<Real> wind = wind_in;  // a copy, which no store changes
  for (const FaceBatch<Real>& batch : batches) {
    Real force[4 * kLanes];
    for (int g = 0; g < kLanes; g += kWidth<T>) {
      Vec3T<T> x[3], moved[3];
      for (int c = 0; c < 3; ++c) {
        x[c] = gather_packed<T>(wind.x, batch.corner[c] + g);
        moved[c] = x[c] - gather_packed<T>(wind.previous, batch.corner[c] + g);
      }
      const T one(1);
      store_vec3<T, kPackedLanes>(force + 4 * g,
                                  wind_on_corner(wind, cross(x[1] - x[0], x[2] - x[0]),
                                                 moved[0] + moved[1] + moved[2], one > T(0)));
    }
    for (int l = 0; l < kLanes; ++l)
      for (int c = 0; c < 3; ++c) {
        Real* const a = particle(wind.a, batch.corner[c][l]);
        const Real w = batch.w[c][l];
        for (int axis = 0; axis < 3; ++axis) a[axis] += w * force[4 * l + axis];
      }
  }
}

}  // namespace taut
