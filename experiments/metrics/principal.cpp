#include <Eigen/Core>
#include <array>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

using Gradient = Eigen::Matrix<double, 3, 2>;

/// A face at rest, in coordinates of its plane.
struct RestFace {
  Triangle corners;
  Eigen::Matrix2d inverse;                ///< 1/m, inverse of the two edges from the first corner
  Eigen::Vector2d weft, warp;             ///< unit: along u, along v; zero without a grid
  std::array<Eigen::Vector2d, 2> biases;  ///< unit, halfway between weft and warp
};

struct Kind {
  enum { first, second, warp, weft, bias, count };
};

class Principal final : public Metric {
 public:
  static inline const std::string_view kP95 =
      lasting("its 95th percentile, mean of " + LastSecond::samples_text());
  static inline const std::string_view kLargest =
      lasting("its largest, of " + LastSecond::samples_text());
  static inline const ValueSpec kValues[] = {
      {"principal.first.p50", kSignedShare,
       lasting("sigma_1 - 1 of each face, sigma_1 >= sigma_2 the singular values of F = "
               "[dx][dX]^-1: median over faces, mean of " +
               LastSecond::samples_text() + " of the last second")},
      {"principal.first.p95", kSignedShare, kP95},
      {"principal.first.max", kSignedShare, kLargest},
      {"principal.second.p50", kSignedShare, "1 - sigma_2, how far a face shortens: median"},
      {"principal.second.p95", kSignedShare, kP95},
      {"principal.second.max", kSignedShare, kLargest},
      {"principal.warp.p50", kErrorShare,
       "strain | |F d| - 1 | along the grid's v, the direction in which a sheet hangs: median"},
      {"principal.warp.p95", kErrorShare, kP95},
      {"principal.warp.max", kErrorShare, kLargest},
      {"principal.weft.p50", kErrorShare, "the same strain along the grid's u: median"},
      {"principal.weft.p95", kErrorShare, kP95},
      {"principal.weft.max", kErrorShare, kLargest},
      {"principal.bias.p50", kErrorShare,
       "the same strain along the two directions halfway between u and v, the larger one: median"},
      {"principal.bias.p95", kErrorShare, kP95},
      {"principal.bias.max", kErrorShare, kLargest},
  };
  static bool measures(const Scene& scene) { return !scene.mesh.triangles.empty(); }
  explicit Principal(const Scene& scene) : end_(scene) {
    const Mesh& mesh = scene.mesh;
    Vec3 u = Vec3::Zero(), v = Vec3::Zero();
    if (mesh.grid && mesh.grid->nu > 1 && mesh.grid->nv > 1) {
      u = (mesh.rest[to_index(mesh.grid->index(1, 0))] - mesh.rest[0]).normalized();
      v = (mesh.rest[to_index(mesh.grid->index(0, 1))] - mesh.rest[0]).normalized();
    }
    has_axes_ = !u.isZero(0);
    for (const Triangle& t : mesh.triangles) faces_.push_back(at_rest(t, mesh.rest, u, v));
  }

  void observe(const Snapshot& m) override {
    if (!end_.samples(m.step)) return;
    std::array<std::vector<double>, Kind::count> strains;
    for (const RestFace& face : faces_) {
      const std::array<double, Kind::count> s = measure(face, m.state.x);
      for (std::size_t k = 0; k < s.size(); ++k) strains[k].push_back(s[k]);
    }
    for (std::size_t k = 0; k < strains.size(); ++k) {
      median_[k].add(m.step, true, percentile(strains[k], 50));
      high_[k].add(m.step, true, percentile(strains[k], 95));
      largest_[k].add(m.step, true, percentile(strains[k], 100));
    }
  }
  std::vector<double> finish() override {
    std::vector<double> values;
    for (std::size_t k = 0; k < Kind::count; ++k) {
      const bool known = k < Kind::warp || has_axes_;
      values.push_back(known ? median_[k].mean() : Summary::kNone);
      values.push_back(known ? high_[k].mean() : Summary::kNone);
      values.push_back(known ? largest_[k].max() : Summary::kNone);
    }
    return values;
  }
  std::vector<double> now(const Snapshot&) const override {
    return std::vector<double>(std::size(kValues), Summary::kNone);
  }

 private:
  static RestFace at_rest(const Triangle& t, const std::vector<Vec3>& x, const Vec3& u,
                          const Vec3& v) {
    const Vec3 a = x[to_index(t[1])] - x[to_index(t[0])], b = x[to_index(t[2])] - x[to_index(t[0])];
    Gradient frame;
    frame.col(0) = a.normalized();
    frame.col(1) = (b - frame.col(0).dot(b) * frame.col(0)).normalized();
    Eigen::Matrix2d edges;
    edges.col(0) = frame.transpose() * a;
    edges.col(1) = frame.transpose() * b;
    const auto in_plane = [&](const Vec3& d) {
      return Eigen::Vector2d((frame.transpose() * d).normalized());
    };
    return {t, edges.inverse(), in_plane(u), in_plane(v), {in_plane(u + v), in_plane(u - v)}};
  }

  static std::array<double, Kind::count> measure(const RestFace& face, const std::vector<Vec3>& x) {
    const Vec3& origin = x[to_index(face.corners[0])];
    Gradient edges;
    edges.col(0) = x[to_index(face.corners[1])] - origin;
    edges.col(1) = x[to_index(face.corners[2])] - origin;
    const Gradient f = edges * face.inverse;
    const Eigen::Matrix2d c = f.transpose() * f;
    const double half = c.trace() / 2, apart = std::hypot((c(0, 0) - c(1, 1)) / 2, c(0, 1));
    const auto along = [&](const Eigen::Vector2d& d) { return std::abs((f * d).norm() - 1); };
    return {std::sqrt(half + apart) - 1, 1 - std::sqrt(std::max(0.0, half - apart)),
            along(face.warp), along(face.weft),
            std::max(along(face.biases[0]), along(face.biases[1]))};
  }

  /// Percentile by nearest rank: the smallest value that at least this percentage of the values
  /// does not exceed.
  static double percentile(std::vector<double>& values, std::size_t percent) {
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>((values.size() * percent + 99) / 100 - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  }

  std::vector<RestFace> faces_;
  bool has_axes_ = false;
  LastSecond end_;
  std::array<Summary, Kind::count> median_, high_, largest_;
};

}  // namespace

TAUT_METRIC(principal, Principal, "How each face stretches, shortens and shears",
            "singular values of the deformation gradient of linear triangles; Provot 1995");

}  // namespace taut
