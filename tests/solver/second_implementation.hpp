#pragma once

// Second implementation of the solvers in core/solver, in plain loops, as papers and documents
// state them.

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"

namespace taut::second {

/// Rotates a point by Rodrigues' formula.
inline Vec3 turned(const Vec3& p, const Vec3& spin, double t) {
  const double angle = spin.norm() * t;
  if (angle == 0) return p;
  const Vec3 axis = spin.normalized();
  return std::cos(angle) * p + std::sin(angle) * axis.cross(p) +
         (1 - std::cos(angle)) * axis.dot(p) * axis;
}

inline Vec3 displacement(const Motion& m, double t) {
  Vec3 d = t * m.velocity;
  if (m.path.empty()) return d;
  for (std::size_t k = 1; k < m.path.size(); ++k) {
    const auto &a = m.path[k - 1], &b = m.path[k];
    const double share = std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0);
    d += share * (b.displacement - a.displacement);
  }
  return d + m.path.front().displacement;
}

/// Position at time t of the point that starts at `start`. Its inverse, started(), takes the point
/// at `p` at time t back to its start.
inline Vec3 moved(const Motion& m, const Vec3& start, double t) {
  return turned(start - m.pivot, m.spin, t) + m.pivot + displacement(m, t);
}
inline Vec3 started(const Motion& m, const Vec3& p, double t) {
  return turned(p - displacement(m, t) - m.pivot, -m.spin, t) + m.pivot;
}

struct Hit {
  double distance;  ///< to the surface, negative inside
  Vec3 normal;
};

/// Surface of a collider at time t, as seen from the point p.
inline Hit surface_at(const Collider& c, const Vec3& p, double t) {
  const Vec3 q = started(c.motion, p, t);
  Vec3 normal;
  double distance;
  if (const auto* plane = std::get_if<Plane>(&c.shape)) {
    normal = plane->normal;
    distance = normal.dot(q) - plane->offset;
  } else if (const auto* ball = std::get_if<Ball>(&c.shape)) {
    normal = (q - ball->center).normalized();
    distance = (q - ball->center).norm() - ball->radius;
  } else if (const auto* capsule = std::get_if<Capsule>(&c.shape)) {
    const Vec3 axis = (capsule->to - capsule->from).normalized();
    const double along = axis.dot(q - capsule->from);
    Vec3 out = q - capsule->from - along * axis;  // from the capsule's axis
    if (along < 0) out = q - capsule->from;
    if (along > (capsule->to - capsule->from).norm()) out = q - capsule->to;
    normal = out.normalized();
    distance = out.norm() - capsule->radius;
  } else {
    const Box& box = std::get<Box>(c.shape);
    const Eigen::Matrix3d axes = box.rotation.toRotationMatrix();
    const Vec3 local = axes.transpose() * (q - box.center);
    const Vec3 nearest = local.cwiseMin(box.half_extents).cwiseMax(-box.half_extents);
    if ((local - nearest).norm() > 0) {
      normal = (local - nearest).normalized();
      distance = (local - nearest).norm();
    } else {
      distance = -1e300;
      for (int axis = 0; axis < 3; ++axis)
        if (const double d = std::abs(local[axis]) - box.half_extents[axis]; d > distance) {
          distance = d;
          normal = Vec3::Unit(axis) * std::copysign(1.0, local[axis]);
        }
    }
    normal = axes * normal;
  }
  return {distance, turned(normal, c.motion.spin, t)};
}

/// Base of all solvers here: positions, places of the pins, wind.
struct Cloth {
  explicit Cloth(const Scene& s) : scene(s), x(s.start.x), v(s.start.v) {
    for (const double mass : s.mesh.mass) w.push_back(1 / mass);
    for (const int pin : s.pins) w[to_index(pin)] = 0;
  }
  void move_pins(double t) {
    for (const PinMotion& group : scene.pin_motions)
      for (const int pin : group.vertices)
        x[to_index(pin)] = moved(group.motion, scene.start.x[to_index(pin)], t);
  }
  /// Accelerations by gravity and by Vasilovici's wind; each corner takes a third of its face's
  /// force.
  std::vector<Vec3> accelerations(const std::vector<Vec3>& velocity) const {
    std::vector<Vec3> a(x.size(), scene.gravity);
    if (!scene.wind) return a;
    for (const auto& [i, j, k] : scene.mesh.triangles) {
      const Vec3 both = (x[to_index(j)] - x[to_index(i)]).cross(x[to_index(k)] - x[to_index(i)]),
                 face = (velocity[to_index(i)] + velocity[to_index(j)] + velocity[to_index(k)]) / 3,
                 normal = both.normalized();
      const double through = normal.dot(scene.wind->velocity - face);
      for (const int corner : {i, j, k})
        a[to_index(corner)] +=
            w[to_index(corner)] * scene.wind->strength * through * both.norm() / 2 / 3 * normal;
    }
    return a;
  }

  const Scene& scene;
  std::vector<Vec3> x, v;
  std::vector<double> w;
};

struct Settings {
  int iterations = 3, substeps = 1;
  bool tethers = false;
  int levels = 1;
  double omega = 1;
  bool contact_in_sweeps = true;
  bool octree = false;
  std::map<Family, double> compliance;  ///< m/N
};

/// Position-based dynamics: Jakobsen's algorithm, and XPBD where links comply.
class Relaxing : public Cloth {
 public:
  Relaxing(const Scene& s, const Settings& settings) : Cloth(s), set_(settings) {
    h_ = s.dt / settings.substeps;
    for (std::size_t i = 0; i < x.size(); ++i) before_.push_back(x[i] - h_ * v[i]);
    if (settings.tethers) find_tethers();
    if (settings.levels > 1) find_levels();
  }

  void step(double t) {
    for (int s = 1; s <= set_.substeps; ++s) substep(t + s * h_);
  }
  State state() const {
    State s{x, x};
    for (std::size_t i = 0; i < x.size(); ++i) s.v[i] = (x[i] - before_[i]) / h_;
    return s;
  }

 private:
  void substep(double end) {
    for (std::size_t i = 0; i < x.size(); ++i) v[i] = (x[i] - before_[i]) / h_;
    const auto a = accelerations(v);
    for (std::size_t i = 0; i < x.size(); ++i) {
      before_[i] = x[i];
      if (w[i] > 0) x[i] += h_ * std::exp(-scene.damping * h_) * v[i] + h_ * h_ * a[i];
    }
    move_pins(end);
    leaves_.clear();
    if (set_.octree) {
      std::vector<std::size_t> all(x.size());
      std::iota(all.begin(), all.end(), 0);
      Eigen::AlignedBox3d box;
      for (const Vec3& p : x) box.extend(p);
      plant(all, box, 0);
    }
    std::vector<double> lambda(scene.links.size(), 0);
    for (int k = 0; k < set_.iterations; ++k) {
      relax_levels();
      for (const auto& [vertex, pin, length] : tethers_) {
        const Vec3 line = x[vertex] - x[pin];
        if (line.norm() > length) x[vertex] = x[pin] + length * line.normalized();
      }
      for (const Family family : kFamilies)
        for (std::size_t l = 0; l < scene.links.size(); ++l)
          if (scene.links[l].family == family) relax(scene.links[l], lambda[l]);
      for (const auto& leaf : leaves_) part(leaf);
      if (set_.contact_in_sweeps) collide(end);
    }
    if (!set_.contact_in_sweeps) collide(end);
  }

  void relax(const Link& l, double& lambda) {
    const std::size_t a = to_index(l.a), b = to_index(l.b);
    if (w[a] + w[b] == 0) return;
    const auto given = set_.compliance.find(l.family);
    const double soft = given == set_.compliance.end() ? 0 : given->second / (h_ * h_);
    const Vec3 n = (x[b] - x[a]).normalized();
    const double excess = (x[b] - x[a]).norm() - l.rest,
                 change = -set_.omega * (excess + soft * lambda) / (w[a] + w[b] + soft);
    lambda += change;
    x[a] -= w[a] * change * n;
    x[b] += w[b] * change * n;
  }

  void collide(double end) {
    for (const Collider& c : scene.colliders)
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (w[i] == 0) continue;
        const Hit hit = surface_at(c, x[i], end);
        const double depth = scene.thickness - hit.distance;
        if (depth <= 0) continue;
        x[i] += depth * hit.normal;
        Vec3 slip = x[i] - moved(c.motion, started(c.motion, before_[i], end - h_), end);
        slip -= slip.dot(hit.normal) * hit.normal;
        const double most = c.friction * depth;
        x[i] -= slip.norm() <= most ? slip : Vec3(most * slip.normalized());
      }
  }

  /// Cubes with more than eight particles are split along each axis, at most twelve times.
  void plant(const std::vector<std::size_t>& in, const Eigen::AlignedBox3d& box, int depth) {
    if (in.size() <= 8 || depth == 12) {
      leaves_.push_back(in);
      return;
    }
    for (int child = 0; child < 8; ++child) {
      std::vector<std::size_t> within;
      Eigen::AlignedBox3d part = box;
      for (int axis = 0; axis < 3; ++axis)
        (child & 1 << axis ? part.min() : part.max())[axis] = box.center()[axis];
      for (const std::size_t i : in) {
        int place = 0;
        for (int axis = 0; axis < 3; ++axis) place += (x[i][axis] > box.center()[axis]) << axis;
        if (place == child) within.push_back(i);
      }
      plant(within, part, depth + 1);
    }
  }

  /// Two particles that overlap go back to their places before the step.
  void part(const std::vector<std::size_t>& leaf) {
    const double diameter = 2 * scene.self_collision->radius;
    for (std::size_t k = 0; k < leaf.size(); ++k)
      for (std::size_t m = k + 1; m < leaf.size(); ++m)
        if ((x[leaf[k]] - x[leaf[m]]).norm() < diameter)
          for (const std::size_t i : {leaf[k], leaf[m]})
            if (w[i] > 0) x[i] = before_[i];
  }

  bool straight() const {
    return scene.mesh.grid && std::ranges::any_of(scene.links, [](const Link& l) {
             return l.family == Family::shear;
           });
  }

  /// Links each vertex to the nearest pin of every group of linked pins, the nearest group first
  /// (SCA 2012).
  void find_tethers() {
    const std::size_t n = x.size();
    std::vector<std::vector<double>> way(n, std::vector<double>(n, 1e300));
    std::vector<int> group(n);
    std::iota(group.begin(), group.end(), 0);
    for (std::size_t i = 0; i < n; ++i) way[i][i] = 0;
    for (const Link& l : scene.links)
      if (l.family != Family::bend) {
        way[to_index(l.a)][to_index(l.b)] = way[to_index(l.b)][to_index(l.a)] = l.rest;
        if (w[to_index(l.a)] + w[to_index(l.b)] == 0)
          for (int& g : group)
            if (g == group[to_index(l.b)] && &g != &group[to_index(l.a)]) g = group[to_index(l.a)];
      }
    for (std::size_t k = 0; k < n; ++k)  // Floyd-Warshall algorithm
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) way[i][j] = std::min(way[i][j], way[i][k] + way[k][j]);
    for (std::size_t i = 0; i < n; ++i) {
      if (w[i] == 0) continue;
      std::map<int, std::size_t> nearest;
      for (std::size_t pin = 0; pin < n; ++pin)
        if (w[pin] == 0) {
          const auto [place, is_new] = nearest.try_emplace(group[pin], pin);
          if (way[i][pin] < way[i][place->second]) place->second = pin;
        }
      std::vector<Tether> found;
      for (const auto& [g, pin] : nearest)
        found.push_back(
            {i, pin,
             straight() ? (scene.mesh.rest[i] - scene.mesh.rest[pin]).norm() : way[i][pin]});
      std::ranges::stable_sort(found, {}, &Tether::length);
      if (found.size() > 4) found.resize(4);
      tethers_.insert(tethers_.end(), found.begin(), found.end());
    }
  }

  /// Each level is a greedy independent set of the level below, plus all pins (Mueller 2008).
  void find_levels() {
    std::vector<Link> links;
    for (const Link& l : scene.links)
      if (l.family == Family::structural) links.push_back(l);
    std::vector<std::size_t> vertices(x.size());
    std::iota(vertices.begin(), vertices.end(), 0);
    for (int k = 1; k < set_.levels; ++k) {
      std::map<std::size_t, std::vector<std::pair<std::size_t, double>>> near;
      for (const Link& l : links) {
        near[to_index(l.a)].emplace_back(to_index(l.b), l.rest);
        near[to_index(l.b)].emplace_back(to_index(l.a), l.rest);
      }
      std::map<std::size_t, bool> coarse;
      for (const std::size_t i : vertices) coarse[i] = w[i] == 0;
      for (const std::size_t i : vertices)
        coarse[i] = coarse[i] || std::ranges::none_of(near[i], [&](const auto& end) {
                      return coarse[end.first] && w[end.first] > 0;
                    });
      Level level;
      std::map<std::pair<std::size_t, std::size_t>, double> rest;
      const auto offer = [&](std::size_t a, std::size_t b, double length) {
        if (a == b) return;
        if (straight()) length = (scene.mesh.rest[a] - scene.mesh.rest[b]).norm();
        const auto [place, is_new] = rest.try_emplace({std::min(a, b), std::max(a, b)}, length);
        place->second = std::min(place->second, length);
      };
      std::vector<std::size_t> above;
      for (const std::size_t i : vertices) {
        std::vector<std::pair<std::size_t, double>> parents;
        for (const auto& end : near[i])
          if (coarse[end.first]) parents.push_back(end);
        if (coarse[i]) {
          above.push_back(i);
          for (const auto& [b, length] : parents) offer(i, b, length);
          continue;
        }
        for (const auto& [a, to_a] : parents)
          for (const auto& [b, to_b] : parents) offer(a, b, to_a + to_b);
        double sum = 0;
        for (auto& [parent, length] : parents) {
          sum += 1 / length;
          length = 1 / length;
        }
        for (auto& [parent, weight] : parents) weight /= sum;
        if (!parents.empty()) level.children.emplace_back(i, parents);
      }
      links.clear();
      for (const auto& [ends, length] : rest)
        links.push_back({static_cast<int>(ends.first), static_cast<int>(ends.second), length,
                         Family::structural});
      level.links = links;
      vertices = above;
      levels_.insert(levels_.begin(), level);
    }
  }

  void relax_levels() {
    const std::vector<Vec3> start = x;
    double none = 0;
    const double omega = std::exchange(set_.omega, 1);
    for (const Level& level : levels_) {
      for (const Link& l : level.links)
        if ((x[to_index(l.a)] - x[to_index(l.b)]).norm() > l.rest) relax(l, none);
      for (const auto& [child, parents] : level.children)
        for (const auto& [parent, weight] : parents)
          if (w[child] > 0) x[child] += weight * (x[parent] - start[parent]);
    }
    set_.omega = omega;
  }

  struct Tether {
    std::size_t vertex, pin;
    double length;
  };
  struct Level {
    std::vector<Link> links;
    std::vector<std::pair<std::size_t, std::vector<std::pair<std::size_t, double>>>> children;
  };
  Settings set_;
  double h_;
  std::vector<Vec3> before_;
  std::vector<Tether> tethers_;
  std::vector<Level> levels_;  ///< coarsest first
  std::vector<std::vector<std::size_t>> leaves_;
};

}  // namespace taut::second
