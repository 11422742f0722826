#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/model/scene.hpp"

// Keys of a scene file, a row for each. The table drives the reader (core/io), the bytes of a
// scene's digest (content()), the file that external programs get, `taut list keys`, the tables of
// experiments/scenes/README.md, the ranges of `taut frontier`, and what `taut require` leaves out.
// It alone says which section has which members of a Scene and of its parts.

namespace taut {

/// Largest coordinate, size or displacement in a scene [m].
inline constexpr double kFar = 1e6;

/// Key of a body's frames. It is in no SceneKey::Member; content() includes it as a key that was
/// added later.
inline constexpr std::string_view kFramesKey = "collider.frames";

/// Key of a membrane's stiffness, by which content() includes the whole membrane.
inline constexpr std::string_view kMembraneKey = "membrane.stiffness";

/// Keys of damping in proportion to stiffness.
inline constexpr std::string_view kLinkDamping = "links.damping",
                                  kMembraneDamping = "membrane.damping";

/// Allowed range of a number. Non-finite numbers are never allowed.
struct Range {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool above_min = false;  ///< min itself is excluded

  static constexpr Range positive(double max) { return {0, max, true}; }
  static constexpr Range non_negative(double max) { return {0, max, false}; }
  static constexpr Range within(double bound) { return {-bound, bound, false}; }
  bool holds(double value) const {
    return (above_min ? value > min : value >= min) && value <= max;
  }
  std::string text() const;  ///< "greater than 0 and at most 10"
};

/// Source of a cloth: rows of vertices, or a file of triangles.
enum class ClothKind { grid, mesh };
std::string_view to_string(ClothKind);

/// Single values of a file from which vertices, links and steps of a Scene are made.
struct FileKeys {
  Vec3 origin = Vec3::Zero();  ///< m
  Vec3 u = Vec3::UnitX();      ///< unit
  Vec3 v = -Vec3::UnitY();     ///< unit
  double scale = 1;            ///< m per unit of the mesh's file
  double mass = 0;             ///< kg
  double area_density = 0.2;   ///< kg/m^2
  Lumping lumping = Lumping::area;
  double span = 0;                       ///< m
  double tilt = 0;                       ///< degrees
  double stretch = 1;                    ///< start shape over rest shape
  Vec3 velocity = Vec3::Zero();          ///< m/s
  enum class Inside { error, resolve };  ///< refuse a cloth inside a collider, or move it out
  Inside start_inside = Inside::error;
  bool structural = true, shear = true, bend = false;
  bool overlap = false;  ///< particles may overlap at rest
  double dt = 1.0 / 64;  ///< s
  double duration = 10;  ///< s
};

/// Most vertices of a cloth, a power of two, and most steps of a run.
inline constexpr int kVertexBits = 24, kMaxVertices = 1 << kVertexBits;
inline constexpr double kMaxSteps = 1e9;

/// A key of a scene file. A key with a member is a single value. Other keys are only described here
/// and have reading code of their own.
struct SceneKey {
  using Member =
      std::variant<std::monostate, double Scene::*, Vec3 Scene::*, bool Scene::*, double Wind::*,
                   Vec3 Wind::*, Wind::Law Wind::*, double SelfCollision::*, double Bending::*,
                   Vec3 Bending::*, Membrane::Law Membrane::*, double Membrane::*, Vec3 Membrane::*,
                   double Collider::*, Vec3 Motion::*, double Plane::*, Vec3 Plane::*,
                   double Ball::*, Vec3 Ball::*, Vec3 Box::*, double Capsule::*, Vec3 Capsule::*,
                   Vec3 MeshBody::*, MeshBody::Sides MeshBody::*, double FileKeys::*,
                   Vec3 FileKeys::*, bool FileKeys::*, Lumping FileKeys::*,
                   FileKeys::Inside FileKeys::*>;

  std::string_view path;  ///< "forces.damping"; "summary" is at the top of the file
  Member member = {};     ///< its initialiser is the default
  /// "direction": a vector that is normalised. "file": the name of one, relative to the scene.
  std::string_view type = {};
  std::string_view unit = {};
  Range range = {};                ///< of a number or of each component
  std::string_view choices = {};   ///< "relative|literal": the enumeration, in its order
  std::string_view example = {};   ///< as typed
  std::string_view help = {};      ///< one line
  std::string_view limits = {};    ///< restrictions that the range cannot express
  std::string_view fallback = {};  ///< the default in words, if it is not a constant
  std::string_view effect = {};    ///< name of the effect that `taut require` removes
  bool needed = false;
  std::optional<ClothKind> cloth = {};  ///< the only kind of cloth that has the key; empty: both
  bool needed_there = false;            ///< cloth of that kind needs it
  /// Version of the scene file for external programs that introduced the key. A key of version 2
  /// or later was added after results were stored: the digest includes it only where it differs
  /// from its default, so that scenes without it keep their digests.
  int since = 1;

  bool added_later() const { return since > 1; }
  /// Whether the digest includes the key at this value.
  template <class Value>
  bool counts(const Value& value, const Value& initial) const {
    return !added_later() || value != initial;
  }

  SceneKey need() const { return with(&SceneKey::needed, true); }
  SceneKey only_of(ClothKind kind) const { return with(&SceneKey::cloth, {kind}); }
  SceneKey needed_for(ClothKind kind) const {
    return only_of(kind).with(&SceneKey::needed_there, true);
  }
  SceneKey came_later(int version) const { return with(&SceneKey::since, version); }
  SceneKey limited(std::string_view words) const { return with(&SceneKey::limits, words); }
  SceneKey otherwise(std::string_view words) const { return with(&SceneKey::fallback, words); }
  SceneKey left_out_as(std::string_view name) const { return with(&SceneKey::effect, name); }

  std::string_view section() const {
    return path.substr(0, path.find('.') == path.npos ? 0 : path.find('.'));
  }
  std::string_view name() const { return path.substr(path.find('.') + 1); }
  /// Range and limits: "0 to 1e6".
  std::string allowed() const;
  /// `help`, and the kind of cloth that has the key: "first side; grid".
  std::string meaning() const;
  /// "0.5" as typed, or in words.
  std::string default_text() const;

 private:
  template <class Value>
  SceneKey with(Value SceneKey::*what, Value value) const {
    SceneKey changed = *this;
    changed.*what = value;
    return changed;
  }
};

/// All keys, in the order of the document.
std::span<const SceneKey> scene_keys();

/// The key of this dotted path, which may contain indices of elements ("collider.0.radius");
/// nullptr if there is no such key. Shapes share paths: if several rows have this path, it is the
/// first of them, and the others have the same type, unit, range, choices and example.
const SceneKey* find_scene_key(std::string_view path);

/// content() and later_keys() with another table of keys.
std::string content(const Scene&, std::span<const SceneKey> keys);
std::vector<LaterKey> later_keys(const Scene&, std::span<const SceneKey> keys);

/// Calls visit(key, member, default) if the key is a member of the part.
template <class Part, class Visit>
void visit_member(const SceneKey& key, Part& part, const std::remove_const_t<Part>& initial,
                  const Visit& visit) {
  std::visit(
      [&](auto member) {
        if constexpr (std::is_invocable_v<decltype(member), Part&>)
          visit(key, part.*member, initial.*member);
      },
      key.member);
}

/// Calls visit(key, member, default) for every key of the section that is a member of the part.
template <class Part, class Visit>
void each_key(std::string_view section, Part& part, const Visit& visit,
              std::span<const SceneKey> keys = scene_keys()) {
  const std::remove_const_t<Part> initial{};
  for (const SceneKey& key : keys)
    if (key.section() == section) visit_member(key, part, initial, visit);
}

/// The same for the keys of all sections, in the order in which scenes are hashed: [cloth] is last.
/// Not for a Motion: two sections have its members, and whoever has it says which.
template <class Part, class Visit>
void each_key(Part& part, const Visit& visit, std::span<const SceneKey> keys = scene_keys()) {
  static_assert(!std::is_same_v<std::remove_const_t<Part>, Motion>, "of which section?");
  const std::remove_const_t<Part> initial{};
  for (const bool of_cloth : {false, true})
    for (const SceneKey& key : keys)
      if ((key.section() == "cloth") == of_cloth) visit_member(key, part, initial, visit);
}

}  // namespace taut
