#include "core/solver/contact/face_contact.hpp"

#include <optional>

#include "core/model/deforming_body.hpp"
#include "core/model/triangle.hpp"
#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/contact/body_features.hpp"
#include "core/solver/contact/contacts.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/simd/coulomb.hpp"

namespace taut {

namespace {

/// Keeps faces and edges of the cloth, not just its vertices, out of a ball or a capsule; edges and
/// corners of a box out of the faces, and likewise those of a solid body of triangles
/// (BodyFeatures). For each piece that is too deep, the deepest point is moved out along the
/// surface's normal. The piece's corners share the correction by their barycentric weights b and
/// inverse masses w,
///
///     dx_i = w_i b_i s n / sum of w_j b_j^2,
///
/// so that the point moves by s n and momentum changes only along n. Continuous: an edge that has
/// passed through a convex edge of a body, or through the axis of a capsule, goes back to the side
/// from which it came; if it is not there when the substep ends, it goes on in the next.
///
/// With a solver that has a target y, a piece keeps the force F at its point from sweep to sweep
/// and from substep to substep, while Signorini and Coulomb require it for free corners (settle()
/// in contacts.hpp). Its changes move y as they move x, so that links feel b F. A solver that
/// includes pieces in its solve (TouchingPieces) gets the list of those that touch, and nothing is
/// moved here.
template <class Real>
class FaceContactPass final : public Pass<Real> {
 public:
  /// Precondition: the collider is neither a plane nor a thin body. pieces: faces and edges
  /// (is_edge()). solver: null, or the pass of the links, whose target is moved as well.
  FaceContactPass(const Collider& collider, double thickness, bool continuous,
                  std::vector<Triangle> pieces, Pass<Real>* solver, bool only_passed)
      : collider_(collider),
        thickness_(thickness),
        continuous_(continuous),
        only_passed_(only_passed),
        faces_(std::move(pieces)),
        solver_(solver),
        pieces_(solver ? solver->touching_pieces() : nullptr),
        held_(solver ? faces_.size() : 0) {
    if (std::holds_alternative<MeshBody>(collider.shape))
      features_.emplace(thickness, faces_.size());
    if (collider_.frames) deforming_.emplace(collider_);
  }

  void restart() override {
    held_.assign(held_.size(), {});
    safe_.clear();
  }
  void take_over(const Pass<Real>& before) override {
    const auto& old = static_cast<const FaceContactPass&>(before);
    held_ = old.held_;
    features_ = old.features_;
    safe_ = old.safe_;
    if (!deforming_) return;
    deforming_ = old.deforming_;
    shape_ = old.shape_;
    motion_ = old.motion_;
    to_body_ = old.to_body_;
    center_ = old.center_;
    reach_ = old.reach_;
  }

  void begin(Particles<Real>& p, double t, double dt) override {
    if (deforming_) {
      if (continuous_) remember_sides(p);  // relative to the surface of the last substep
      deforming_->move(t, t + dt);
      shape_ = deforming_->body();
      features_->forget();
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
      reach_ = box.diagonal().norm() / 2 + thickness_ + longest_way();
      to_body_ = body->rotation.conjugate().toRotationMatrix();
    }
    if (continuous_ && !deforming_) remember_sides(p);
    for (std::size_t f = 0; f < held_.size(); ++f)  // forces of the last substep; p.x is y
      if (held_[f].holds()) {
        held_[f].force = turned(held_[f], at_start(p, faces_[f], held_[f].weights));
        if (!pieces_) add_force(p.x, p, faces_[f], held_[f].weights, dt * dt * held_[f].force);
      }
    if (pieces_) find_touching(p, p.previous);
  }

  void apply(Particles<Real>& p, double, double dt) override {
    if (pieces_) {
      if (pieces_->solved) keep_forces();
      const std::span<TouchingPiece> touching = find_touching(p, p.x);
      if (!pieces_->solved) follow(p, touching, dt);
      return;
    }
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (int round = 0; round < kRounds && !keep_out(p, f, dt); ++round) {
      }
  }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "faces on " + std::string(type_name(collider_.shape)),
         .items = faces_.size(),
         .bytes = sizeof(*this) + faces_.size() * sizeof(Triangle) + held_.size() * sizeof(Held)}};
  }

 private:
  /// Force that holds a face [N], and the point of the face at which it acts.
  struct Held {
    Vec3 force = Vec3::Zero(), weights = Vec3::Zero();
    bool holds() const { return !force.isZero(0); }
  };

  /// Separation over an edge or corner of a box: a point that is equally deep below several sides
  /// leaves between them, along n = sum of their normals, by depth / (n . one of them).
  static Separation over_edge(const Box& box, const Deepest& deepest) {
    const Vec3 local = box.rotation.conjugate() * (deepest.at.position - box.center);
    const Vec3 depths = box.half_extents - local.cwiseAbs();
    Vec3 out = Vec3::Zero();
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (depths[axis] <= deepest.depth * (1 + 1e-6)) out[axis] = local[axis] < 0 ? -1 : 1;
    const double sides = out.norm();  // sqrt(number of sides)
    if (sides == 0) return {};
    return {deepest.depth * sides, box.rotation * out / sides, deepest.at};
  }

  /// Most rounds in a sweep: an edge that goes back through another one turns, and may be through
  /// it again.
  static constexpr int kRounds = 4;

  /// Returns whether the piece is done, since it had not passed through anything.
  bool keep_out(Particles<Real>& p, std::size_t f, double dt) {
    const auto out = to_leave(p.x, f);
    if (!out || (only_passed_ && !out->has_passed)) return true;
    if (solver_)
      hold(p, faces_[f], *out, dt, held_[f]);
    else
      push(p, faces_[f], *out);
    return !out->has_passed;
  }

  /// How a piece at x leaves the collider, or how far it is from a collider that still holds it.
  std::optional<Separation> to_leave(const Points<Real>& x, std::size_t f) {
    const Triangle& face = faces_[f];
    const Corners t{at(x, face[0]), at(x, face[1]), at(x, face[2])};
    const bool holds = solver_ && held_[f].holds();
    // every point of the face is within a side of its first corner
    const bool far = (t[0] - center_).squaredNorm() >= 2 * (reach_ * reach_ + side2_of(t));
    if (far && !holds && !may_have_passed(f, t)) return {};
    const Separation out = separation_of(f, t);
    if (out.length > 0) return out;
    if (!holds) return {};
    return outside(f, t);
  }

  /// Tells the solver which pieces touch at x.
  std::span<TouchingPiece> find_touching(const Particles<Real>& p, const Points<Real>& x) {
    std::vector<TouchingPiece>& all = pieces_->all;
    std::erase_if(all, [&](const TouchingPiece& piece) { return piece.found_by == this; });
    const std::size_t first = all.size();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto out = to_leave(x, f);
      if (!out || inverse_mass_of(p, faces_[f], out->point.weights) == 0) continue;
      TouchingPiece piece{this, f, faces_[f], out->point.weights, touching(p, faces_[f], *out), {}};
      if (const double push = piece.at.normal.dot(held_[f].force); push > 0)
        piece.force = {push, piece.at.across(held_[f].force)};
      all.push_back(piece);
    }
    return std::span(all).subspan(first);
  }

  /// Keeps the forces that the solver has found.
  void keep_forces() {
    for (const TouchingPiece& piece : pieces_->all)
      if (piece.found_by == this)
        held_[piece.number] = {piece.at.total(piece.force), piece.weights};
  }
  /// Updates the forces of touching pieces after an iteration, as AugmentedContacts does for
  /// vertices.
  void follow(const Particles<Real>& p, std::span<TouchingPiece> touching, double h) {
    std::vector<ContactForce> acting;
    double change2 = 0;
    for (TouchingPiece& piece : touching) {
      const Vec3 place = place_of(p.x, piece.corners, piece.weights);
      const ContactForce before = piece.force;
      if (before.holds()) {
        acting.push_back(augmented(piece.at, before, pieces_->stiffness_of(piece), place));
      } else {
        const double own = inverse_mass_of(p, piece.corners, piece.weights);
        piece.force = {std::max(0.0, -piece.at.gap(place)) / (h * h * own), Vec3::Zero()};
        acting.push_back(piece.force);
      }
      change2 += (piece.at.total(acting.back()) - piece.at.total(before)).squaredNorm();
    }
    const double change = std::sqrt(change2);
    pieces_->changed = pieces_->changed || change > pieces_->rounding;
    for (std::size_t k = 0; k < touching.size(); ++k) {
      TouchingPiece& piece = touching[k];
      if (pieces_->left <= kSettled * change) piece.force = acting[k];
      held_[piece.number] = {piece.at.total(piece.force), piece.weights};
    }
  }

  /// Precondition: the collider is not a plane.
  Separation separation_of(std::size_t piece, const Corners& t) {
    if (const MeshBody* body = std::get_if<MeshBody>(&shape_)) return out_of(*body, piece, t);
    Separation out;
    if (const Ball* ball = std::get_if<Ball>(&shape_)) {
      out = out_of(*ball, t);
    } else if (const Capsule* capsule = std::get_if<Capsule>(&shape_)) {
      if (continuous_ && is_edge(faces_[piece])) out = back_over(*capsule, piece, t);
      if (out.length <= 0) out = out_of(*capsule, t);
    } else {
      const Box& box = std::get<Box>(shape_);
      const Deepest deepest = deepest_in(box, t);
      if (deepest.depth > 0) out = over_edge(box, deepest);
    }
    if (is_edge(faces_[piece])) of_two_corners(out.point.weights);
    return out;
  }
  static void of_two_corners(Vec3& weights) {
    weights[1] += weights[2];
    weights[2] = 0;
  }

  Vec3 moved(const Vec3& x) const { return point(motion_(vec3t<double>(x))); }
  /// Positions of an edge's corners if they had moved with a rigid collider.
  Corners before(const Particles<Real>& p, const Triangle& piece) const {
    Corners t;
    for (std::size_t c = 0; c < 2; ++c) {
      const Vec3 x = at(p.previous, piece[c]);
      t[c] = deforming_ ? x : moved(x);
    }
    t[2] = t[1];
    return t;
  }
  bool may_have_passed(std::size_t piece, const Corners& t) const {
    if (!continuous_ || !is_edge(faces_[piece])) return false;
    double way2 = 0;
    for (std::size_t c = 0; c < 2; ++c) {
      const Vec3& from = safe_[piece][c];
      way2 = std::max(way2, (t[c] - (deforming_ ? moved(from) : from)).squaredNorm());
    }
    return way2 > reach_ * reach_;
  }

  /// Remembers where edges come from: where they began the substep or, for edges that have passed
  /// through something and not gone back yet, where they were before, moved along with the surface.
  /// Positions refer to the end of the substep for a rigid collider, and to its start for one that
  /// deforms.
  void remember_sides(const Particles<Real>& p) {
    const bool first = safe_.empty();
    if (first) safe_.resize(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!is_edge(faces_[f])) continue;
      const Corners now = before(p, faces_[f]);
      for (std::size_t c = 0; c < 3 && !first && !deforming_; ++c) safe_[f][c] = moved(safe_[f][c]);
      if (first || !has_passed(f, now))
        safe_[f] = now;
      else if (deforming_)
        for (Vec3& x : safe_[f]) x = gone_with_surface(x);
    }
  }
  Vec3 gone_with_surface(const Vec3& x) const {
    const Vec3 p = deforming_->local_before(x);
    return deforming_->world(deforming_->motion_of_before(deforming_->before().nearest(p), p)(p));
  }
  double longest_way() const { return deforming_ ? deforming_->longest_way() : 0; }
  bool has_passed(std::size_t piece, const Corners& now) {
    if ((now[0] - center_).squaredNorm() >= 2 * (reach_ * reach_ + side2_of(now)) &&
        !may_have_passed(piece, now))
      return false;
    if (const Capsule* capsule = std::get_if<Capsule>(&shape_))
      return first_crossing(safe_[piece], now, axis_of(*capsule)).has_value();
    const MeshBody* body = std::get_if<MeshBody>(&shape_);
    return body && out_of(*body, piece, now).has_passed;
  }
  static double side2_of(const Corners& t) {
    return std::max((t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm());
  }
  static FixedEdge axis_of(const Capsule& capsule) {
    return {capsule.from, capsule.to - capsule.from};
  }

  template <class Round>
  static Separation out_of(const Round& shape, const Corners& t) {
    const Deepest deepest = deepest_in(shape, t);
    if (deepest.depth <= 0) return {};
    return {deepest.depth, surface(shape, deepest.at.position).normal, deepest.at};
  }

  /// Separation of an edge that has passed through the axis.
  Separation back_over(const Capsule& capsule, std::size_t edge, const Corners& t) const {
    const auto met = first_crossing(safe_[edge], t, axis_of(capsule));
    if (!met) return {};
    const LinesApart& at = met->end;
    return {
        capsule.radius - at.height, at.normal, {at.on(t), {1 - at.on_cloth, at.on_cloth, 0}}, true};
  }

  Corners in_body(const MeshBody& body, const Corners& t, bool edge) const {
    Corners corners;
    for (std::size_t c = 0; c < (edge ? 2u : 3u); ++c) corners[c] = to_body_ * (t[c] - body.center);
    if (edge) corners[2] = corners[1];
    return corners;
  }
  Separation in_world(const MeshBody& body, Separation out) const {
    out.normal = to_body_.transpose() * out.normal;
    out.point.position = body.center + to_body_.transpose() * out.point.position;
    return out;
  }
  Separation out_of(const MeshBody& body, std::size_t piece, const Corners& t) {
    const bool edge = is_edge(faces_[piece]);
    BodyFeatures::Before was;
    if (continuous_ && edge) was = before_in_body(body, piece);
    return in_world(body, features_->out_of(*body.mesh, piece, edge, in_body(body, t, edge),
                                            continuous_ && edge ? &was : nullptr));
  }
  BodyFeatures::Before before_in_body(const MeshBody& body, std::size_t edge) const {
    if (!deforming_) return {in_body(body, safe_[edge], true)};
    BodyFeatures::Before was{.mesh = &deforming_->before(), .longest_way = longest_way()};
    for (std::size_t c = 0; c < 3; ++c) was.corners[c] = deforming_->local_before(safe_[edge][c]);
    return was;
  }

  /// Separation, negative, of a point of the face that the collider may no longer hold.
  Separation outside(std::size_t piece, const Corners& t) const {
    if (const MeshBody* body = std::get_if<MeshBody>(&shape_); body && is_edge(faces_[piece]))
      if (auto out = features_->out_of_last(*body->mesh, piece, in_body(*body, t, true)))
        return in_world(*body, *out);
    const Vec3& weights = held_[piece].weights;
    Separation out;
    out.point = {weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2], weights};
    const Surface nearest = surface(shape_, out.point.position);
    out.length = -nearest.distance;
    if (std::holds_alternative<MeshBody>(shape_)) out.length += thickness_;
    out.normal = nearest.normal;
    return out;
  }

  static Vec3 place_of(const Points<Real>& x, const Triangle& face, const Vec3& weights) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) sum += weights[to_axis(c)] * at(x, face[c]);
    return sum;
  }
  /// Position of a point of a face at the beginning of the substep [m].
  static Vec3 at_start(const Particles<Real>& p, const Triangle& face, const Vec3& weights) {
    return place_of(p.previous, face, weights);
  }
  /// Displacement of the point per force and h^2 with free corners [1/kg].
  static double inverse_mass_of(const Particles<Real>& p, const Triangle& face,
                                const Vec3& weights) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double b = weights[to_axis(c)];
      sum += static_cast<double>(p.w[index(face[c])]) * b * b;
    }
    return sum;
  }
  /// The half-space that the piece has to stay in.
  TouchingVertex touching(const Particles<Real>& p, const Triangle& face,
                          const Separation& out) const {
    TouchingVertex contact;
    contact.normal = out.normal;
    contact.offset = out.normal.dot(out.point.position) + out.length;
    contact.from = carried(at_start(p, face, out.point.weights), out.point.position);
    contact.friction = collider_.friction;
    return contact;
  }
  /// Position of the point if it had moved with the surface at `now` [m].
  Vec3 carried(const Vec3& start, const Vec3& now) const {
    if (!deforming_) return point(motion_(vec3t<double>(start)));
    const Vec3 x = deforming_->local(now);
    const PlaceMotion motion = deforming_->motion_of(deforming_->after().nearest(x), x);
    return deforming_->world(motion(deforming_->local_before(start)));
  }

  /// The force of the last substep, which held the face at this point, turned with the collider.
  Vec3 turned(const Held& held, const Vec3& place) const {
    if (deforming_)
      return deforming_->turned(
          deforming_->before().nearest(deforming_->local_before(place)).triangle, held.force);
    if (!motion_.moves) return held.force;
    const Vec3T<double> f = vec3t<double>(held.force);
    return {dot(motion_.turn[0], f), dot(motion_.turn[1], f), dot(motion_.turn[2], f)};
  }

  /// Adds a force to the corners. push: force times h^2 [N s^2].
  static void add_force(Points<Real>& x, const Particles<Real>& p, const Triangle& face,
                        const Vec3& weights, const Vec3& push) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double share = static_cast<double>(p.w[index(face[c])]) * weights[to_axis(c)];
      x.add(index(face[c]), (share * push).template cast<Real>());
    }
  }

  /// Replaces the force that held the face by the one for `out`.
  void hold(Particles<Real>& p, const Triangle& face, const Separation& out, double dt,
            Held& held) const {
    const Vec3& weights = out.point.weights;
    const double own = inverse_mass_of(p, face, weights);
    if (own == 0) return;  // its corners are pins
    double of_held = 0;    // 1/kg
    for (std::size_t c = 0; c < 3; ++c)
      of_held +=
          static_cast<double>(p.w[index(face[c])]) * weights[to_axis(c)] * held.weights[to_axis(c)];
    const TouchingVertex contact = touching(p, face, out);
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
    const double sum = inverse_mass_of(p, face, out.point.weights);
    if (sum == 0) return;  // all that could move it are pins
    Vec3 correction = out.length * out.normal;
    if (collider_.friction > 0) {
      const Vec3 start = at_start(p, face, out.point.weights);
      Vec3 slip = out.point.position + correction - carried(start, out.point.position);
      slip -= out.normal.dot(slip) * out.normal;
      correction -= FrictionCone{slip.norm(), collider_.friction * out.length}.share() * slip;
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
  bool continuous_, only_passed_;
  std::vector<Triangle> faces_;  ///< and edges: is_edge()
  Pass<Real>* solver_;           ///< null: no solver with a target
  TouchingPieces* pieces_;       ///< null unless the solver includes pieces in its solve
  std::vector<Held> held_;       ///< [pieces]; empty without a solver
  std::vector<Corners> safe_;    ///< [pieces] m, for edges; see remember_sides()
  /// The collider at the end of the step, enlarged by the thickness unless it is a body.
  Shape shape_;
  Vec3 center_ = Vec3::Zero();
  double reach_ = 0;                      ///< m, from the centre to the farthest point
  std::optional<BodyFeatures> features_;  ///< for a body of triangles
  Eigen::Matrix3d to_body_ = Eigen::Matrix3d::Identity();
  RigidMotion<double> motion_;
  std::optional<DeformingBody> deforming_;  ///< for a collider that deforms
};

}  // namespace

template <class Real>
std::unique_ptr<Pass<Real>> make_face_contact(const Collider& collider, double thickness,
                                              bool continuous, std::vector<Triangle> pieces,
                                              Pass<Real>* solver, bool only_passed) {
  return std::make_unique<FaceContactPass<Real>>(collider, thickness, continuous, std::move(pieces),
                                                 solver, only_passed);
}
template std::unique_ptr<Pass<float>> make_face_contact(const Collider&, double, bool,
                                                        std::vector<Triangle>, Pass<float>*, bool);
template std::unique_ptr<Pass<double>> make_face_contact(const Collider&, double, bool,
                                                         std::vector<Triangle>, Pass<double>*,
                                                         bool);

}  // namespace taut
