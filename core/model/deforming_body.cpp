#include "core/model/deforming_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/model/body_frames.hpp"
#include "core/model/index.hpp"

namespace taut {

namespace {

/// The cubic f(s) = c[0] + c[1] s + c[2] s^2 + c[3] s^3.
using Cubic = std::array<double, 4>;

double value(const Cubic& c, double s) { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
double slope(const Cubic& c, double s) { return c[1] + s * (2 * c[2] + s * 3 * c[3]); }

/// Whether f has one sign all over [0, 1], judged by its Bernstein coefficients.
bool keeps_its_sign(const Cubic& c) {
  const double b[4] = {c[0], c[0] + c[1] / 3, c[0] + (2 * c[1] + c[2]) / 3,
                       c[0] + c[1] + c[2] + c[3]};
  const auto [least, most] = std::minmax_element(std::begin(b), std::end(b));
  return *least > 0 || *most < 0;
}

/// Where f turns from rising to falling or back, within (0, 1), in ascending order.
std::vector<double> turning_points(const Cubic& c) {
  const double a = 3 * c[3], b = 2 * c[2], discriminant = b * b - 4 * a * c[1];
  std::vector<double> at;
  if (!(discriminant > 0)) return at;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  for (const auto& [over, under] : {std::pair(q, a), {c[1], q}})
    if (const double s = under == 0 ? 0 : over / under; s > 0 && s < 1) at.push_back(s);
  std::ranges::sort(at);
  return at;
}

/// Where Newton's step from s ends; outside of [0, 1] if f is level there.
double newton_from(const Cubic& c, double s) {
  const double rise = slope(c, s);
  return rise == 0 ? -1 : s - value(c, s) / rise;
}

/// The root between two points of different sign, by Newton's steps, or bisection where these leave
/// the interval.
double root_between(const Cubic& c, double low, double high) {
  const bool rises = value(c, low) < 0;
  double s = newton_from(c, low);
  for (int round = 0; round < 100; ++round) {
    if (!(s > low && s < high)) s = low + (high - low) / 2;
    const double f = value(c, s);
    if (f == 0) return s;
    ((f < 0) == rises ? low : high) = s;
    const double next = newton_from(c, s);
    if (next == s || high - low <= 1e-16) return s;
    s = next;
  }
  return s;
}

/// Calls visit(s, rises) for every change of sign in [0, 1), in ascending order; a zero at 0
/// counts.
template <class Visit>
void roots(const Cubic& c, const Visit& visit) {
  std::vector<double> ends = turning_points(c);
  ends.push_back(1);
  double low = 0;
  if (c[0] == 0) visit(0.0, slope(c, 0) > 0);
  for (const double high : ends) {
    const double from = value(c, low), to = value(c, high);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) visit(root_between(c, low, high), to > 0);
    low = high;
  }
}

/// Orthonormal frame of a triangle: along its first side, across that in its plane, along its
/// normal.
Eigen::Matrix3d frame_of(const Corners& t) {
  const Vec3 u = (t[1] - t[0]).normalized();
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  Eigen::Matrix3d axes;
  axes << u, n.cross(u), n;
  return axes;
}

Vec3 place(const Corners& t, const Vec3& weights) {
  return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
}

/// w . (u x v) of three vectors that change linearly over [0, 1].
Cubic volume(const Vec3& u, const Vec3& v, const Vec3& w, const Vec3& du, const Vec3& dv,
             const Vec3& dw) {
  const Vec3 n0 = u.cross(v), n1 = u.cross(dv) + du.cross(v), n2 = du.cross(dv);
  return {w.dot(n0), w.dot(n1) + dw.dot(n0), w.dot(n2) + dw.dot(n1), dw.dot(n2)};
}

Eigen::AlignedBox3d box_of(const Corners& a, const Corners& b) {
  Eigen::AlignedBox3d box;
  for (std::size_t k = 0; k < 3; ++k) box.extend(a[k]).extend(b[k]);
  return box;
}

}  // namespace

/// With the vectors u, v and w from a corner to the two others and to the point, f = w . (u x v) is
/// the point's height times twice the triangle's area (Provot, Collision and Self-Collision
/// Handling in Cloth Model Dedicated to Design Garments, 1997). A point at an edge, to within
/// rounding, counts for both triangles, so that none slips through between them.
std::vector<TrianglePass> passes(const Corners& before, const Corners& after, const Vec3& from,
                                 const Vec3& to) {
  constexpr double kEdge = 1e-9;
  const Vec3 u = before[1] - before[0], v = before[2] - before[0], w = from - before[0];
  const Vec3 du = after[1] - after[0] - u, dv = after[2] - after[0] - v, dw = to - after[0] - w;
  const Cubic f = volume(u, v, w, du, dv, dw);
  std::vector<TrianglePass> all;
  if (keeps_its_sign(f)) return all;
  roots(f, [&](double s, bool rises) {
    const Vec3 us = u + s * du, vs = v + s * dv, ws = w + s * dw, n = us.cross(vs);
    const double whole = n.squaredNorm();
    const double second = ws.cross(vs).dot(n), third = us.cross(ws).dot(n);
    const double least = -kEdge * whole;
    if (whole > 0 && second >= least && third >= least && whole - second - third >= least)
      all.push_back({s, !rises});
  });
  return all;
}

std::vector<LinePass> passes(const MovingEdge& one, const MovingEdge& other) {
  const Vec3 u = one.before[1] - one.before[0], v = other.before[1] - other.before[0],
             w = one.before[0] - other.before[0];
  const Cubic f = volume(u, v, w, one.now[1] - one.now[0] - u, other.now[1] - other.now[0] - v,
                         one.now[0] - other.now[0] - w);
  std::vector<LinePass> all;
  if (keeps_its_sign(f)) return all;
  roots(f, [&](double s, bool rises) { all.push_back({s, rises}); });
  return all;
}

DeformingBody::DeformingBody(const Collider& collider)
    : frames_(collider.frames),
      motion_(collider.motion),
      start_(std::get<MeshBody>(collider.shape)),
      pose_(start_),
      before_(std::make_shared<TriangleMesh>(*start_.mesh)),
      after_(std::make_shared<TriangleMesh>(*start_.mesh)),
      center_before_(start_.center),
      axes_before_(start_.rotation.toRotationMatrix()),
      axes_(axes_before_) {}

void DeformingBody::move(double from, double to) {
  if (from == end_)
    std::swap(before_, after_);
  else
    before_->refit(frames_->at(from));
  after_->refit(frames_->at(to));
  end_ = to;
  center_before_ = motion_.moved(start_.center, from);
  axes_before_ = (motion_.rotation(from) * start_.rotation).toRotationMatrix();
  pose_.center = motion_.moved(start_.center, to);
  pose_.rotation = motion_.rotation(to) * start_.rotation;
  axes_ = pose_.rotation.toRotationMatrix();
  double longest2 = 0;
  for (std::size_t i = 0; i < after_->vertices().size(); ++i)
    longest2 = std::max(longest2, (after_->vertices()[i] - before_->vertices()[i]).squaredNorm());
  longest_way_ = std::sqrt(longest2);
}

MeshBody DeformingBody::body() const {
  MeshBody body = pose_;
  body.mesh = after_;
  return body;
}

Corners DeformingBody::corners(const TriangleMesh& mesh, int triangle) const {
  const auto& [a, b, c] = mesh.triangles()[to_index(triangle)];
  return {mesh.vertices()[to_index(a)], mesh.vertices()[to_index(b)], mesh.vertices()[to_index(c)]};
}

/// Visits the triangles that the path meets. A triangle is never farther from its position at the
/// end than its farthest vertex moves.
template <class Visit>
void DeformingBody::along(const Vec3& from, const Vec3& to, const Visit& visit) const {
  const Vec3 wider = Vec3::Constant(longest_way_ + 1e-12 * after_->reach());
  const Eigen::AlignedBox3d way(from.cwiseMin(to), from.cwiseMax(to));
  after_->in_box({way.min() - wider, way.max() + wider}, [&](int triangle) {
    const Corners was = corners(*before_, triangle), is = corners(*after_, triangle);
    if (!box_of(was, is).intersects(way)) return;
    for (const auto& [share, inward] : passes(was, is, from, to))
      visit(MeshHit{share, triangle, inward});
  });
}

std::optional<MeshHit> DeformingBody::first_hit(const Vec3& from, const Vec3& to) const {
  std::optional<MeshHit> first;
  along(from, to, [&](const MeshHit& hit) {
    if (!first || std::pair(hit.share, hit.triangle) < std::pair(first->share, first->triangle))
      first = hit;
  });
  return first;
}

std::vector<MeshHit> DeformingBody::hits(const Vec3& from, const Vec3& to) const {
  std::vector<MeshHit> all;
  along(from, to, [&](const MeshHit& hit) { all.push_back(hit); });
  std::ranges::sort(all, {}, [](const MeshHit& h) { return std::pair(h.share, h.triangle); });
  return all;
}

PlaceMotion DeformingBody::motion_of(int triangle, const Vec3& weights) const {
  const Corners was = corners(*before_, triangle), is = corners(*after_, triangle);
  return {place(was, weights), place(is, weights), frame_of(is) * frame_of(was).transpose()};
}

Vec3 DeformingBody::weights_at(const MeshHit& hit, const Vec3& p) const {
  Corners then = corners(*before_, hit.triangle);
  const Corners is = corners(*after_, hit.triangle);
  for (std::size_t k = 0; k < 3; ++k) then[k] += hit.share * (is[k] - then[k]);
  return closest_point(then, p).weights;
}

PlaceMotion DeformingBody::motion_of(const NearestPlace& at, const Vec3& p) const {
  return motion_of(at.triangle, closest_point(corners(*after_, at.triangle), p).weights);
}

PlaceMotion DeformingBody::motion_of_before(const NearestPlace& at, const Vec3& p) const {
  return motion_of(at.triangle, closest_point(corners(*before_, at.triangle), p).weights);
}

std::size_t DeformingBody::bytes() const {
  return sizeof(*this) + before_->bytes() + after_->bytes();
}

}  // namespace taut
