#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Faces whose corners are all pinned lie on the support, in a plane across gravity. A round cloth
/// lies on a disc, as in the standard: the disc reaches to the outermost pinned vertex, because the
/// pinned faces leave gaps at its edge.
class Drape final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "drape.coefficient",
       .unit = kSignedShare,
       .help = "(shadow - support)/(cloth - support), mean over the last second: the area that the "
               "cloth covers seen along gravity, the area of the support, and that of all faces at "
               "rest; 100 %: flat, 0 %: hangs straight down. The support is the disc of the pinned "
               "vertices if the cloth is round (ISO 9073-9), otherwise the faces whose corners are "
               "all pinned. Has a value if the pinned faces lie across gravity",
       .in_series = true,
       .title = "drape coefficient"}};
  static bool measures(const Scene& scene) {
    if (scene.gravity.isZero(0)) return false;
    const double supported = area_of_pinned(scene), all = area_if(scene, kAll);
    return supported > 0 && supported < all * (1 - 1e-9);
  }
  explicit Drape(const Scene& scene)
      : faces_(scene.mesh.triangles),
        support_(area_of_support(scene)),
        cloth_(area_if(scene, kAll)),
        end_(scene) {
    const Vec3 down = scene.gravity.normalized();
    across_ = down.unitOrthogonal();
    other_ = down.cross(across_);
  }

  void observe(const Snapshot& m) override {
    if (end_.samples(m.step)) coefficient_.add(m.step, true, now(m)[0]);
  }
  std::vector<double> finish() override { return {coefficient_.mean()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {(shadow(m.state.x) - support_) / (cloth_ - support_)};
  }

 private:
  static Vec3 doubled_area(const Scene& s, const Triangle& t) {
    const auto x = [&](std::size_t k) -> const Vec3& { return s.mesh.rest[to_index(t[k])]; };
    return (x(1) - x(0)).cross(x(2) - x(0));
  }
  template <class Chosen>
  static double area_if(const Scene& scene, const Chosen& chosen) {
    double sum = 0;
    for (const Triangle& t : scene.mesh.triangles)
      if (chosen(t)) sum += doubled_area(scene, t).norm() / 2;
    return sum;
  }
  /// Area of the pinned faces; 0 if one of them does not lie across gravity.
  static double area_of_pinned(const Scene& scene) {
    bool level = true;
    const double area = area_if(scene, [&](const Triangle& t) {
      const bool pinned =
          std::ranges::all_of(t, [&](int vertex) { return is_pinned(scene, vertex); });
      const Vec3 normal = doubled_area(scene, t).normalized();
      if (pinned) level = level && normal.cross(scene.gravity.normalized()).norm() < 1e-3;
      return pinned;
    });
    return level ? area : 0;
  }

  static double area_of_support(const Scene& scene) {
    const std::vector<Vec3>& x = scene.mesh.rest;
    const Vec3 centre = centre_of(scene);
    double near = Summary::kInfinity, far = 0;  // distances of the cloth's own edge from the centre
    for (const int v : rim_of(scene.mesh)) {
      const double distance = (x[to_index(v)] - centre).norm();
      near = std::min(near, distance);
      far = std::max(far, distance);
    }
    if (near < 0.99 * far) return area_of_pinned(scene);
    double radius = 0;
    for (const int v : scene.pins) radius = std::max(radius, (x[to_index(v)] - centre).norm());
    return std::numbers::pi * radius * radius;
  }

  /// Centre of the cloth's area at rest.
  static Vec3 centre_of(const Scene& scene) {
    Vec3 sum = Vec3::Zero();
    for (const Triangle& t : scene.mesh.triangles)
      for (const int v : t) sum += doubled_area(scene, t).norm() / 6 * scene.mesh.rest[to_index(v)];
    return sum / area_if(scene, kAll);
  }

  /// The vertices of edges with a single face.
  static std::set<int> rim_of(const Mesh& mesh) {
    std::map<std::pair<int, int>, int> faces;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) ++faces[std::minmax({t[k], t[(k + 1) % 3]})];
    std::set<int> rim;
    for (const auto& [edge, count] : faces)
      if (count == 1) rim.insert({edge.first, edge.second});
    return rim;
  }

  /// Area of the union of the projected faces [m^2]: exact along each of kLines equidistant lines.
  double shadow(const std::vector<Vec3>& x) const {
    double low = Summary::kInfinity, high = -Summary::kInfinity;
    std::vector<std::pair<double, double>> p;  // along lines, across them
    for (const Vec3& one : x) {
      p.emplace_back(across_.dot(one), other_.dot(one));
      low = std::min(low, p.back().second);
      high = std::max(high, p.back().second);
    }
    const double width = (high - low) / kLines;
    if (!(width > 0)) return 0;
    std::vector<std::vector<std::pair<double, double>>> covered(kLines);
    for (const Triangle& t : faces_) cover(t, p, low, width, covered);
    double sum = 0;
    for (auto& line : covered) {
      std::ranges::sort(line);
      double reached = -Summary::kInfinity;
      for (const auto& [from, to] : line) {
        if (to > reached) sum += to - std::max(from, reached);
        reached = std::max(reached, to);
      }
    }
    return sum * width;
  }

  /// Adds to each line the part that a face covers. Line n is at low + (n + 1/2) width.
  static void cover(const Triangle& t, const std::vector<std::pair<double, double>>& p, double low,
                    double width, std::vector<std::vector<std::pair<double, double>>>& covered) {
    const auto [first, last] =
        std::minmax({p[to_index(t[0])].second, p[to_index(t[1])].second, p[to_index(t[2])].second});
    const int begin = std::max(0, static_cast<int>(std::ceil((first - low) / width - 0.5)));
    for (int n = begin; n < kLines && low + (n + 0.5) * width < last; ++n) {
      const double at = low + (n + 0.5) * width;
      double from = Summary::kInfinity, to = -from;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& [ax, ay] = p[to_index(t[k])];
        const auto& [bx, by] = p[to_index(t[(k + 1) % 3])];
        if ((ay <= at) == (by <= at)) continue;
        const double crossing = ax + (at - ay) / (by - ay) * (bx - ax);
        from = std::min(from, crossing);
        to = std::max(to, crossing);
      }
      if (from < to) covered[to_index(n)].emplace_back(from, to);
    }
  }

  static constexpr auto kAll = [](const Triangle&) { return true; };
  static constexpr int kLines = 1000;
  std::vector<Triangle> faces_;
  double support_, cloth_;  ///< m^2
  Vec3 across_, other_;     ///< axes in the plane across gravity
  LastSecond end_;
  Summary coefficient_;
};

}  // namespace

TAUT_METRIC(drape, Drape, "How much of a cloth on a support hangs: Cusick's drape coefficient",
            "ISO 9073-9, BS 5058; the shadow by lines, exact along each");

}  // namespace taut
