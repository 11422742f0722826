#include "core/solver/contact/contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/model/index.hpp"
#include "core/solver/contact/deforming_contact.hpp"
#include "core/solver/contact/mesh_surface.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/simd/contact.hpp"

namespace taut {

class Contacts::Surface {
 public:
  virtual ~Surface() = default;
  virtual void begin(double t, double h) = 0;
  /// Whether x is inside or `held`. If so, fills in `at`, except its vertex and collider. side: as
  /// in Contact::touched().
  virtual bool touches(std::size_t vertex, const Vec3& x, const Vec3& previous, bool held,
                       const Vec3* side, TouchingVertex& at) = 0;
  /// Sets the half-space of `at` to the one nearest to x.
  virtual void lay(const Vec3& x, TouchingVertex& at) = 0;
  virtual bool turns() const = 0;
  /// Turns the force on a vertex that the collider holds from the last substep to this one.
  virtual Vec3 turned(std::size_t vertex, const Vec3& force) const = 0;
};

namespace {

MeshSurface<double> surface_of(const MeshBody& body) { return MeshSurface<double>(body); }

template <template <class> class SurfaceOf>
class SurfaceIn final : public Contacts::Surface {
 public:
  SurfaceIn(const Collider& collider, double thickness, bool continuous, std::size_t vertices)
      : collider_(collider), continuous_(continuous), seen_(kIsMesh ? vertices : 0) {
    contact_.thickness = thickness;
    contact_.friction = collider.friction;
  }

  void begin(double t, double h) override {
    using Shape = typename SurfaceOf<double>::Shape;
    contact_.surface = surface_of(std::get<Shape>(shape_at(collider_, t + h)));
    contact_.motion = rigid_motion(collider_.motion, t, h);
  }

  bool touches(std::size_t vertex, const Vec3& x, const Vec3& previous, bool held, const Vec3* side,
               TouchingVertex& at) override {
    const Vec3T<double> to = vec3t<double>(x), before = vec3t<double>(previous);
    const Vec3T<double> last = side ? vec3t<double>(*side) : Vec3T<double>{};
    Tangent<double> tangent;
    const auto touched = [&](const Contact<double, SurfaceOf>& contact) {
      if (!contact.touched(to, before, continuous_, held, side ? &last : nullptr, tangent))
        return false;
      const Tangent<double> nearest = contact.surface.nearest(to);
      at.nearest = !is_thin() && point(nearest.normal) == point(tangent.normal) &&
                   nearest.offset == tangent.offset;
      return true;
    };
    if (!about(vertex, touched)) return false;
    set(at, tangent);
    at.from = point(contact_.motion(before));
    at.friction = contact_.friction;
    return true;
  }

  void lay(const Vec3& x, TouchingVertex& at) override {
    about(at.vertex, [&](const Contact<double, SurfaceOf>& contact) {
      set(at, contact.surface.nearest(vec3t<double>(x)));
      return true;
    });
  }

  bool turns() const override { return contact_.motion.moves; }
  Vec3 turned(std::size_t, const Vec3& v) const override {
    const auto& turn = contact_.motion.turn;
    const Vec3T<double> f = vec3t<double>(v);
    return {dot(turn[0], f), dot(turn[1], f), dot(turn[2], f)};
  }

 private:
  static constexpr bool kIsMesh = std::is_same_v<SurfaceOf<double>, MeshSurface<double>>;
  /// Calls ask(contact), for a body of triangles on a copy, because several threads ask about
  /// vertices.
  template <class Ask>
  bool about(std::size_t vertex, const Ask& ask) {
    if constexpr (!kIsMesh) return ask(contact_);
    Contact<double, SurfaceOf> contact = contact_;
    if constexpr (kIsMesh) contact.surface.ask_about(&seen_[vertex]);
    return ask(contact);
  }
  bool is_thin() const {
    if constexpr (kIsMesh) return contact_.surface.thin;
    return false;
  }
  void set(TouchingVertex& at, const Tangent<double>& tangent) const {
    at.normal = point(tangent.normal);
    at.offset = tangent.offset + contact_.thickness;
  }
  Collider collider_;
  bool continuous_;
  Contact<double, SurfaceOf> contact_{};
  std::vector<Seen> seen_;  ///< [vertices] for a body of triangles
};

class DeformingSurfaceIn final : public Contacts::Surface {
 public:
  DeformingSurfaceIn(const Collider& collider, double thickness, bool continuous,
                     std::size_t vertices)
      : contact_(collider, thickness), continuous_(continuous), touched_(vertices) {}

  void begin(double t, double h) override { contact_.begin(t, h); }

  bool touches(std::size_t vertex, const Vec3& x, const Vec3& previous, bool held, const Vec3* side,
               TouchingVertex& at) override {
    const auto path = contact_.path(x, previous);
    if (!held && contact_.beyond_all(path, contact_.reach(path, continuous_))) return false;
    const NearestPlace nearest = contact_.nearest(path);
    const auto where_nearest = contact_.touch(path, nearest, false, true);
    const bool slid = side && where_nearest->normal.dot(*side) > -1e-6;
    const auto touch = slid ? where_nearest : contact_.touch(path, nearest, continuous_, held);
    if (!touch) return false;
    at.nearest = !contact_.body().is_thin() && touch->normal == where_nearest->normal &&
                 touch->offset == where_nearest->offset;
    touched_[vertex] = touch->triangle;
    at.normal = touch->normal;
    at.offset = touch->offset + contact_.thickness();
    at.from = touch->from;
    at.friction = contact_.friction();
    return true;
  }

  void lay(const Vec3& x, TouchingVertex& at) override {
    const auto path = contact_.path(x, x);
    const auto touch = contact_.touch(path, contact_.nearest(path), false, true);
    at.normal = touch->normal;
    at.offset = touch->offset + contact_.thickness();
  }

  bool turns() const override { return true; }
  Vec3 turned(std::size_t vertex, const Vec3& force) const override {
    return contact_.body().turned(touched_[vertex], force);
  }

 private:
  DeformingContact contact_;
  bool continuous_;
  std::vector<int> touched_;  ///< [vertices]: the triangle at which each has touched last
};

/// Makes the Contacts::Surface of a shape.
struct SurfaceMaker {
  using Made = std::unique_ptr<Contacts::Surface>;
  const Collider& collider;
  double thickness;
  bool continuous;
  std::size_t vertices;

  Made operator()(const Plane&) const { return made<SurfaceIn<PlaneSurface>>(); }
  Made operator()(const Ball&) const { return made<SurfaceIn<BallSurface>>(); }
  Made operator()(const Box&) const { return made<SurfaceIn<BoxSurface>>(); }
  Made operator()(const Capsule&) const { return made<SurfaceIn<CapsuleSurface>>(); }
  Made operator()(const MeshBody&) const {
    return collider.frames ? made<DeformingSurfaceIn>() : made<SurfaceIn<MeshSurface>>();
  }

 private:
  template <class Of>
  Made made() const {
    return std::make_unique<Of>(collider, thickness, continuous, vertices);
  }
};

}  // namespace

Contacts::Contacts(const Scene& scene, bool continuous)
    : forces_(scene.start.x.size() * scene.colliders.size()) {
  for (const Collider& collider : scene.colliders)
    surfaces_.push_back(std::visit(
        SurfaceMaker{collider, scene.thickness, continuous, scene.start.x.size()}, collider.shape));
}
Contacts::~Contacts() = default;

void Contacts::restart() { forces_.assign(forces_.size(), {}); }

void Contacts::begin(double t, double h) {
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const Surface& surface = *surfaces_[k];
    surfaces_[k]->begin(t, h);
    if (!surface.turns()) continue;
    for (std::size_t f = k; f < forces_.size(); f += surfaces_.size())
      if (forces_[f].holds()) forces_[f].rub = surface.turned(f / surfaces_.size(), forces_[f].rub);
  }
}

bool Contacts::touches(std::size_t vertex, std::size_t collider, const Vec3& x,
                       const Vec3& previous, TouchingVertex& at, const MetInSubstep& met) {
  ContactForce& held = force(vertex, collider);
  const Vec3* side = met.side.isZero(0) ? nullptr : &met.side;
  if (!surfaces_[collider]->touches(vertex, x, previous, held.holds() || side, side, at))
    return false;
  at.vertex = vertex;
  at.collider = collider;
  held.rub = at.across(held.rub);
  return true;
}

template <class Real>
void Contacts::find(const Particles<Real>& p, std::vector<TouchingVertex>& all,
                    std::vector<MetInSubstep>* met) {
  all.clear();
  TouchingVertex at;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.w[i] == 0) continue;
    const Vec3 x = p.x[i].template cast<double>();
    const Vec3 previous = p.previous[i].template cast<double>();
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      MetInSubstep* const was = met ? &(*met)[i * surfaces_.size() + k] : nullptr;
      if (!touches(i, k, x, previous, at, was ? *was : MetInSubstep{})) continue;
      if (was) was->side = at.normal;
      all.push_back(at);
    }
  }
}
template void Contacts::find(const Particles<float>&, std::vector<TouchingVertex>&,
                             std::vector<MetInSubstep>*);
template void Contacts::find(const Particles<double>&, std::vector<TouchingVertex>&,
                             std::vector<MetInSubstep>*);

void Contacts::lay(TouchingVertex& at, const Vec3& x) {
  if (at.nearest) surfaces_[at.collider]->lay(x, at);
}

template <class Real>
void Contacts::predict(Particles<Real>& p, double h) {
  TouchingVertex at;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.w[i] == 0) continue;
    const Vec3 previous = p.previous[i].template cast<double>();
    const IsotropicCompliance free{static_cast<double>(p.w[i]) * h * h};
    bool touching = false;
    Vec3 x = p.x[i].template cast<double>();
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      if (!touches(i, k, x, previous, at)) continue;
      touching = true;
      settle(at, free, force(i, k), x);
    }
    if (touching) p.x.set(i, x.cast<Real>());
  }
}
template void Contacts::predict(Particles<float>&, double);
template void Contacts::predict(Particles<double>&, double);

template <class Real>
void Contacts::predict_new(const Particles<Real>& p, double h) {
  TouchingVertex at;
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3 x = p.x[i].template cast<double>();
    const Vec3 previous = p.previous[i].template cast<double>();
    const IsotropicCompliance free{static_cast<double>(p.w[i]) * h * h};
    for (std::size_t k = 0; p.w[i] > 0 && k < surfaces_.size(); ++k)
      if (!force(i, k).holds() && touches(i, k, x, previous, at)) settle(at, free, force(i, k), x);
  }
}
template void Contacts::predict_new(const Particles<float>&, double);
template void Contacts::predict_new(const Particles<double>&, double);

Vec3 Contacts::force_at(std::size_t vertex, const Vec3& x, const Vec3& previous) {
  Vec3 sum = Vec3::Zero();
  TouchingVertex at;
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    if (force(vertex, k).holds() && touches(vertex, k, x, previous, at))
      sum += at.total(force(vertex, k));
  return sum;
}

ContactForce MatrixCompliance::slipping(const TouchingVertex& at, const Vec3& free) const {
  const Vec3 u = at.normal.unitOrthogonal(), v = at.normal.cross(u);
  const Vec3 by_push = value * at.normal, by_u = value * u, by_v = value * v;
  const double along = at.normal.dot(by_push), pu = u.dot(by_push), pv = v.dot(by_push);
  const double suu = u.dot(by_u) - pu * pu / along, suv = u.dot(by_v) - pu * pv / along,
               svv = v.dot(by_v) - pv * pv / along;
  const double alone = -at.gap(free) / along;  // the push without friction
  const Vec3 way = free - at.from;
  const double su = u.dot(way) + pu * alone, sv = v.dot(way) + pv * alone;
  double lambda = 0, low = 0, high = std::numeric_limits<double>::infinity();
  ContactForce force;
  constexpr int kMostRounds = 50;
  for (int round = 0; round < kMostRounds; ++round) {
    const double a = suu + lambda, d = svv + lambda, det = a * d - suv * suv;
    const double ru = (suv * sv - d * su) / det, rv = (suv * su - a * sv) / det;
    const double length = std::sqrt(ru * ru + rv * rv);
    force = {alone - (pu * ru + pv * rv) / along, ru * u + rv * v};
    const double most = at.friction * force.push;
    if (std::abs(length - most) <= 1e-14 * length) break;
    (length > most ? low : high) = lambda;
    const double wu = (d * ru - suv * rv) / det, wv = (a * rv - suv * ru) / det;
    const double shorter = (ru * wu + rv * wv) / length;  // with lambda
    const double more = at.friction * (pu * wu + pv * wv) / along;
    const double next = lambda + (length - most) * length / (more * length + most * shorter);
    const double within = std::isfinite(high) ? (low + high) / 2 : 2 * low + suu + svv;
    const double to = next > low && next < high ? next : within;
    if (to == lambda) break;
    lambda = to;
  }
  force.push = std::max(0.0, force.push);
  force.rub *= at.cone(force.rub, force.push).share();
  return force;
}

std::unique_ptr<Contacts> make_contacts(const Scene& scene, const Params& params) {
  const bool continuous = params.is("contact", "continuous");
  if (scene.colliders.empty() || !(continuous || params.is("contact", "discrete"))) return nullptr;
  return std::make_unique<Contacts>(scene, continuous);
}

}  // namespace taut
