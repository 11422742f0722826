// One link: both forms of the projection, their limits, and the sign errors in print.
#include <gtest/gtest.h>

#include <cmath>

#include "core/solver/simd/distance.hpp"

namespace taut::projection_test {
namespace {

/// Length after one projection of a link of rest length `rest` that is `length` long.
template <Projection kind>
double projected(double length, double rest, double share1 = 0.5, double share2 = 0.5) {
  Vec3T<double> x1{0, 0, 0}, x2{length * 0.6, 0, length * 0.8};
  project_distance<kind>(x1, x2, rest, share1, share2);
  return std::hypot(x2.x - x1.x, x2.y - x1.y, x2.z - x1.z);
}

TEST(Projection, TheExactFormRestoresTheRestLength) {
  for (const double length : {1e-3, 0.5, 0.999, 1.0, 1.5, 40.0})
    for (const double share : {0.0, 0.25, 0.5, 1.0})
      EXPECT_NEAR(projected<Projection::exact>(length, 1, share, 1 - share), 1, 1e-13);
}

TEST(Projection, WithoutTheRootTheErrorIsSquared) {
  for (const double e : {-0.5, -0.1, 1e-3, 0.1, 1.0, 4.0}) {
    const double after = projected<Projection::sqrt_free>(1 + e, 1) - 1;
    EXPECT_NEAR(after, -e * e / (2 + 2 * e + e * e), 1e-15);
    EXPECT_LE(after, 0);
  }
  // overshoots so far that the link collapses
  EXPECT_NEAR(projected<Projection::sqrt_free>(5, 1), 0.385, 5e-4);
}

TEST(Projection, RepeatedWithoutTheRootItIsAHyperbolicTangent) {
  for (const double x0 : {0.3, 0.7, 1.6, 3.0}) {
    const double u0 = std::atanh(std::min(x0, 1 / x0));
    double x = x0;
    for (int n = 1; n <= 5; ++n) {
      x = projected<Projection::sqrt_free>(x, 1);
      EXPECT_NEAR(x, std::tanh(std::ldexp(u0, n)), 1e-14);
    }
  }
}

TEST(Projection, TheFormsDifferByASmallShareOfTheCorrection) {
  for (const double e : {-0.2, -0.01, 0.01, 0.2}) {
    const double l = 1 + e;
    const double ratio =
        excess<Projection::sqrt_free>(l * l, 1.0) / excess<Projection::exact>(l * l, 1.0);
    EXPECT_NEAR(ratio, 1 + e / (2 + 2 * e + e * e), 1e-12);
  }
}

TEST(Projection, ThePrintedSignsDiverge) {
  const double e = 0.01;
  // the square-root-free listing with its printed sign pushes the particles apart
  const double wrong = -excess<Projection::sqrt_free>((1 + e) * (1 + e), 1.0);
  EXPECT_NEAR((1 + e) * (1 - wrong) - 1, (4 * e + 5 * e * e + 2 * e * e * e) / (2 + 2 * e + e * e),
              1e-14);
  // Vasilovici's combination of both listings, with diff = (d - r)/d of the exact one
  const double l = 1 + e, diff = excess<Projection::exact>(l * l, 1.0);
  const double spliced = l - l * (1 / (l * l + 1) - 0.5) * diff - 1;
  EXPECT_NEAR(spliced, e + e * e / 2, e * e * e);
}

TEST(Projection, CoincidentParticlesStayFinite) {
  EXPECT_EQ(projected<Projection::exact>(0, 1), 0);
  EXPECT_EQ(projected<Projection::sqrt_free>(0, 1), 0);
  EXPECT_EQ(projected<Projection::exact>(0, kTinyLength), 0);
  EXPECT_EQ(projected<Projection::sqrt_free>(0, kTinyLength), 0);
}

}  // namespace
}  // namespace taut::projection_test
