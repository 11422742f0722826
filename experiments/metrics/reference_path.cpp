#include "experiments/metrics/reference_path.hpp"

#include <array>

namespace taut {

ReferencePath::ReferencePath(const Scene& scene, std::vector<Reference> moments)
    : free_(free_vertices(scene)), dt_(scene.dt), extent_(extent(scene)) {
  if (!moments.empty()) longest_shift_ = moments.front().t;
  for (Reference& reference : moments) {
    const bool timed = reference.t + longest_shift_ <= scene.duration() + 1e-6;
    moments_.push_back({std::move(reference), timed, {}, {}});
  }
}

void ReferencePath::observe(const Snapshot& m) {
  const std::vector<Vec3>& x = m.state.x;
  if (m.step == 0) start_ = last_ = left_ = reference_left_ = x;
  for (; next_ < moments_.size() && moments_[next_].reference.t <= m.t + 1e-6; ++next_) {
    const double back = std::max(0.0, (m.t - moments_[next_].reference.t) / dt_);
    std::vector<Vec3> between = x;
    for (std::size_t i = 0; i < x.size(); ++i) between[i] += back * (last_[i] - x[i]);
    reach(moments_[next_], between);
  }
  for (Moment& moment : moments_)
    if (moment.timed && m.t < moment.reference.t + longest_shift_ + 2 * dt_) measure(moment, x);
  last_ = x;
}

void ReferencePath::reach(const Moment& moment, const std::vector<Vec3>& x) {
  const std::vector<Vec3>& r = moment.reference.x;
  for (const std::size_t i : free_) {
    const Vec3 way = r[i] - reference_left_[i];
    along_ += way.dot(x[i] - left_[i]);
    way_ += way.squaredNorm();
    apart_ += (x[i] - r[i]).squaredNorm();
    from_start_ += (r[i] - start_[i]).squaredNorm();
  }
  left_ = x;
  reference_left_ = r;
}

void ReferencePath::measure(Moment& moment, const std::vector<Vec3>& x) const {
  double square = 0, beside = 0;
  for (const std::size_t i : free_) {
    const Vec3 apart = x[i] - moment.reference.x[i];
    square += apart.squaredNorm();
    beside += apart.dot(last_[i] - moment.reference.x[i]);
  }
  moment.square.push_back(square);
  moment.beside.push_back(beside);
}

bool ReferencePath::moves() const {
  const double count = static_cast<double>(next_) * static_cast<double>(free_.size());
  return count > 0 && std::sqrt(from_start_ / count) >= kLeastWay * extent_;
}
double ReferencePath::horizon() const {
  return moves() ? moments_[next_ - 1].reference.t : Summary::kNone;
}
double ReferencePath::share() const { return moves() ? along_ / way_ : Summary::kNone; }
double ReferencePath::error() const {
  return moves() ? std::sqrt(apart_ / from_start_) : Summary::kNone;
}

/// Sum of squares for a time shift. On a straight piece of the path the square is a parabola in
/// time.
double ReferencePath::square_of(double shift) const {
  double sum = 0;
  for (const Moment& moment : moments_) {
    if (!moment.timed) continue;
    const double steps = std::max(0.0, (moment.reference.t + shift) / dt_);
    const std::size_t n = std::min(static_cast<std::size_t>(steps), moment.square.size() - 2);
    const double b = steps - static_cast<double>(n), a = 1 - b;
    sum +=
        a * a * moment.square[n] + 2 * a * b * moment.beside[n + 1] + b * b * moment.square[n + 1];
  }
  return sum;
}

double ReferencePath::phase() const {
  std::vector<double> kinks{-longest_shift_, longest_shift_};
  for (const Moment& moment : moments_)
    for (std::size_t n = 0; moment.timed && n < moment.square.size(); ++n)
      kinks.push_back(static_cast<double>(n) * dt_ - moment.reference.t);
  if (kinks.size() == 2 || !moves()) return Summary::kNone;
  std::erase_if(kinks, [&](double s) { return std::abs(s) > longest_shift_; });
  std::ranges::sort(kinks);
  double best = 0, least = square_of(0), most = least;
  const auto look = [&](double shift) {
    const double square = square_of(shift);
    if (square < least) {
      best = shift;
      least = square;
    }
    most = std::max(most, square);
  };
  for (std::size_t k = 0; k + 1 < kinks.size(); ++k) {
    const double from = kinks[k], half = (kinks[k + 1] - from) / 2;
    const std::array y{square_of(from), square_of(from + half), square_of(from + 2 * half)};
    const double bend = y[0] - 2 * y[1] + y[2], at = bend > 0 ? (y[0] - y[2]) / (2 * bend) : 2;
    look(from);
    look(from + 2 * half);
    if (std::abs(at) < 1) look(from + (1 + at) * half);
  }
  return most - least > 1e-9 * most ? best : Summary::kNone;
}

}  // namespace taut
