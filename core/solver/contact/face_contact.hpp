#pragma once

#include <optional>

#include "core/model/deforming_body.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Keeps the faces, not just their corners, out of a ball or a capsule, and edges and corners of a
/// box or a solid body of triangles out of the faces. Of each face that is too deep, the deepest
/// point is moved out along the surface's normal; its corners share the correction by their
/// barycentric weights b and inverse masses w,
///
///     dx_i = w_i b_i s n / sum of w_j b_j^2,
///
/// so that the point moves by s n and momentum changes along n alone.
///
/// With a solver that has a target y, a face keeps the force F at its point from sweep to sweep and
/// from substep to substep, as long as Signorini and Coulomb ask for it, were the corners free
/// (settle() in contacts.hpp); its changes move y as they move x, so that links feel b F.
template <class Real>
class FaceContactPass final : public Pass<Real> {
 public:
  /// The collider is no plane and no thin body. solver: null, or that of the links, whose target
  /// moves as well.
  FaceContactPass(const Collider& collider, double thickness, std::vector<Triangle> faces,
                  Pass<Real>* solver)
      : collider_(collider),
        thickness_(thickness),
        faces_(std::move(faces)),
        solver_(solver),
        held_(solver ? faces_.size() : 0) {
    if (collider_.frames) deforming_.emplace(collider_);
  }

  void restart() override { held_.assign(held_.size(), {}); }
  void take_over(const Pass<Real>& before) override {
    held_ = static_cast<const FaceContactPass&>(before).held_;
  }

  void begin(Particles<Real>& p, double t, double dt) override {
    if (deforming_) {
      deforming_->move(t, t + dt);
      shape_ = deforming_->body();
    } else {
      shape_ = shape_at(collider_, t + dt);
    }
    motion_ = rigid_motion(collider_.motion, t, dt);
    if (Ball* ball = std::get_if<Ball>(&shape_)) {
      ball->radius += thickness_;
      center_ = ball->center;
      reach_ = ball->radius;
    }
    if (Box* box = std::get_if<Box>(&shape_)) {
      box->half_extents.array() += thickness_;
      center_ = box->center;
      reach_ = box->half_extents.norm();
    }
    if (Capsule* capsule = std::get_if<Capsule>(&shape_)) {
      capsule->radius += thickness_;
      center_ = capsule->middle();
      reach_ = (capsule->to - capsule->from).norm() / 2 + capsule->radius;
    }
    if (const MeshBody* body = std::get_if<MeshBody>(&shape_)) {
      const Eigen::AlignedBox3d& box = body->mesh->box();
      center_ = body->center + body->rotation * box.center();
      reach_ = box.diagonal().norm() / 2 + thickness_;
    }
    for (std::size_t f = 0; f < held_.size(); ++f)  // of the last substep; p.x is y
      if (held_[f].holds()) {
        held_[f].force = turned(held_[f], at_start(p, faces_[f], held_[f].weights));
        add_force(p.x, p, faces_[f], held_[f].weights, dt * dt * held_[f].force);
      }
  }

  void apply(Particles<Real>& p, double, double dt) override {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Triangle& face = faces_[f];
      const Corners t{at(p.x, face[0]), at(p.x, face[1]), at(p.x, face[2])};
      const double side2 = std::max((t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm());
      const bool holds = solver_ && held_[f].holds();
      // every point of the face is within a side of its first corner
      if (!holds && (t[0] - center_).squaredNorm() >= 2 * (reach_ * reach_ + side2)) continue;
      Separation out = separation_of(shape_, t);
      if (out.length <= 0 && holds) out = outside(t, held_[f].weights);
      if (solver_ && (out.length > 0 || holds)) hold(p, face, out, dt, held_[f]);
      if (!solver_ && out.length > 0) push(p, face, out);
    }
  }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "faces on " + std::string(type_name(collider_.shape)),
         .items = faces_.size(),
         .bytes = sizeof(*this) + faces_.size() * sizeof(Triangle) + held_.size() * sizeof(Held)}};
  }

 private:
  /// How the deepest point of a face leaves a solid.
  struct Separation {
    double length = 0;           ///< m; <= 0: it is outside
    Vec3 normal = Vec3::Zero();  ///< unit
    TrianglePoint point;
  };
  /// What holds a face [N], and at which of its points.
  struct Held {
    Vec3 force = Vec3::Zero(), weights = Vec3::Zero();
    bool holds() const { return !force.isZero(0); }
  };

  /// A point that is equally deep below several sides leaves between them, over their common edge
  /// or corner: along n = sum of their normals, by depth / (n . one of them).
  static Separation over_edge(const Box& box, const Deepest& deepest) {
    const Vec3 local = box.rotation.conjugate() * (deepest.at.position - box.center);
    const Vec3 depths = box.half_extents - local.cwiseAbs();
    Vec3 out = Vec3::Zero();
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (depths[axis] <= deepest.depth * (1 + 1e-6)) out[axis] = local[axis] < 0 ? -1 : 1;
    const double sides = out.norm();  // sqrt(how many)
    if (sides == 0) return {};
    return {deepest.depth * sides, box.rotation * out / sides, deepest.at};
  }

  /// Precondition: no plane.
  Separation separation_of(const Shape& shape, const Corners& t) const {
    if (const Ball* ball = std::get_if<Ball>(&shape)) return out_of(*ball, t);
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return out_of(*capsule, t);
    if (const MeshBody* body = std::get_if<MeshBody>(&shape)) return out_of_body(*body, t);
    const Box& box = std::get<Box>(shape);
    const Deepest deepest = deepest_in(box, t);
    if (deepest.depth <= 0) return {};
    return over_edge(box, deepest);
  }

  template <class Round>
  static Separation out_of(const Round& shape, const Corners& t) {
    const Deepest deepest = deepest_in(shape, t);
    if (deepest.depth <= 0) return {};
    return {deepest.depth, surface(shape, deepest.at.position).normal, deepest.at};
  }

  /// Of the places of the face that are nearest to an edge or a corner of the body: the one that
  /// has to go the farthest. From inside it goes to that edge or corner, so that it does not leave
  /// by one of its sides and enter by another, unless the surface is much nearer elsewhere.
  Separation out_of_body(const MeshBody& body, const Corners& t) const {
    const TriangleMesh& mesh = *body.mesh;
    Corners local;
    Eigen::AlignedBox3d box;
    for (std::size_t c = 0; c < 3; ++c) {
      local[c] = body.rotation.conjugate() * (t[c] - body.center);
      box.extend(local[c]);
    }
    box.min().array() -= thickness_;
    box.max().array() += thickness_;
    Separation best;
    const auto improve = [&](const TrianglePoint& at, const Vec3& edge) {
      const Separation out = towards(edge, at, mesh.nearest(at.position));
      if (out.length > best.length) best = out;
    };
    mesh.in_box(box, [&](int triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle& corners = mesh.triangles()[index(triangle)];
        const Vec3 &a = mesh.vertices()[index(corners[k])],
                   &b = mesh.vertices()[index(corners[(k + 1) % 3])];
        improve(closest_point(local, a), a);
        const Capsule edge{a, b, 0};
        const TrianglePoint at = deepest_in(edge, local).at;
        improve(at, edge.nearest_on_axis(at.position));
      }
    });
    best.normal = body.rotation * best.normal;
    best.point.position = body.center + body.rotation * best.point.position;
    return best;
  }

  Separation towards(const Vec3& edge, const TrianglePoint& at, const NearestPlace& place) const {
    constexpr double kMuchNearer = 5;
    const Vec3 way = edge - at.position;
    const double length = way.norm();
    if (place.distance < 0 && length > 0 && length < kMuchNearer * -place.distance)
      return {thickness_ + length, way / length, at};
    return {thickness_ - place.distance, place.normal, at};
  }

  /// Of a point of the face that the collider may have left.
  Separation outside(const Corners& t, const Vec3& weights) const {
    Separation out;
    out.point = {weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2], weights};
    const Surface nearest = surface(shape_, out.point.position);
    out.length = -nearest.distance;
    if (std::holds_alternative<MeshBody>(shape_)) out.length += thickness_;
    out.normal = nearest.normal;
    return out;
  }

  /// Where a point of a face began the substep [m].
  static Vec3 at_start(const Particles<Real>& p, const Triangle& face, const Vec3& weights) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) sum += weights[to_axis(c)] * at(p.previous, face[c]);
    return sum;
  }
  /// Where it would be if it had gone with the surface at `now` [m].
  Vec3 carried(const Vec3& start, const Vec3& now) const {
    if (!deforming_) return point(motion_(vec3t<double>(start)));
    const Vec3 x = deforming_->local(now);
    const PlaceMotion motion = deforming_->motion_of(deforming_->after().nearest(x), x);
    return deforming_->world(motion(deforming_->local_before(start)));
  }

  /// The force of the last substep, which held the face at this place.
  Vec3 turned(const Held& held, const Vec3& place) const {
    if (deforming_)
      return deforming_->turned(
          deforming_->before().nearest(deforming_->local_before(place)).triangle, held.force);
    if (!motion_.moves) return held.force;
    const Vec3T<double> f = vec3t<double>(held.force);
    return {dot(motion_.turn[0], f), dot(motion_.turn[1], f), dot(motion_.turn[2], f)};
  }

  /// push: force times h^2 [N s^2].
  static void add_force(Points<Real>& x, const Particles<Real>& p, const Triangle& face,
                        const Vec3& weights, const Vec3& push) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double share = static_cast<double>(p.w[index(face[c])]) * weights[to_axis(c)];
      x.add(index(face[c]), (share * push).template cast<Real>());
    }
  }

  /// The force for `out`, in the place of the one that has held the face until now.
  void hold(Particles<Real>& p, const Triangle& face, const Separation& out, double dt,
            Held& held) const {
    const Vec3& weights = out.point.weights;
    double own = 0, of_held = 0;  // 1/kg
    for (std::size_t c = 0; c < 3; ++c) {
      const double w = static_cast<double>(p.w[index(face[c])]), b = weights[to_axis(c)];
      own += w * b * b;
      of_held += w * b * held.weights[to_axis(c)];
    }
    if (own == 0) return;  // all that could move it are pins
    TouchingVertex contact;
    contact.normal = out.normal;
    contact.offset = out.normal.dot(out.point.position) + out.length;
    contact.from = carried(at_start(p, face, weights), out.point.position);
    contact.friction = collider_.friction;
    Vec3 free = out.point.position - dt * dt * of_held * held.force;
    ContactForce force;
    settle(contact, IsotropicCompliance{dt * dt * own}, force, free);
    const Held now{contact.total(force), weights};
    for (Points<Real>* points : {&p.x, solver_->target()}) {
      add_force(*points, p, face, held.weights, -dt * dt * held.force);
      add_force(*points, p, face, now.weights, dt * dt * now.force);
    }
    held = now;
  }

  void push(Particles<Real>& p, const Triangle& face, const Separation& out) const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double b = out.point.weights[static_cast<Eigen::Index>(c)];
      sum += static_cast<double>(p.w[index(face[c])]) * b * b;
    }
    if (sum == 0) return;  // all that could move it are pins
    Vec3 correction = out.length * out.normal;
    if (collider_.friction > 0) {
      const Vec3 start = at_start(p, face, out.point.weights);
      Vec3 slip = out.point.position + correction - carried(start, out.point.position);
      slip -= out.normal.dot(slip) * out.normal;
      const double length = slip.norm(), most = collider_.friction * out.length;
      correction -= length <= most ? slip : Vec3(most / length * slip);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = index(face[c]);
      const double share =
          static_cast<double>(p.w[i]) * out.point.weights[static_cast<Eigen::Index>(c)] / sum;
      p.x.add(i, (share * correction).template cast<Real>());
    }
  }

  static std::size_t index(int vertex) { return static_cast<std::size_t>(vertex); }
  static Eigen::Index to_axis(std::size_t corner) { return static_cast<Eigen::Index>(corner); }
  static Vec3 at(const Points<Real>& points, int vertex) {
    return points[index(vertex)].template cast<double>();
  }

  Collider collider_;
  double thickness_;
  std::vector<Triangle> faces_;
  Pass<Real>* solver_;      ///< null: none with a target
  std::vector<Held> held_;  ///< [faces]; empty without one
  Shape shape_;  ///< at the end of the step, grown by the thickness unless it is a body's
  Vec3 center_ = Vec3::Zero();
  double reach_ = 0;  ///< m, from its centre to its farthest point
  RigidMotion<double> motion_;
  std::optional<DeformingBody> deforming_;  ///< a collider that does
};

}  // namespace taut
