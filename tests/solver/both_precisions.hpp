#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/cloths.hpp"

namespace taut {

/// Expects that the solver in float follows itself in double up to rounding.
inline void expect_float_follows_double(const std::string& solver) {
  const Scene scene = crumpled(hanging_sheet(12, 10), 0.01);
  const State in_double = simulate(scene, solver, 16);
  const State in_float = simulate(scene, solver + ",precision=float", 16);
  const double way = largest_distance(in_double.x, scene.start.x);
  EXPECT_GT(way, 0.01) << solver;
  EXPECT_LT(largest_distance(in_float.x, in_double.x), 3e-4 * way) << solver;
  EXPECT_GT(largest_distance(in_float.x, in_double.x), 0) << solver;
}

/// Expects that a link without a length, which has no direction, exerts no force in either
/// precision.
inline void expect_link_of_no_length_is_harmless(const std::string& solver) {
  Scene scene = hanging_sheet(6, 5);
  scene.start.x[14] = scene.start.x[15];
  for (const char* precision : {",precision=float", ",precision=double"}) {
    const State state = simulate(scene, solver + precision, 2);
    for (const Vec3& x : state.x) EXPECT_TRUE(x.allFinite()) << solver << precision;
  }
}

}  // namespace taut
