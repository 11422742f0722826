#include "core/solver/contact/face_contact.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/model/deforming_body.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"
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
/// A solver that includes pieces in its solve (TouchingPieces) gets the list of those that touch,
/// and nothing is moved here. Forces are kept from substep to substep. At a ball or a capsule the
/// point and the normal follow the piece as it turns (lay()). A box is a body of triangles then:
/// the deepest point of an edge that lies on a flat side would jump from end to end. An edge with a
/// pin that lies on the surface can only turn about the pin; its point keeps a lever of kLever, and
/// the force on its other corner is kept where the lever changes.
template <class Real>
class FaceContactPass final : public Pass<Real>, public PieceFinder {
 public:
  /// Precondition: the collider is neither a plane nor a thin body. pieces: faces and edges
  /// (is_edge()). solver: null, or the pass of the links that includes pieces in its solve.
  FaceContactPass(const Collider& collider, double thickness, bool continuous,
                  std::vector<Triangle> pieces, Pass<Real>* solver, bool only_passed)
      : collider_(collider),
        type_(type_name(collider.shape)),
        thickness_(thickness),
        continuous_(continuous),
        only_passed_(only_passed),
        faces_(std::move(pieces)),
        pieces_(solver ? solver->touching_pieces() : nullptr),
        held_(pieces_ ? faces_.size() : 0) {
    if (const Box* box = std::get_if<Box>(&collider.shape); box && pieces_)
      collider_.shape = as_triangles(*box);
    if (std::holds_alternative<MeshBody>(collider_.shape))
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
      }
    if (pieces_) {
      pinned_.resize(faces_.size());
      for (std::size_t f = 0; f < faces_.size(); ++f)
        for (std::size_t c = 0; c < 3; ++c) pinned_[f][c] = p.w[index(faces_[f][c])] == 0;
      find_touching(p, p.previous);
    }
  }

  void apply(Particles<Real>& p, double, double dt) override {
    if (pieces_) {
      if (pieces_->solved) keep_forces();
      const std::span<TouchingPiece> touching = find_touching(p, p.x);
      if (!pieces_->solved) follow(p, touching, dt);
      return;
    }
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (int round = 0; round < kRounds && !keep_out(p, f); ++round) {
      }
  }

  void lay(TouchingPiece& piece, const Corners& x) const override {
    if (!rolls()) return;
    const Separation out = round_out_of(piece.number, x);
    piece.weights = out.point.weights;
    piece.at.normal = out.normal;
    piece.at.offset = out.normal.dot(out.point.position) + out.length;
    piece.turning = turning_at(out);
  }

  std::vector<PassCost> cost() const override {
    return {
        {.pass = "faces on " + std::string(type_),
         .items = faces_.size(),
         .bytes = sizeof(*this) + faces_.size() * sizeof(Triangle) + held_.size() * sizeof(Held)}};
  }

 private:
  /// Force that holds a face [N], and the point of the face at which it acts.
  struct Held {
    Vec3 force = Vec3::Zero(), weights = Vec3::Zero();
    bool holds() const { return !force.isZero(0); }
  };

  static MeshBody as_triangles(const Box& box) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
      corners.push_back(box.half_extents.cwiseProduct(
          Vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1)));
    std::vector<Triangle> triangles{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                    {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                    {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return {std::make_shared<TriangleMesh>(std::move(corners), std::move(triangles)), box.center,
            box.rotation};
  }

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
  bool keep_out(Particles<Real>& p, std::size_t f) {
    const auto out = to_leave(p.x, f);
    if (!out || (only_passed_ && !out->has_passed)) return true;
    push(p, faces_[f], *out);
    return !out->has_passed;
  }

  /// How a piece at x leaves the collider, or how far it is from a collider that still holds it.
  std::optional<Separation> to_leave(const Points<Real>& x, std::size_t f) {
    const Triangle& face = faces_[f];
    const Corners t{at(x, face[0]), at(x, face[1]), at(x, face[2])};
    const bool holds = pieces_ && held_[f].holds();
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
      if (out->point.weights.maxCoeff() >= 1 - 1e-9 || is_of_an_edge(f, x, *out)) {
        held_[f] = {};
        continue;
      }
      TouchingPiece piece{this, f, faces_[f], out->point.weights, touching(p, faces_[f], *out), {}};
      Vec3 force = held_[f].force;
      if (rolls())
        force *= moving_share(p, faces_[f], held_[f].weights) /
                 moving_share(p, faces_[f], piece.weights);
      if (const double push = piece.at.normal.dot(force); push > 0)
        piece.force = {push, piece.at.across(force)};
      if (rolls()) piece.turning = turning_at(*out);
      all.push_back(piece);
    }
    return std::span(all).subspan(first);
  }

  /// Whether the piece is a face that is no deeper in a round collider than its edges.
  bool is_of_an_edge(std::size_t piece, const Points<Real>& x, const Separation& out) const {
    if (is_edge(faces_[piece]) || std::holds_alternative<MeshBody>(shape_)) return false;
    constexpr double kSame = 1e-6;
    const Triangle& face = faces_[piece];
    const Corners t{at(x, face[0]), at(x, face[1]), at(x, face[2])};
    double deepest = -reach_;
    for (std::size_t c = 0; c < 3; ++c) {
      const Corners edge{t[c], t[(c + 1) % 3], t[(c + 1) % 3]};
      const Ball* ball = std::get_if<Ball>(&shape_);
      deepest = std::max(deepest, ball ? deepest_in(*ball, edge).depth
                                       : deepest_in(std::get<Capsule>(shape_), edge).depth);
    }
    return out.length <= deepest + kSame * std::sqrt(side2_of(t));
  }
  /// Whether the collider is round, in a solve.
  bool rolls() const {
    return pieces_ &&
           (std::holds_alternative<Ball>(shape_) || std::holds_alternative<Capsule>(shape_));
  }
  /// How the point of a piece that is nearest to a round collider leaves it, at least kLever away
  /// from pinned corners.
  Separation round_out_of(std::size_t piece, const Corners& t) const {
    const Vec3 weights =
        is_edge(faces_[piece]) ? nearest_of_edge(piece, t) : nearest_of_face(piece, t);
    Separation out;
    out.point = {weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2], weights};
    const Surface nearest = surface(shape_, out.point.position);
    out.length = -nearest.distance;
    out.normal = nearest.normal;
    return out;
  }
  Vec3 nearest_of_face(std::size_t piece, const Corners& t) const {
    const Ball* ball = std::get_if<Ball>(&shape_);
    Vec3 weights =
        (ball ? deepest_in(*ball, t) : deepest_in(std::get<Capsule>(shape_), t)).at.weights;
    double moving = 0, corners = 0;
    for (std::size_t c = 0; c < 3; ++c)
      if (!pinned_[piece][c]) {
        moving += weights[to_axis(c)];
        ++corners;
      }
    if (moving >= kLever || corners == 0) return weights;
    weights *= (1 - kLever) / (1 - moving);
    for (std::size_t c = 0; c < 3; ++c)
      if (!pinned_[piece][c]) weights[to_axis(c)] = kLever / corners;
    return weights;
  }
  /// Where an edge is parallel to a capsule's axis, the middle rather than an end: the point must
  /// not jump from end to end.
  Vec3 nearest_of_edge(std::size_t piece, const Corners& t) const {
    constexpr double kMiddle = 1e-3;
    const auto within = [&](double share) {
      return std::clamp(share, pinned_[piece][0] ? kLever : 0.0,
                        pinned_[piece][1] ? 1 - kLever : 1.0);
    };
    const Vec3 u = t[1] - t[0];
    const double uu = u.squaredNorm();
    const auto share_at = [&](const Vec3& center) {
      return within(uu > 0 ? u.dot(center - t[0]) / uu : 0);
    };
    double share = 0;
    Vec3 center;
    if (const Ball* ball = std::get_if<Ball>(&shape_)) {
      center = ball->center;
      share = share_at(center);
    } else {
      const Capsule& capsule = std::get<Capsule>(shape_);
      const Vec3 v = capsule.to - capsule.from, r = capsule.from - t[0];
      const double uv = u.dot(v), vv = v.squaredNorm(), det = uu * vv - uv * uv;
      if (uu * vv > 0)
        share = within((vv * u.dot(r) - uv * v.dot(r) + kMiddle * uu * vv / 2) /
                       (det + kMiddle * uu * vv));
      center = capsule.nearest_on_axis(t[0] + share * u);
      if (center == capsule.from || center == capsule.to) share = share_at(center);
    }
    return {1 - share, share, 0};
  }
  /// Derivative of the normal there [1/m].
  Eigen::Matrix3d turning_at(const Separation& out) const {
    const Ball* ball = std::get_if<Ball>(&shape_);
    const double radius = ball ? ball->radius : std::get<Capsule>(shape_).radius;
    Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - out.normal * out.normal.transpose();
    if (const Capsule* capsule = std::get_if<Capsule>(&shape_)) {
      const Vec3 v = capsule->to - capsule->from;
      const double at = v.dot(out.point.position - capsule->from);
      if (at > 0 && at < v.squaredNorm()) across -= v * v.transpose() / v.squaredNorm();
    }
    return across / std::max(radius - out.length, 1e-3 * radius);
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
      const double lever = rolls() ? moving_share(p, piece.corners, piece.weights) : 1;
      change2 += (lever * (piece.at.total(acting.back()) - piece.at.total(before))).squaredNorm();
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
      out = rolls() ? round_out_of(piece, t) : out_of(*ball, t);
    } else if (const Capsule* capsule = std::get_if<Capsule>(&shape_)) {
      if (continuous_ && is_edge(faces_[piece])) out = back_over(*capsule, piece, t);
      if (out.length <= 0) out = rolls() ? round_out_of(piece, t) : out_of(*capsule, t);
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
    if (rolls()) return round_out_of(piece, t);
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
  /// The share of a force at the point that corners other than pins get.
  static double moving_share(const Particles<Real>& p, const Triangle& face, const Vec3& weights) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      if (p.w[index(face[c])] > 0) sum += weights[to_axis(c)];
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
  std::string_view type_;  ///< of the scene's collider
  double thickness_;
  bool continuous_, only_passed_;
  std::vector<Triangle> faces_;  ///< and edges: is_edge()
  TouchingPieces* pieces_;       ///< null unless the solver includes pieces in its solve
  std::vector<Held> held_;       ///< [pieces]; empty without a solver
  std::vector<std::array<bool, 3>> pinned_;  ///< [pieces] corners that are pins, in a solve
  std::vector<Corners> safe_;                ///< [pieces] m, for edges; see remember_sides()
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
