#include "core/reference/springs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/bending.hpp"
#include "core/model/index.hpp"
#include "core/model/membrane.hpp"
#include "core/reference/shake.hpp"

namespace taut::reference {

namespace {

/// The scene with springs in place of its rigid links.
Scene with_springs(Scene scene, double rigid) {
  for (double& stiffness : scene.stiffness)
    if (std::isinf(stiffness)) stiffness = rigid;
  return scene;
}

/// Largest speed of a body's surface [m/s], of a body that only moves along.
double speed_of(const Collider& body) { return body.motion.velocity.norm(); }

}  // namespace

struct Springs::Impl {
  struct Spring {
    std::size_t a, b;
    double rest, stiffness;  ///< m, N/m
  };

  Scene scene;
  double dt;
  long steps = 0;
  std::vector<double> w;
  std::vector<Spring> springs;
  std::vector<BendingElement> bending;
  MembraneModel membrane;
  std::vector<Vec3> x, v;  ///< v: half a step earlier
  std::vector<Vec3> force;
  /// Sum over all steps of the farthest that a vertex and a body came towards each other [m], and
  /// for each vertex the sum up to which it cannot touch any body.
  double gone = 0;
  std::vector<double> untouched;

  Impl(const Scene& of, double rigid, double h)
      : scene(with_springs(of, rigid)),
        dt(h),
        w(inverse_masses(of)),
        bending(make_bending(of)),
        membrane(make_membrane(of)),
        x(of.start.x),
        v(of.start.v),
        force(x.size(), Vec3::Zero()),
        untouched(x.size(), 0.0) {
    for (const Link& l : scene.links)
      if (w[to_index(l.a)] + w[to_index(l.b)] > 0)
        springs.push_back({to_index(l.a), to_index(l.b), l.rest,
                           scene.stiffness[static_cast<std::size_t>(l.family)]});
    // back to half a step before the start
    add_forces();
    for (std::size_t i = 0; i < x.size(); ++i)
      v[i] -= dt / 2 * (scene.gravity + w[i] * force[i] - scene.damping * v[i]);
  }

  double time() const { return static_cast<double>(steps) * dt; }

  void add_forces() {
    std::ranges::fill(force, Vec3::Zero());
    for (const Spring& s : springs) {
      const Vec3 between = x[s.b] - x[s.a];
      const double length = between.norm();
      if (length == 0) continue;  // there is no direction to pull in
      const Vec3 pull = s.stiffness * (length - s.rest) / length * between;
      force[s.a] += pull;
      force[s.b] -= pull;
    }
    for (const BendingElement& e : bending) {
      const Vec3 push = e.stiffness * e.value([&](std::size_t i) { return x[i]; });
      for (std::size_t i = 0; i < e.size; ++i) force[to_index(e.vertex[i])] -= e.weight[i] * push;
    }
    for (const MembraneElement& e : membrane.elements)
      membrane.add_forces(
          e, [&](std::size_t i) { return x[i]; },
          [&](std::size_t i, const Vec3& pull) { force[i] += pull; });
  }

  void step() {
    const double half = scene.damping * dt / 2;
    double farthest = 0;
    add_forces();
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w[i] == 0) {
        x[i] = pin_position(scene, static_cast<int>(i), time() + dt);
        continue;
      }
      v[i] = ((1 - half) * v[i] + dt * (scene.gravity + w[i] * force[i])) / (1 + half);
      farthest = std::max(farthest, v[i].squaredNorm());
    }
    if (!scene.colliders.empty()) gone += dt * (std::sqrt(farthest) + fastest_body());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w[i] > 0) move(i);
    ++steps;
  }

  double fastest_body() const {
    double most = 0;
    for (const Collider& body : scene.colliders) most = std::max(most, speed_of(body));
    return most;
  }

  void move(std::size_t i) {
    const Vec3 before = x[i];
    x[i] += dt * v[i];
    if (scene.colliders.empty() || gone < untouched[i]) return;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Collider& body : scene.colliders)
      nearest = std::min(nearest, keep_out(body, i, before));
    untouched[i] = gone + nearest;
    v[i] = (x[i] - before) / dt;
  }

  /// Contact of a vertex with a body; returns the gap before it [m], at least 0.
  double keep_out(const Collider& body, std::size_t i, const Vec3& before) {
    const Surface at = surface(shape_at(body, time() + dt), x[i]);
    const double depth = scene.thickness - at.distance;
    if (depth <= 0) return -depth;
    x[i] += depth * at.normal;
    if (body.friction == 0) return 0;
    const Vec3 carried_to = before + dt * body.motion.velocity;
    Vec3 along = x[i] - carried_to;
    along -= along.dot(at.normal) * at.normal;
    const double way = along.norm();
    if (way > 0) x[i] -= std::min(1.0, body.friction * depth / way) * along;
    return 0;
  }

  State state() const {
    State now{x, v};
    // v is of half a step ago, and the forces of the present places are not known before the next
    // step
    Impl ahead(*this);
    ahead.step();
    for (std::size_t i = 0; i < x.size(); ++i)
      now.v[i] = w[i] > 0 ? Vec3((v[i] + ahead.v[i]) / 2) : Vec3((ahead.x[i] - x[i]) / dt);
    return now;
  }
};

Springs::Springs(const Scene& scene, double rigid, double dt)
    : impl_(std::make_unique<Impl>(scene, rigid, dt)) {}
Springs::~Springs() = default;
void Springs::step() { impl_->step(); }
State Springs::state() const { return impl_->state(); }
double Springs::time() const { return impl_->time(); }

double Springs::longest_step(const Scene& scene, double rigid) {
  const double most = 2 / fastest_vibration(with_springs(scene, rigid));
  double dt = 1.0 / 64;
  while (dt > most / 2) dt /= 2;
  return dt;
}

std::vector<std::string> refuse_springs(const Scene& scene) {
  std::vector<std::string> reasons;
  const auto refuse = [&](bool it, const char* why) {
    if (it) reasons.emplace_back(why);
  };
  refuse(scene.self_collision.has_value(), "self-collision");
  refuse(std::ranges::any_of(scene.links, is_seam), "a seam: its length is 0");
  refuse(!scene.releases.empty(), "its pins let go");
  refuse(scene.link_damping > 0, "damping of links");
  refuse(scene.membrane && scene.membrane->damping > 0, "damping of the membrane");
  refuse(scene.wind.has_value(), "wind");
  for (const Collider& body : scene.colliders) {
    refuse(std::holds_alternative<MeshBody>(body.shape), "a body of triangles");
    refuse(!body.motion.spin.isZero(0) || !body.motion.path.empty(),
           "a body that turns or follows a path");
  }
  return reasons;
}

Vec3 pushed_out(const Scene& scene, const Vec3& x, double t) {
  Vec3 out = x;
  for (const Collider& body : scene.colliders) {
    const Surface at = surface(shape_at(body, t), out);
    if (at.distance < scene.thickness) out += (scene.thickness - at.distance) * at.normal;
  }
  return out;
}

}  // namespace taut::reference
