#include <numbers>
#include <numeric>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Rows of a grid that hang one below another from the first, which is pinned.
struct Rows {
  std::vector<double> mass;    ///< [rows] kg, from the first free row down
  std::vector<double> length;  ///< [rows] m, of the links above each row
};

/// Lowest mode of small swings, scaled to 1 at the lowest row.
struct LowestMode {
  std::vector<double> shape;
  double frequency = 0;  ///< rad/s
};

/// Computes the mode by inverse iteration: a sideways force tilts every link above it by
/// force / tension, so K^-1 M only needs sums.
LowestMode lowest_mode(const Rows& rows, double g) {
  const std::size_t n = rows.mass.size();
  LowestMode mode{std::vector<double>(n, 1.0), 0};
  double before = -1;
  for (int k = 0; k < 1000 && mode.frequency != before; ++k) {
    before = mode.frequency;
    std::vector<double> moved(n);
    double force = 0, weight = 0;
    for (std::size_t j = n; j-- > 0;) {
      force += rows.mass[j] * mode.shape[j];
      weight += rows.mass[j] * g;
      moved[j] = rows.length[j] * force / weight;
    }
    std::partial_sum(moved.begin(), moved.end(), moved.begin());
    mode.frequency = std::sqrt(1 / moved.back());  // shape.back() is 1
    for (std::size_t j = 0; j < n; ++j) mode.shape[j] = moved[j] / moved.back();
  }
  return mode;
}

class Mode final : public Metric {
 public:
  /// rad, to the lowest row; lengthens the period by 0.06 %.
  static constexpr double kSmall = 0.1;
  /// Share of the first amplitude below which amplitudes do not count.
  static constexpr double kLeast = 0.01;

  static inline const ValueSpec kValues[] = {
      {.name = "mode.damping",
       .unit = kErrorShare,
       .help = lasting(
           "damping ratio of the lowest mode of small swings, whose exact value is 0: "
           "d/sqrt(4 pi^2 + d^2), d the logarithmic decrement per period, from the first amplitude "
           "to the last of at least " +
           percent(kLeast) +
           " of it. Has a value for rows that hang from a pinned one and are let go at most " +
           as_typed(kSmall) +
           " rad from rest, without damping, wind, colliders or self-collision; rows that stretch "
           "much bounce instead of swinging"),
       .window = Window::run,
       .title = "damping ratio of the lowest mode",
       .role = Role::motion},
      {.name = "mode.period",
       .unit = kSignedShare,
       .help = "period of that mode over the closed form for hanging rods, 2 pi/w with K s = w^2 M "
               "s, minus 1; measured between passages through the middle",
       .window = Window::run,
       .title = "error of the period of the lowest mode"},
  };

  static bool measures(const Scene& scene) {
    if (!hangs_in_rows(scene) || scene.damping != 0) return false;
    const double tilt = sideways(scene, scene.start).norm() / depth(scene);
    return tilt > 1e-9 && tilt <= kSmall;
  }

  explicit Mode(const Scene& scene)
      : grid_(*scene.mesh.grid), mass_(scene.mesh.mass), dt_(scene.dt) {
    Rows rows;
    for (int j = 1; j < grid_.nv; ++j) {
      double mass = 0;
      for (int i = 0; i < grid_.nu; ++i) mass += mass_[to_index(grid_.index(i, j))];
      rows.mass.push_back(mass);
      rows.length.push_back((scene.mesh.rest[to_index(grid_.index(0, j))] -
                             scene.mesh.rest[to_index(grid_.index(0, j - 1))])
                                .norm());
    }
    mode_ = lowest_mode(rows, scene.gravity.norm());
    along_ = sideways(scene, scene.start).normalized();
  }

  void observe(const Snapshot& m) override { swing_.push_back(displacement(m.state.x)); }
  std::vector<double> finish() override {
    std::vector<double> passes, peaks;
    for (std::size_t n = 1, last = 0; n < swing_.size(); ++n) {
      if (swing_[n - 1] == 0 || swing_[n - 1] * swing_[n] > 0) continue;
      const double part = swing_[n - 1] / (swing_[n - 1] - swing_[n]);
      if (!passes.empty()) {
        const double peak = largest(last, n);
        if (!peaks.empty() && peak < kLeast * peaks[0]) break;
        peaks.push_back(peak);
      }
      passes.push_back((static_cast<double>(n - 1) + part) * dt_);
      last = n;
    }
    if (peaks.size() < 2) return {Summary::kNone, Summary::kNone};
    const auto swings = static_cast<double>(peaks.size());  // number of half periods
    const double decrement = 2 * std::log(peaks.front() / peaks.back()) / (swings - 1),
                 turn = 2 * std::numbers::pi,
                 period = 2 * (passes[peaks.size()] - passes[0]) / swings;
    return {decrement / std::hypot(turn, decrement), period * mode_.frequency / turn - 1};
  }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone};
  }

 private:
  static bool hangs_in_rows(const Scene& scene) {
    const auto& grid = scene.mesh.grid;
    if (!grid || grid->nv < 2 || !scene.pin_motions.empty() || !scene.releases.empty() ||
        !scene.colliders.empty() || scene.wind || scene.self_collision || scene.gravity.isZero(0))
      return false;
    std::vector<int> first(to_index(grid->nu));
    std::iota(first.begin(), first.end(), 0);
    return scene.pins == first;
  }
  static double depth(const Scene& scene) {
    return (scene.mesh.rest[to_index(scene.mesh.grid->index(0, scene.mesh.grid->nv - 1))] -
            scene.mesh.rest[0])
        .norm();
  }
  /// Horizontal displacement of the middle of the lowest row from that of the first [m].
  static Vec3 sideways(const Scene& scene, const State& state) {
    const Grid& grid = *scene.mesh.grid;
    Vec3 way = Vec3::Zero();
    for (int i = 0; i < grid.nu; ++i)
      way += state.x[to_index(grid.index(i, grid.nv - 1))] - state.x[to_index(i)];
    const Vec3 down = scene.gravity.normalized();
    return (way - down.dot(way) * down) / grid.nu;
  }

  /// Projection of the motion on the mode.
  double displacement(const std::vector<Vec3>& x) const {
    double sum = 0;
    for (int j = 1; j < grid_.nv; ++j)
      for (int i = 0; i < grid_.nu; ++i) {
        const std::size_t at = to_index(grid_.index(i, j));
        sum += mass_[at] * mode_.shape[to_index(j - 1)] * along_.dot(x[at] - x[to_index(i)]);
      }
    return sum;
  }
  /// Maximum of |swing| between two boundaries, the first included: the top of the parabola through
  /// the largest value and its neighbours.
  double largest(std::size_t first, std::size_t end) const {
    std::size_t top = first;
    for (std::size_t n = first; n < end; ++n)
      if (std::abs(swing_[n]) > std::abs(swing_[top])) top = n;
    const double a = std::abs(swing_[top]), slope = (swing_[top + 1] - swing_[top - 1]) / 2,
                 bend = swing_[top + 1] - 2 * swing_[top] + swing_[top - 1];
    return a + (bend != 0 ? slope * slope / std::abs(2 * bend) : 0);
  }

  Grid grid_;
  std::vector<double> mass_;
  double dt_;
  LowestMode mode_;
  Vec3 along_;                 ///< unit, horizontal: direction in which it is released
  std::vector<double> swing_;  ///< kg m, of each boundary
};

}  // namespace

TAUT_METRIC(mode, Mode, "Artificial damping and period of the lowest swing",
            "logarithmic decrement; modes of hanging chains: D. Bernoulli 1733");

}  // namespace taut
