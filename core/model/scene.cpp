#include "core/model/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/model/text.hpp"

namespace taut {

namespace {

/// Writes values one after the other, lengths before contents, so that no two scenes share their
/// bytes.
class Bytes {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T value) {
    if constexpr (std::is_floating_point_v<T>) value += T(0);  // -0 and 0 are the same scene
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    text_.append(raw, sizeof(T));
  }
  void add(const Vec3& v) {
    for (const double c : v) add(c);
  }
  void add(const Triangle& t) {
    for (const int c : t) add(c);
  }
  void add(const Link& l) { add(l.a), add(l.b), add(l.rest), add(l.family); }
  void add(const Grid& g) { add(g.nu), add(g.nv); }
  void add(const Motion::Key& k) { add(k.t), add(k.displacement); }
  void add(const Motion& m) { add(m.velocity), add(m.spin), add(m.pivot), add(m.path); }
  void add(const PinMotion& m) { add(m.vertices), add(m.motion); }
  void add(const Plane& p) { add(p.normal), add(p.offset); }
  void add(const Ball& b) { add(b.center), add(b.radius); }
  void add(const Box& b) {
    add(b.center), add(b.half_extents);
    for (const double c : b.rotation.coeffs()) add(c);
  }
  void add(const Capsule& c) { add(c.from), add(c.to), add(c.radius); }
  void add(const Collider& c) {
    add(c.shape.index());
    std::visit([&](const auto& shape) { add(shape); }, c.shape);
    add(c.motion), add(c.friction);
  }
  void add(const Bending& b) { add(b.warp), add(b.weft), add(b.direction); }
  void add(const Wind& w) { add(w.velocity), add(w.strength), add(w.law); }
  void add(const SelfCollision& s) { add(s.radius); }
  void add(const Mesh& m) {
    const auto& [rest, triangles, mass, grid] = m;
    add(rest), add(triangles), add(mass), add(grid);
  }
  void add(const State& s) { add(s.x), add(s.v); }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
  }
  template <class T>
  void add(const std::optional<T>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

bool is_pinned(const Scene& scene, int vertex) {
  return std::ranges::binary_search(scene.pins, vertex);
}

std::vector<double> inverse_masses(const Scene& scene) {
  std::vector<double> w;
  w.reserve(scene.mesh.mass.size());
  for (const double mass : scene.mesh.mass) w.push_back(1 / mass);
  for (const int pin : scene.pins) w[static_cast<std::size_t>(pin)] = 0;
  return w;
}

std::vector<std::string> elastic_links(const Scene& scene) {
  double softest = std::numeric_limits<double>::infinity();
  for (const Link& link : scene.links)
    softest = std::min(softest, scene.stiffness[static_cast<std::size_t>(link.family)]);
  if (std::isinf(softest)) return {};
  return {"links of " + shortest(softest) + " N/m"};
}

double extent(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : scene.mesh.rest) box.extend(x);
  return box.diagonal().norm();
}

Vec3 pin_position(const Scene& scene, int vertex, double t) {
  const Vec3& start = scene.start.x[static_cast<std::size_t>(vertex)];
  for (const auto& [vertices, motion] : scene.pin_motions)
    if (std::find(vertices.begin(), vertices.end(), vertex) != vertices.end())
      return motion.moved(start, t);
  return start;
}

std::string content(const Scene& scene) {
  // Every member is named here: a new one does not compile until it has an answer.
  const auto& [name, summary, mesh, start, pins, pin_motions, links, stiffness, bending, colliders,
               wind, self_collision, gravity, damping, thickness, dt, steps] = scene;
  Bytes bytes;
  bytes.add(mesh), bytes.add(start), bytes.add(pins), bytes.add(pin_motions), bytes.add(links);
  bytes.add(colliders), bytes.add(wind), bytes.add(self_collision);
  bytes.add(gravity), bytes.add(damping), bytes.add(thickness), bytes.add(dt), bytes.add(steps);
  if (stiffness != kRigid)  // a scene without has the bytes that it had before there was any
    for (const double k : stiffness) bytes.add(k);
  if (bending) bytes.add(bending);
  return bytes.take();
}

}  // namespace taut
