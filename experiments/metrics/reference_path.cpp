#include "experiments/metrics/reference_path.hpp"

#include <array>

#include "core/model/index.hpp"
#include "experiments/metrics/own_way.hpp"

namespace taut {

std::vector<Vec3> MotionReference::at(double t) const {
  const double steps = std::clamp(t / interval(), 0.0, static_cast<double>(states.size() - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(steps), states.size() - 2);
  const double s = steps - static_cast<double>(k), left = 1 - s;
  const State &a = states[k], &b = states[k + 1];
  if (s == 0) return a.x;
  if (left == 0) return b.x;
  // Hermite's cubic
  const double of_a = left * left * (1 + 2 * s), of_b = s * s * (1 + 2 * left);
  const double of_va = s * left * left * interval(), of_vb = -s * s * left * interval();
  std::vector<Vec3> x(a.x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = of_a * a.x[i] + of_b * b.x[i] + of_va * a.v[i] + of_vb * b.v[i];
  return x;
}

ReferencePath::ReferencePath(const Scene& scene, MotionReference reference)
    : scene_(scene), free_(free_vertices(scene)), reference_(std::move(reference)) {}

void ReferencePath::observe(const Snapshot& m) {
  const double half = scene_.dt / 2, last = reference_.horizon;
  for (; next_ < reference_.states.size(); ++next_) {
    const double t = static_cast<double>(next_) * reference_.interval();
    const bool nearest = m.t > t - half - 1e-9, beyond = m.t + scene_.dt > last + 1e-9;
    if (!nearest && !(beyond && m.t > 0 && m.t <= last + 1e-9)) return;
    if (m.t > last + 1e-9) return;
    if (m.step > 0) moments_.push_back({m.t, m.state.x});
  }
}

std::vector<Vec3> ReferencePath::still(double t, const std::vector<Vec3>& reference) const {
  std::vector<Vec3> ways(reference.size());
  for (std::size_t i = 0; i < ways.size(); ++i) ways[i] = reference[i] - scene_.start.x[i];
  std::vector<Vec3> own = ways;
  keep_own_way(scene_, t, own);
  for (std::size_t i = 0; i < ways.size(); ++i) ways[i] -= own[i];
  return ways;
}

ReferencePath::Sums ReferencePath::sums() const {
  if (sums_) return *sums_;
  Sums sums;
  const std::vector<Vec3>*before = &scene_.start.x, *reference_before = &scene_.start.x;
  std::vector<std::vector<Vec3>> references;
  references.reserve(moments_.size());
  for (const Moment& moment : moments_) {
    const std::vector<Vec3>& r = references.emplace_back(reference_.at(moment.t));
    const std::vector<Vec3> common = still(moment.t, r);
    for (const std::size_t i : free_) {
      const double m = scene_.mesh.mass[i];
      const Vec3 way = r[i] - (*reference_before)[i];
      sums.along += m * way.dot(moment.x[i] - (*before)[i]);
      sums.way += m * way.squaredNorm();
      sums.apart += m * (moment.x[i] - r[i]).squaredNorm();
      sums.from_still += m * (r[i] - scene_.start.x[i] - common[i]).squaredNorm();
    }
    before = &moment.x;
    reference_before = &r;
  }
  sums_ = sums;
  return sums;
}

bool ReferencePath::moves() const {
  double mass = 0;
  for (const std::size_t i : free_) mass += scene_.mesh.mass[i];
  const double all = mass * static_cast<double>(moments_.size());
  return all > 0 && std::sqrt(sums().from_still / all) >= kLeastWay * extent(scene_);
}
double ReferencePath::horizon() const { return moves() ? moments_.back().t : Summary::kNone; }
double ReferencePath::share() const { return moves() ? sums().along / sums().way : Summary::kNone; }
double ReferencePath::error() const {
  return moves() ? std::sqrt(sums().apart / sums().from_still) : Summary::kNone;
}

/// RMS strain of structural and shear links, as stretch.rms has it at one moment.
static double rms_strain(const Scene& scene, const std::vector<Vec3>& x) {
  double square = 0;
  int count = 0;
  for (const Link& link : scene.links) {
    if (link.family == Family::bend || is_seam(link)) continue;
    square += std::pow((x[to_index(link.b)] - x[to_index(link.a)]).norm() / link.rest - 1, 2);
    ++count;
  }
  return count > 0 ? std::sqrt(square / count) : Summary::kNone;
}

double ReferencePath::strain() const {
  const double end = scene_.duration();
  double square = 0;
  int count = 0;
  for (std::size_t k = 1; k < reference_.states.size(); ++k) {
    const double t = static_cast<double>(k) * reference_.interval();
    if (t <= end - 1 || t > end + 1e-9) continue;
    const double rms = rms_strain(scene_, reference_.states[k].x);
    square += rms * rms;
    ++count;
  }
  return count > 0 && moves() ? std::sqrt(square / count) : Summary::kNone;
}

/// Mean of the squares for a time shift, over the moments that stay within the reference.
double ReferencePath::square_of(double shift) const {
  double sum = 0;
  int count = 0;
  for (const Moment& moment : moments_) {
    const double t = moment.t - shift, most = kLongestShift * reference_.horizon;
    if (moment.t < most || moment.t > reference_.horizon - most) continue;
    const std::vector<Vec3> r = reference_.at(t);
    for (const std::size_t i : free_)
      sum += scene_.mesh.mass[i] * (moment.x[i] - r[i]).squaredNorm();
    ++count;
  }
  return count > 0 ? sum / count : Summary::kNone;
}

double ReferencePath::phase() const {
  if (!moves() || next_ < reference_.states.size()) return Summary::kNone;
  if (!(share() >= 0.5)) return Summary::kNone;  // what hardly moves is not late
  constexpr int kShifts = 8;                     // on each side
  const double most = kLongestShift * reference_.horizon;
  double width = most / kShifts, best = 0, least = square_of(0), largest = least;
  const auto look = [&](double shift) {
    if (std::abs(shift) > most) return;
    const double square = square_of(shift);
    largest = std::max(largest, square);
    if (!(square < least)) return;
    best = shift;
    least = square;
  };
  for (int k = -kShifts; k <= kShifts; ++k) look(k * width);
  for (int halved = 0; halved < 3; ++halved) {  // the least of the parabola through three shifts
    const double before = best == -most ? best : best - width,
                 after = best == most ? best : best + width;
    const std::array y{square_of(before), least, square_of(after)};
    const double bend = y[0] - 2 * y[1] + y[2];
    if (before < best && after > best && bend > 0) look(best + width * (y[0] - y[2]) / (2 * bend));
    width /= 4;
  }
  return largest - least > 1e-9 * largest ? best : Summary::kNone;
}

}  // namespace taut
