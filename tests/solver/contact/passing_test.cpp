// Points that pass through a ball, a box or a capsule within a step, while both move, against a
// second implementation in the solid's own frame: a point has to stay on the side where its path
// entered.
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "tests/solver/second_implementation.hpp"
#include "tests/support/cloths.hpp"

namespace taut::contact_passing_test {
namespace {

/// Distance below a plane, and the plane's normal.
struct Push {
  double depth = -1;
  Vec3 normal = Vec3::Zero();
};

/// Normal at the point where the path enters a convex solid. Bisection starts from the point of the
/// path that is nearest to the solid, or deepest in it, which a ternary search finds.
std::optional<Vec3> searched_normal(const Shape& shape, const Vec3& a, const Vec3& b) {
  const auto at = [&](double s) {
    return second::surface_at({.shape = shape}, a + s * (b - a), 0);
  };
  double low = 0, high = 1;
  for (int k = 0; k < 200; ++k) {
    const double third = (high - low) / 3;
    if (at(low + third).distance < at(high - third).distance)
      high -= third;
    else
      low += third;
  }
  if (at(low).distance >= 0) return {};
  high = low;
  low = 0;
  for (int k = 0; k < 100; ++k) (at((low + high) / 2).distance > 0 ? low : high) = (low + high) / 2;
  return at(low).normal;
}

/// Normal where a path from a (outside) to b enters a solid at rest about the origin.
std::optional<Vec3> entry_normal(const Shape& shape, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  if (const auto* ball = std::get_if<Ball>(&shape)) {
    const double p = a.dot(d) / d.squaredNorm(),
                 q = (a.squaredNorm() - ball->radius * ball->radius) / d.squaredNorm();
    if (p * p <= q) return {};
    const double s = -p - std::sqrt(p * p - q);
    if (s < 0 || s > 1) return {};
    return (a + s * d).normalized();
  }
  if (std::holds_alternative<Capsule>(shape)) return searched_normal(shape, a, b);
  const Vec3 h = std::get<Box>(shape).half_extents;
  double in = -1e300, out = 1;
  Vec3 normal = Vec3::Zero();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double sign = d[axis] > 0 ? 1 : -1, enters = (-sign * h[axis] - a[axis]) / d[axis];
    if (enters > in) {
      in = enters;
      normal = -sign * Vec3::Unit(axis);
    }
    out = std::min(out, (sign * h[axis] - a[axis]) / d[axis]);
  }
  if (in < 0 || in >= out) return {};
  return normal;
}

/// Push out of the nearest side, or, given `back`, through the tangent plane where the path came
/// in.
Push out_of(const Shape& shape, double thickness, const Vec3& b, const std::optional<Vec3>& back) {
  if (!back) {
    const second::Hit now = second::surface_at({.shape = shape}, b, 0);
    return {thickness - now.distance, now.normal};
  }
  double reach = 0;
  if (const auto* ball = std::get_if<Ball>(&shape)) reach = ball->radius;
  if (const auto* box = std::get_if<Box>(&shape)) reach = box->half_extents.dot(back->cwiseAbs());
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    reach = capsule->radius + std::max(back->dot(capsule->from), back->dot(capsule->to));
  return {reach + thickness - back->dot(b), *back};
}

/// Valid pushes for a path from a to b. There is more than one only where rounding decides between
/// two perpendicular sides of a turned box.
std::vector<Push> pushes(const Shape& shape, double thickness, const Vec3& a, const Vec3& b) {
  const second::Hit now = second::surface_at({.shape = shape}, b, 0);
  const std::optional<Vec3> entry = entry_normal(shape, a, b);
  const Push straight = out_of(shape, thickness, b, {}), back = out_of(shape, thickness, b, entry);
  if (!entry || now.distance >= 0) return {back};
  const double alike = now.normal.dot(*entry);
  if (std::holds_alternative<Box>(shape) && alike == 0) return {back, straight};
  return {alike > 0 ? straight : back};
}

struct Motions {
  Eigen::Quaterniond turn;
  Vec3 velocity, spin;
  bool turned() const { return turn.vec().norm() > 0 || spin.norm() > 0; }
};

/// Throws points without links at a solid that moves for a step. Returns how many points it moved
/// and how many of those had passed through it.
std::pair<int, int> thrown(const Shape& shape, const Vec3& center, const Motions& motions,
                           const char* precision, double tolerance) {
  constexpr int kPoints = 2000;
  constexpr double kDt = 1.0 / 64, kThickness = 0.02;
  std::mt19937 random(3);
  const auto number = [&] { return static_cast<double>(random()) * 0x1p-31 - 1; };
  Collider placed{.shape = shape,
                  .motion = {.velocity = motions.velocity, .spin = motions.spin, .pivot = center}};
  if (auto* ball = std::get_if<Ball>(&placed.shape)) ball->center = center;
  if (auto* box = std::get_if<Box>(&placed.shape)) {
    box->center = center;
    box->rotation = motions.turn;
  }
  if (auto* capsule = std::get_if<Capsule>(&placed.shape)) {
    capsule->from += center;
    capsule->to += center;
  }
  /// position in the solid's own frame of the point that is at p at time t
  const auto own = [&](const Vec3& p, double t) -> Vec3 {
    const Vec3 q = second::started(placed.motion, p, t) - center;
    return std::holds_alternative<Box>(shape) ? Vec3(motions.turn.conjugate() * q) : q;
  };
  Scene scene;
  scene.gravity.setZero();
  scene.dt = kDt;
  scene.steps = 1;
  scene.thickness = kThickness;
  std::vector<Vec3> free;
  while (free.size() < kPoints) {
    const Vec3 x = center + Vec3(number(), number(), number()),
               target = center + 0.5 * Vec3(number(), number(), number()),
               way = (1 + 0.7 * number()) * (target - x);
    if (second::surface_at(placed, x, 0).distance < kThickness) continue;
    scene.start.x.push_back(x);
    scene.start.v.push_back(way / kDt);
    free.push_back(x + way);
  }
  scene.mesh.rest = scene.start.x;
  scene.mesh.mass.assign(kPoints, 0.3);
  scene.colliders = {placed};
  const State state = simulate(
      scene, listing(std::string("iterations=1,contact=continuous,precision=") + precision), 1);
  int moved = 0, passed = 0, wrong = 0;
  std::ostringstream first;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vec3 end = own(free[i], kDt);
    auto may = pushes(shape, kThickness, own(scene.start.x[i], 0), end);
    const Push out = may.front();
    if (!motions.turned()) may.resize(1);
    const auto after = [&](const Push& one) {
      return Vec3(one.depth > 0 ? end + one.depth * one.normal : end);
    };
    const Vec3 expected = after(out);
    if (std::ranges::none_of(may,
                             [&](const Push& one) {
                               return (own(state.x[i], kDt) - after(one)).norm() <= tolerance;
                             }) &&
        ++wrong == 1)
      first << "from " << own(scene.start.x[i], 0).transpose() << " to "
            << own(free[i], kDt).transpose() << ": " << own(state.x[i], kDt).transpose()
            << ", expected " << expected.transpose();
    moved += out.depth > 0;
    passed += out.depth > 0 && second::surface_at(placed, free[i], kDt).distance > kThickness;
  }
  // Rounding may put a path that grazes an edge on either side of it.
  EXPECT_LE(wrong, precision[0] == 'f' ? 2 : 0) << first.str();
  return {moved, passed};
}

TEST(Passing, PointsStayOnTheSideWhereTheyCameIn) {
  const Vec3 center(0.3, -0.2, 0.1);
  const auto turn = Eigen::Quaterniond(0.8, 0.3, -0.5, 0.2).normalized();
  for (const Shape& shape :
       {Shape(Ball{Vec3::Zero(), 0.35}), Shape(Box{Vec3::Zero(), {0.5, 0.12, 0.25}}),
        Shape(Capsule{{-0.3, 0.1, 0.05}, {0.3, -0.1, -0.05}, 0.3})})
    for (const Motions& motions :
         {Motions{Eigen::Quaterniond::Identity(), {3, -2, 7}, Vec3::Zero()},
          Motions{turn, {20, -6, 9}, Vec3::Zero()}, Motions{turn, {5, 9, -7}, {9, 20, -30}}})
      for (const auto& [precision, tolerance] : {std::pair{"double", 1e-10}, {"float", 3e-5}}) {
        SCOPED_TRACE(std::string(type_name(shape)) + " " + precision);
        const auto [moved, passed] = thrown(shape, center, motions, precision, tolerance);
        EXPECT_GT(moved, 100);
        EXPECT_GT(passed, 20);
      }
}

}  // namespace
}  // namespace taut::contact_passing_test
