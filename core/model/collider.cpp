#include "core/model/collider.hpp"

#include <algorithm>
#include <utility>

#include "core/model/body_frames.hpp"
#include "core/model/deforming_body.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;  // clang 14 does not deduce template arguments of aggregates

Surface surface_of(const Plane& plane, const Vec3& p) {
  return {plane.normal.dot(p) - plane.offset, plane.normal};
}

Surface surface_of(const Ball& ball, const Vec3& p) {
  const Vec3 out = p - ball.center;
  const double distance = out.norm();
  if (distance == 0) return {-ball.radius, Vec3::UnitY()};
  return {distance - ball.radius, out / distance};
}

Surface surface_of(const Capsule& capsule, const Vec3& p) {
  const Vec3 out = p - capsule.nearest_on_axis(p);
  const double distance = out.norm();
  if (distance == 0) return {-capsule.radius, capsule.beside()};
  return {distance - capsule.radius, out / distance};
}

Surface surface_of(const Box& box, const Vec3& p) {
  const Vec3 local = box.rotation.conjugate() * (p - box.center);
  const Vec3 excess = local.cwiseAbs() - box.half_extents;
  const auto sign = [&](int axis) { return local[axis] < 0 ? -1.0 : 1.0; };
  Vec3 normal = Vec3::Zero();
  double distance = 0;
  if (excess.maxCoeff() > 0) {  // outside: towards the nearest point of a face, edge or corner
    for (int axis = 0; axis < 3; ++axis) normal[axis] = sign(axis) * std::max(0.0, excess[axis]);
    distance = normal.norm();
    normal /= distance;
  } else {  // inside: out through the nearest face
    int axis = 0;
    distance = excess.maxCoeff(&axis);
    normal[axis] = sign(axis);
  }
  return {distance, box.rotation * normal};
}

Surface surface_of(const MeshBody& body, const Vec3& p) {
  const NearestPlace place = body.mesh->nearest(body.rotation.conjugate() * (p - body.center));
  const Vec3 normal = body.rotation * place.normal;
  if (body.sides == MeshBody::Sides::both && place.distance < 0) return {-place.distance, -normal};
  return {place.distance, normal};
}

}  // namespace

std::string_view type_name(const Shape& shape) {
  return std::visit(Overload{[](const Plane&) { return std::string_view("plane"); },
                             [](const Ball&) { return std::string_view("ball"); },
                             [](const Box&) { return std::string_view("box"); },
                             [](const Capsule&) { return std::string_view("capsule"); },
                             [](const MeshBody&) { return std::string_view("mesh"); }},
                    shape);
}

std::vector<Shape> shapes_of_each_type() {
  return []<std::size_t... k>(std::index_sequence<k...>) {
    return std::vector<Shape>{std::variant_alternative_t<k, Shape>()...};
  }
  (std::make_index_sequence<std::variant_size_v<Shape>>());
}

Vec3 Capsule::nearest_on_axis(const Vec3& p) const {
  const Vec3 along = to - from;
  const double length2 = along.squaredNorm();
  if (length2 == 0) return from;
  return from + std::clamp(along.dot(p - from) / length2, 0.0, 1.0) * along;
}

Vec3 Capsule::beside() const {
  const Vec3 along = to - from;
  return along.isZero(0) ? Vec3(Vec3::UnitY()) : Vec3(along.unitOrthogonal());
}

Vec3 Motion::displacement(double t) const {
  Vec3 d = velocity * t;
  if (path.empty()) return d;
  const auto next = std::upper_bound(path.begin(), path.end(), t,
                                     [](double time, const Key& key) { return time < key.t; });
  if (next == path.begin()) return d + path.front().displacement;
  if (next == path.end()) return d + path.back().displacement;
  const Key &a = *(next - 1), &b = *next;
  return d + a.displacement + (t - a.t) / (b.t - a.t) * (b.displacement - a.displacement);
}

Eigen::Quaterniond Motion::rotation(double t) const {
  const double rate = spin.norm();
  if (rate == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(rate * t, spin / rate));
}

Vec3 Motion::moved(const Vec3& start, double t) const {
  if (spin.isZero(0)) return start + displacement(t);
  return pivot + rotation(t) * (start - pivot) + displacement(t);
}

namespace {

std::shared_ptr<const TriangleMesh> deformed(const TriangleMesh& mesh, const BodyFrames& frames,
                                             double t) {
  auto copy = std::make_shared<TriangleMesh>(mesh);
  copy->refit(frames.at(t));
  return copy;
}

}  // namespace

Shape shape_at(const Collider& collider, double t) {
  const Motion& motion = collider.motion;
  if (collider.at_rest()) return collider.shape;
  return std::visit(Overload{[&](Plane plane) -> Shape {
                               const Vec3 on = motion.moved(plane.offset * plane.normal, t);
                               plane.normal = motion.rotation(t) * plane.normal;
                               plane.offset = plane.normal.dot(on);
                               return plane;
                             },
                             [&](Ball ball) -> Shape {
                               ball.center = motion.moved(ball.center, t);
                               return ball;
                             },
                             [&](Box box) -> Shape {
                               box.center = motion.moved(box.center, t);
                               box.rotation = motion.rotation(t) * box.rotation;
                               return box;
                             },
                             [&](Capsule capsule) -> Shape {
                               capsule.from = motion.moved(capsule.from, t);
                               capsule.to = motion.moved(capsule.to, t);
                               return capsule;
                             },
                             [&](MeshBody body) -> Shape {
                               body.center = motion.moved(body.center, t);
                               body.rotation = motion.rotation(t) * body.rotation;
                               if (collider.frames)
                                 body.mesh = deformed(*body.mesh, *collider.frames, t);
                               return body;
                             }},
                    collider.shape);
}

std::vector<Vec3> carried(const Collider& collider, double t, double h,
                          const std::vector<Vec3>& points) {
  std::vector<Vec3> moved;
  moved.reserve(points.size());
  if (collider.frames) {
    DeformingBody body(collider);
    body.move(t, t + h);
    for (const Vec3& x : points) {
      const Vec3 at = body.local_before(x);
      moved.push_back(body.world(body.motion_of_before(body.before().nearest(at), at)(at)));
    }
    return moved;
  }
  const Motion& m = collider.motion;
  const Eigen::Quaterniond turn = m.rotation(t + h) * m.rotation(t).conjugate();
  for (const Vec3& x : points)
    moved.push_back(m.pivot + m.displacement(t + h) + turn * (x - m.pivot - m.displacement(t)));
  return moved;
}

Surface surface(const Shape& shape, const Vec3& p) {
  return std::visit([&](const auto& s) { return surface_of(s, p); }, shape);
}

}  // namespace taut
