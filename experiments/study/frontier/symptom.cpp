#include <algorithm>
#include <limits>
#include <numeric>

#include "core/model/index.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"

namespace taut {

namespace {

// Shares: of a link's length, of a way, of energy, of the size.
constexpr double kStretched = 1, kFrozen = 0.1, kGained = 0.05, kLost = 0.5, kMirrored = 0.1;
constexpr double kJitter = 981;     ///< m/s^2, 100 g
constexpr double kMoreJitter = 10;  ///< factor relative to the start of the range

bool passive(const Scene& scene) {
  return !scene.wind && scene.colliders.empty() && scene.pin_motions.empty() &&
         scene.releases.empty() &&
         std::ranges::all_of(scene.start.v, [](const Vec3& v) { return v.isZero(0); });
}

/// Unit of the energy metrics, m g L [J].
double energy_unit(const Scene& scene) {
  const double mass = std::accumulate(scene.mesh.mass.begin(), scene.mesh.mass.end(), 0.0);
  return mass * scene.gravity.norm() * extent(scene);
}

/// Mirror image of a vertex within its row.
std::size_t mirrored(const Grid& grid, int vertex) {
  return to_index(grid.index(grid.nu - 1 - vertex % grid.nu, vertex / grid.nu));
}

}  // namespace

double swing_energy(const Scene& scene) {
  if (!passive(scene) || scene.pins.empty() || scene.gravity.isZero(0)) return 0;
  const Vec3 up = -scene.gravity.normalized();
  double energy = 0;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    double reach = std::numeric_limits<double>::infinity(), height = 0;
    for (const int pin : scene.pins) {
      const double way = (scene.mesh.rest[i] - scene.mesh.rest[to_index(pin)]).norm();
      if (way < reach) {
        reach = way;
        height = scene.start.x[to_index(pin)].dot(up);
      }
    }
    energy +=
        scene.mesh.mass[i] * scene.gravity.norm() * (scene.start.x[i].dot(up) - (height - reach));
  }
  return energy;
}

double asymmetry(const Scene& scene, const std::vector<Vec3>& end) {
  if (!scene.mesh.grid || end.size() != scene.start.x.size() || !scene.colliders.empty()) return 0;
  const Grid& grid = *scene.mesh.grid;
  const double middle = (scene.start.x[to_index(grid.index(0, 0))].x() +
                         scene.start.x[to_index(grid.index(grid.nu - 1, 0))].x()) /
                        2;
  const auto apart = [&](const std::vector<Vec3>& x) {
    double most = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec3 image = x[mirrored(grid, static_cast<int>(i))];
      image.x() = 2 * middle - image.x();
      most = std::max(most, (x[i] - image).norm());
    }
    return most;
  };
  const bool sideways = scene.gravity.x() != 0 || (scene.wind && scene.wind->velocity.x() != 0);
  if (sideways || apart(scene.start.x) > 1e-6 * extent(scene)) return 0;
  return apart(end);
}

std::vector<std::string> symptoms(const JudgedRun& seen, const JudgedRun* start) {
  const Status& status = seen.record.status;
  const Scene& scene = *seen.one.scene;
  if (status.kind == Status::Kind::exploded)
    return {status.reason == Reason::nonfinite ? "NaN" : "explodes"};
  if (status.kind == Status::Kind::crash) return {"crashes"};
  if (status.kind == Status::Kind::unsupported) return {"refuses"};
  std::vector<std::string> found;
  const auto add = [&](bool is, const char* name) {
    if (is) found.emplace_back(name);
  };
  const auto now = [&](const char* name) { return seen.record.value(name); };
  const double swing = swing_energy(scene) / std::max(energy_unit(scene), 1e-300);
  add(now("tunnelling.count") > 0, "tunnels");
  add(now("stretch.max") > kStretched || status.kind == Status::Kind::extreme, "overstretches");
  if (start) {
    const double smaller = std::min(1.0, extent(scene) / extent(*start->one.scene));
    add(now("drift.max") < kFrozen * smaller * start->record.value("drift.max"), "freezes");
  }
  add(swing > 0 && now("energy.peak") > kGained * swing, "gains energy");
  const double calm = start ? kMoreJitter * start->record.value("popping.max") : 0;
  add((now("popping.max") > kJitter && now("popping.max") > calm) ||
          status.kind == Status::Kind::unsettled,
      "jitters");
  add(asymmetry(scene, seen.end) > kMirrored * extent(scene), "asymmetric");
  add(swing > 0 && now("energy.mean") < -kLost * swing, "loses energy");
  return found;
}

}  // namespace taut
