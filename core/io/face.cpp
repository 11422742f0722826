#include "core/io/face.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace taut {

namespace {

/// Largest turn that is only rounding, as a share of the square of the longest side.
constexpr double kFlat = 1e-12;

bool precedes(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

Face::Face(std::vector<Vec3> corners) : corners_(std::move(corners)) {
  const std::size_t n = corners_.size();
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 a = corners_[k] - corners_[0], b = corners_[(k + 1) % n] - corners_[0];
    normal += a.cross(b);
    size2_ = std::max(size2_, (b - a).squaredNorm());
  }
  has_normal_ = normal.norm() > 1e-9 * size2_;
  const Vec3 up = has_normal_ ? Vec3(normal.normalized()) : Vec3(Vec3::UnitZ());
  const Vec3 right = up.unitOrthogonal(), ahead = up.cross(right);
  for (const Vec3& corner : corners_) {
    const Vec3 at = corner - corners_[0];
    seen_.push_back({at.dot(right), at.dot(ahead)});
  }
}

/// Twice the area of the triangle; negative if it turns clockwise.
double Face::turn(std::size_t a, std::size_t b, std::size_t c) const {
  const Point &p = seen_[a], &q = seen_[b], &r = seen_[c];
  return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

bool Face::convex() const {
  const std::size_t n = seen_.size();
  double round = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t before = (k + n - 1) % n, after = (k + 1) % n;
    const double sine = turn(before, k, after);
    if (sine < -kFlat * size2_) return false;
    const Point &a = seen_[before], &b = seen_[k], &c = seen_[after];
    const double cosine = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
    round += std::atan2(sine, cosine);
  }
  return has_normal_ && std::abs(round - 2 * std::numbers::pi) < 1;
}

/// Whether two sides without a common corner meet.
bool Face::sides_meet(std::size_t i, std::size_t j) const {
  const std::size_t n = seen_.size(), a = i, b = (i + 1) % n, c = j, d = (j + 1) % n;
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  return ((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0));
}

bool Face::crosses_itself() const {
  if (!has_normal_) return seen_.size() > 3;
  if (convex()) return false;
  const std::size_t n = seen_.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j)
      if ((j + 1) % n != i && sides_meet(i, j)) return true;
  return triangles().empty();  // true if its outline touches itself
}

std::vector<std::array<std::size_t, 3>> Face::triangles() const {
  std::vector<std::size_t> left(corners_.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<std::array<std::size_t, 3>> all;
  const auto corner = [&](std::size_t k) { return left[k % left.size()]; };
  const auto is_ear = [&](std::size_t k) {
    const std::size_t n = left.size(), a = corner(k + n - 1), b = corner(k), c = corner(k + 1);
    if (!(turn(a, b, c) > kFlat * size2_)) return false;
    return std::ranges::none_of(left, [&](std::size_t p) {
      return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 &&
             turn(c, a, p) >= 0;
    });
  };
  const auto cut = [&](std::size_t k) {
    return (corners_[corner(k + 1)] - corners_[corner(k + left.size() - 1)]).squaredNorm();
  };
  const auto goes_before = [&](std::size_t i, std::size_t k) {
    const double of_i = cut(i), of_k = cut(k);
    return of_i < of_k || (of_i == of_k && precedes(corners_[left[i]], corners_[left[k]]));
  };
  std::vector<bool> ears(left.size());
  for (std::size_t k = 0; k < left.size(); ++k) ears[k] = is_ear(k);
  while (left.size() > 3) {
    std::size_t best = left.size();
    for (std::size_t k = 0; k < left.size(); ++k)
      if (ears[k] && (best == left.size() || goes_before(k, best))) best = k;
    if (best == left.size()) return {};
    const std::size_t n = left.size();
    all.push_back({corner(best + n - 1), corner(best), corner(best + 1)});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    ears.erase(ears.begin() + static_cast<std::ptrdiff_t>(best));
    // A cut only changes whether its two ends are ears.
    for (const std::size_t end : {best + n - 2, best}) ears[end % (n - 1)] = is_ear(end % (n - 1));
  }
  all.push_back({left[0], left[1], left[2]});
  return all;
}

}  // namespace taut
