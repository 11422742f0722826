#include "core/model/move_out.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/index.hpp"

namespace taut {

namespace {

/// Places at which p leaves a shape, `thickness` [m] above its surface: the nearest one first, and
/// of a box also those of its six sides.
std::vector<Vec3> places_outside(const Shape& shape, const Vec3& p, double thickness) {
  const Surface s = surface(shape, p);
  std::vector<Vec3> out{p + (thickness - s.distance) * s.normal};
  const Box* box = std::get_if<Box>(&shape);
  if (!box || s.distance > 0) return out;
  const Vec3 local = box->rotation.conjugate() * (p - box->center);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Vec3 at = local;
      at[axis] = side * (box->half_extents[axis] + thickness);
      out.push_back(box->center + box->rotation * at);
    }
  std::ranges::stable_sort(out, {}, [&](const Vec3& q) { return (q - p).squaredNorm(); });
  return out;
}

double rounding_at(const Vec3& x) { return 1e-12 * (1 + x.norm()); }

bool is_inside(const std::vector<Shape>& shapes, const Vec3& x, double thickness) {
  return std::ranges::any_of(shapes, [&](const Shape& shape) {
    return surface(shape, x).distance < thickness - rounding_at(x);
  });
}

/// Displacements of which those of the `fixed` vertices are given and the others change as little
/// as they can from one end of a link to the other: the sum of |u_a - u_b|^2 over the links is
/// least. By conjugate gradients.
void spread(const std::vector<Link>& links, const std::vector<bool>& fixed, std::vector<Vec3>& u) {
  const std::size_t n = u.size();
  const auto times = [&](const std::vector<Vec3>& v) {
    std::vector<Vec3> product(n, Vec3::Zero());
    for (const Link& link : links) {
      const std::size_t a = to_index(link.a), b = to_index(link.b);
      const Vec3 across = v[a] - v[b];
      if (!fixed[a]) product[a] += across;
      if (!fixed[b]) product[b] -= across;
    }
    return product;
  };
  const auto dot = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += a[i].dot(b[i]);
    return sum;
  };
  std::vector<Vec3> left = times(u);
  for (Vec3& r : left) r = -r;
  std::vector<Vec3> along = left;
  double square = dot(left, left);
  const double done = 1e-24 * square;
  for (std::size_t k = 0; k < n && square > done; ++k) {
    const std::vector<Vec3> product = times(along);
    const double step = square / dot(along, product);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] += step * along[i];
      left[i] -= step * product[i];
    }
    const double before = square;
    square = dot(left, left);
    for (std::size_t i = 0; i < n; ++i) along[i] = left[i] + square / before * along[i];
  }
}

}  // namespace

Vec3 moved_out(const std::vector<Shape>& shapes, Vec3 x, double thickness) {
  double rounding = 0;  // m
  const auto inside = [&](const Shape& shape, const Vec3& p) {
    return surface(shape, p).distance < thickness - rounding;
  };
  constexpr int kRounds = 1000;  // a wedge takes the more rounds the narrower it is
  for (int round = 0; round < kRounds; ++round) {
    bool moved = false;
    for (const Shape& shape : shapes) {
      if (!inside(shape, x)) continue;
      const std::vector<Vec3> ways = places_outside(shape, x, thickness);
      const auto free = std::ranges::find_if(ways, [&](const Vec3& p) {
        return std::ranges::none_of(shapes, [&](const Shape& s) { return inside(s, p); });
      });
      x = free != ways.end() ? *free : ways.front();
      moved = true;
    }
    if (!moved) break;
    rounding = rounding_at(x);
  }
  return x;
}

std::vector<Vec3> ways_out(const Scene& scene, double t, const std::vector<Vec3>& x,
                           const std::vector<int>& let_go) {
  std::vector<Shape> shapes;
  for (const Collider& collider : scene.colliders) shapes.push_back(shape_at(collider, t));
  const std::vector<double> w = inverse_masses(scene);
  std::vector<bool> fixed(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) fixed[i] = w[i] == 0;
  std::vector<Vec3> ways(x.size(), Vec3::Zero());
  bool any = false;
  for (const int v : let_go) {
    const std::size_t i = to_index(v);
    if (!x[i].allFinite() || !is_inside(shapes, x[i], scene.thickness)) continue;
    ways[i] = moved_out(shapes, x[i], scene.thickness) - x[i];
    fixed[i] = any = true;
  }
  if (!any) return {};
  spread(scene.links, fixed, ways);
  std::vector<Vec3> at(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) at[i] = x[i] + ways[i];
  // What is left is local: the vertices that were moved out each by its own way.
  constexpr std::size_t kFewest = 200, kMost = 5000, kProjections = 20'000'000;  // a second or so
  constexpr double kOver = 1.5;                                                  // over-relaxation
  const std::size_t rounds =
      std::clamp(kProjections / std::max<std::size_t>(1, scene.links.size()), kFewest, kMost);
  bool moves = true;
  for (std::size_t round = 0; round < rounds && moves; ++round) {
    moves = false;
    for (const auto& [a, b, rest, family] : scene.links) {
      const std::size_t i = to_index(a), j = to_index(b);
      const double kept = (x[j] - x[i]).norm(), sum = w[i] + w[j];
      const Vec3 between = at[j] - at[i];
      const double length = between.norm();
      if (sum == 0 || length == 0) continue;
      const Vec3 move = kOver * (length - kept) / (length * sum) * between;
      at[i] += w[i] * move;
      at[j] -= w[j] * move;
      moves = moves || std::abs(length - kept) > 1e-6 * kept;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w[i] == 0 || at[i] == x[i] || !is_inside(shapes, at[i], scene.thickness)) continue;
      at[i] = moved_out(shapes, at[i], scene.thickness);
      moves = true;
    }
  }
  for (std::size_t i = 0; i < x.size(); ++i) ways[i] = at[i] - x[i];
  return ways;
}

}  // namespace taut
