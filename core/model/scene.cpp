#include "core/model/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "core/model/body_frames.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/text.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

/// Writes values one after another, with lengths before contents, so that no two scenes have the
/// same bytes. Keys that were added later stand at the end, each with its name and its position
/// among the others.
class Bytes {
 public:
  explicit Bytes(std::span<const SceneKey> keys) : keys_(keys) {}

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T value) {
    if constexpr (std::is_floating_point_v<T>) value += T(0);  // -0 and 0 are the same scene
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    text_.append(raw, sizeof(T));
  }
  template <class... T>
  void add_each(const T&... values) {
    (add(values), ...);
  }
  void add(const Vec3& v) {
    for (const double c : v) add(c);
  }
  void add(const Triangle& t) {
    for (const int c : t) add(c);
  }
  void add(const Link& l) { add_each(l.a, l.b, l.rest, l.family); }
  void add(const Grid& g) { add_each(g.nu, g.nv); }
  void add(const Motion::Key& k) { add_each(k.t, k.displacement); }
  void add(const Release& r) { add_each(r.step, r.vertices); }
  void add(const PinMotion& m) {
    add(m.vertices);
    add_motion("pin_motion", m.motion);
  }
  void add(const Collider& c) {
    add(c.shape.index());
    std::visit([&](const auto& shape) { add_keys(shape); }, c.shape);
    if (const Box* box = std::get_if<Box>(&c.shape))
      for (const double q : box->rotation.coeffs()) add(q);
    if (const MeshBody* body = std::get_if<MeshBody>(&c.shape)) {
      for (const double q : body->rotation.coeffs()) add(q);
      add(body->mesh->vertices());
      add(body->mesh->triangles());
    }
    add_motion("collider", c.motion);
    add_keys(c);
    if (c.frames) add_later(*find_scene_key(kFramesKey), [&](Bytes& b) { b.add(*c.frames); });
  }
  void add(const BodyFrames& f) { add_each(f.places, f.fps); }
  void add(const Bending& b) {
    add_each(b.warp, b.weft);
    add_keys(b);
  }
  void add(const Membrane& m) { add_each(m.law, m.warp, m.weft, m.poisson, m.shear, m.direction); }
  void add(const Wind& w) { add_keys(w); }
  void add(const SelfCollision& s) { add_keys(s); }
  void add(const Mesh& m) { add_each(m.rest, m.triangles, m.mass, m.grid); }
  void add(const State& s) { add_each(s.x, s.v); }
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
  void add_motion(std::string_view section, const Motion& m) {
    const auto visit = [&](const auto&... key) { add_key(key...); };
    each_key(section, m, visit, keys_);
    add(m.path);
  }
  /// Adds the keys that are members of the part.
  template <class Part>
  void add_keys(const Part& part) {
    const auto visit = [&](const auto&... key) { add_key(key...); };
    each_key(part, visit, keys_);
  }
  template <class Value>
  void add_key(const SceneKey& key, const Value& value, const Value& initial) {
    if (!key.added_later()) return add(value);
    if (key.counts(value, initial)) add_later(key, [&](Bytes& b) { b.add(value); });
  }
  /// Adds a key that was added later and is present, with its name and its position among the
  /// others.
  template <class AddValue>
  void add_later(const SceneKey& key, const AddValue& add_value) {
    Bytes bytes(keys_);
    bytes.add(text_.size());
    add_value(bytes);
    later_.emplace_back(LaterKey{std::string(key.path), key.since}, bytes.text_);
  }
  std::string all() const {
    std::string text = text_;
    for (const auto& [key, bytes] : later_) text += key.path + bytes;
    return text;
  }
  std::vector<LaterKey> later_keys() const {
    std::vector<LaterKey> keys;
    for (const auto& [key, bytes] : later_) keys.push_back(key);
    return keys;
  }

 private:
  std::span<const SceneKey> keys_;
  std::string text_;
  /// Name, and bytes of position and value.
  std::vector<std::pair<LaterKey, std::string>> later_;
};

}  // namespace

bool is_pinned(const Scene& scene, int vertex) {
  const auto lets_go = [&](const Release& r) {
    return std::ranges::binary_search(r.vertices, vertex);
  };
  return std::ranges::binary_search(scene.pins, vertex) &&
         std::ranges::none_of(scene.releases, lets_go);
}

std::vector<int> pins_at(const Scene& scene, double t) {
  std::vector<int> pins = scene.pins;
  for (const Release& r : scene.releases)
    if (t > (r.step + 0.5) * scene.dt)
      std::erase_if(pins, [&](int v) { return std::ranges::binary_search(r.vertices, v); });
  return pins;
}

std::vector<Scene> stages(const Scene& scene) {
  std::vector<Scene> all{scene};
  all.front().releases.clear();
  for (const Release& release : scene.releases) {
    Scene& next = all.emplace_back(all.back());
    const auto free = [&](int v) { return std::ranges::binary_search(release.vertices, v); };
    std::erase_if(next.pins, free);
    for (PinMotion& group : next.pin_motions) std::erase_if(group.vertices, free);
    std::erase_if(next.pin_motions, [](const PinMotion& group) { return group.vertices.empty(); });
  }
  return all;
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

namespace {

Bytes bytes_of(const Scene& s, std::span<const SceneKey> keys) {
  Bytes bytes(keys);
  bytes.add(s.mesh);
  bytes.add(s.start);
  bytes.add(s.pins);
  bytes.add(s.pin_motions);
  bytes.add(s.links);
  bytes.add(s.colliders);
  bytes.add(s.wind);
  bytes.add(s.self_collision);
  bytes.add_keys(s);
  bytes.add(s.dt);
  bytes.add(s.steps);
  // Stiffness is older than add_later(). A scene without it keeps the bytes that it had before
  // stiffness existed.
  if (s.stiffness != kRigid)
    for (const double k : s.stiffness) bytes.add(k);
  if (s.bending) bytes.add(s.bending);
  if (!s.releases.empty()) bytes.add(s.releases);
  if (s.membrane)
    bytes.add_later(*find_scene_key(kMembraneKey), [&](Bytes& b) { b.add(*s.membrane); });
  if (s.membrane && s.membrane->damping != 0)
    bytes.add_later(*find_scene_key(kMembraneDamping),
                    [&](Bytes& b) { b.add(s.membrane->damping); });
  return bytes;
}

}  // namespace

std::string content(const Scene& scene, std::span<const SceneKey> keys) {
  return bytes_of(scene, keys).all();
}
std::string content(const Scene& scene) { return content(scene, scene_keys()); }

std::vector<LaterKey> later_keys(const Scene& scene, std::span<const SceneKey> keys) {
  return bytes_of(scene, keys).later_keys();
}
std::vector<LaterKey> later_keys(const Scene& scene) { return later_keys(scene, scene_keys()); }

}  // namespace taut
