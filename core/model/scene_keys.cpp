#include "core/model/scene_keys.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"

namespace taut {

namespace {

template <class Part>
SceneKey number(std::string_view path, double Part::*member, std::string_view unit, Range range,
                std::string_view example, std::string_view help) {
  return {path, member, "number", unit, range, "", example, help};
}
template <class Part>
SceneKey vector(std::string_view path, Vec3 Part::*member, std::string_view unit, Range range,
                std::string_view example, std::string_view help) {
  return {path, member, "vector", unit, range, "", example, help};
}
/// A vector of any length but zero, which is normalised.
template <class Part>
SceneKey direction(std::string_view path, Vec3 Part::*member, std::string_view example,
                   std::string_view help) {
  return {path, member, "direction", "", Range::within(1e6), "", example, help};
}
template <class Part>
SceneKey flag(std::string_view path, bool Part::*member, std::string_view example,
              std::string_view help) {
  return {path, member, "boolean", "", {}, "", example, help};
}
template <class Part, class Enumeration>
SceneKey choice(std::string_view path, Enumeration Part::*member, std::string_view choices,
                std::string_view example, std::string_view help) {
  return {path, member, "string", "", {}, choices, example, help};
}
/// A key that is not a single value; its own code reads it.
SceneKey other(std::string_view path, std::string_view type, std::string_view unit,
               std::string_view limits, std::string_view fallback, std::string_view example,
               std::string_view help) {
  return {path, {}, type, unit, {}, "", example, help, limits, fallback};
}
/// Numbers that code of its own reads, within the range.
SceneKey other(std::string_view path, std::string_view type, std::string_view unit, Range range,
               std::string_view fallback, std::string_view example, std::string_view help) {
  return {path, {}, type, unit, range, "", example, help, "", fallback};
}

// Scenes are hashed in the order of the table: add a new key at the end of its section, with
// came_later().
const SceneKey kKeys[] = {
    other("cloth.grid", "two whole numbers", "1",
          lasting("1 to 2^" + std::to_string(kVertexBits) + " vertices, 2 at least"), "",
          "[32, 32]", "vertices along u and v; `[1, n]` is a chain")
        .needed_for(ClothKind::grid),
    other("cloth.mesh", "file", "", "", "needed for a mesh", "\"disc.obj\"",
          "OBJ file, relative to the scene; excludes `grid`"),
    other("cloth.size", "two numbers", "m", "> 0 where there are two vertices", "", "[1.0, 1.0]",
          "sides along u and v")
        .needed_for(ClothKind::grid),
    vector("cloth.origin", &FileKeys::origin, "m", Range::within(kFar), "[-0.5, 1, 0]",
           "where vertex (0, 0), or a mesh's own origin, lies at rest"),
    direction("cloth.u", &FileKeys::u, "[0, 0, 1]", "first side").only_of(ClothKind::grid),
    direction("cloth.v", &FileKeys::v, "[0, 0, -1]", "second side")
        .limited("not parallel to u")
        .only_of(ClothKind::grid),
    number("cloth.scale", &FileKeys::scale, "1", Range{1e-6, 1e6}, "0.5",
           "metres per unit of the OBJ file")
        .only_of(ClothKind::mesh),
    other("cloth.rotation", "rotation", "degrees", "", "none", "{ axis = [1, 0, 0], angle = 90 }",
          "turns the OBJ file about its own origin")
        .only_of(ClothKind::mesh),
    number("cloth.mass", &FileKeys::mass, "kg", Range{1e-9, 1e9}, "0.3",
           "of the whole cloth; excludes `area_density`")
        .otherwise("by area_density"),
    number("cloth.area_density", &FileKeys::area_density, "kg/m^2", Range{1e-9, 1e9}, "0.15",
           "mass by area; not for a chain of no width"),
    choice("cloth.lumping", &FileKeys::lumping, "area|equal", "\"equal\"",
           "each vertex weighs the area it owns, or all weigh the same"),
    number(
        "cloth.span", &FileKeys::span, "m", Range::positive(kFar), "0.9",
        "starts with left and right side this far apart, rows sagging square to u, to v's side, as "
        "circular arcs that keep every structural length")
        .only_of(ClothKind::grid)
        .limited("at most the width")
        .otherwise("the width"),
    number("cloth.tilt", &FileKeys::tilt, "degrees", Range::within(360), "30",
           "starts turned about the side u through the origin, after `span`")
        .only_of(ClothKind::grid),
    number("cloth.stretch", &FileKeys::stretch, "1", Range{1e-3, 1e3}, "0.5",
           "the start as a multiple of the shape about the first vertex, pins too, after `tilt`; "
           "rest lengths stay"),
    other("cloth.weights", "tables", "1", Range{1e-9, 1e9}, "none",
          "[{ vertices = [\"bottom\"], factor = 1000 }]",
          "masses of these vertices as a multiple of what the lumping gives"),
    other("cloth.pins", "vertices", "", "", "none", "[\"top\"]",
          "never integrated: they stay, or follow `pin_motion`"),
    other("cloth.placed", "tables", "m", Range::within(kFar), "none",
          "[{ vertex = [31, 0], at = [0.99, 0, 0] }]",
          "vertices that start elsewhere, after `tilt` and `stretch`"),
    vector("cloth.velocity", &FileKeys::velocity, "m/s", Range::within(kFar), "[1, 0, 0]",
           "of every vertex at the start, pins apart"),
    number("cloth.thickness", &Scene::thickness, "m", Range::non_negative(kFar), "0.005",
           "the distance that the cloth keeps from colliders")
        .limited("at most the spacing if there are colliders")
        .left_out_as("thickness"),
    choice("cloth.start_inside", &FileKeys::start_inside, "error|resolve", "\"resolve\"",
           "a cloth that starts inside a collider is refused, or moved to its surface at the "
           "thickness; pins may be inside"),
    other(
        "cloth.weld", "number", "m", Range::positive(kFar), "none", "1e-4",
        "joins vertices that are at most this far apart, each to the first that stays: seams that "
        "a program split; what a scene numbers stays the file's")
        .only_of(ClothKind::mesh),
    other("cloth.release", "number", "s", Range::positive(1e6), "never", "2.0",
          "pins let go at the first step boundary at or after this time, free with the velocity "
          "that they had; those of a `pin_motion` that has a `release` of its own at that. At or "
          "after the end of the run they hold: a note says so"),

    flag("links.structural", &FileKeys::structural, "false",
         "along the sides of the quads; the edges of a mesh"),
    flag("links.shear", &FileKeys::shear, "false", "along both diagonals of every quad"),
    flag("links.bend", &FileKeys::bend, "true",
         "between every second vertex; across each inner edge of a mesh"),
    other("links.stiffness", "table", "N/m", Range::positive(1e12), "{}", "{ structural = 5000 }",
          "by family; one that is not named is rigid. `jakobsen` and `bullet`, whose links are "
          "rigid, refuse such a scene unless told otherwise: `--set 'links.stiffness={}'`"),
    number(kLinkDamping, &Scene::link_damping, "s", Range::non_negative(1e3), "1e-3",
           "b, damping in proportion to stiffness: a link of stiffness K resists a change of its "
           "length n by b K dn/dt. A fall keeps its speed, and a mode w that stretches links has "
           "the damping ratio b w/2; rigid links have none")
        .limited("above 0 only with a `stiffness`")
        .came_later(6)
        .left_out_as("damping of links"),

    other("bending.stiffness", "number or table", "N m", Range{1e-12, 1e6}, "needed",
          "{ warp = 1.2e-5, weft = 8e-6 }",
          "moment per width and curvature; one number, or of a strip along the warp and one across "
          "it; one at an angle a to the warp, free to twist, 1/(cos^2 a/sqrt(warp) + sin^2 "
          "a/sqrt(weft))^2"),
    direction("bending.warp", &Bending::direction, "[1, 0, 0]",
              "of the warp over the rest shape, projected on each face; needed for a mesh whose "
              "stiffnesses differ")
        .otherwise("a grid's v"),

    other(kMembraneKey, "number or table", "N/m", Range{1e-6, 1e9}, "needed",
          "{ warp = 1200, weft = 800 }",
          "force per width and strain; one number, or of a strip along the warp and one across it")
        .came_later(5),
    choice("membrane.law", &Membrane::law, "stvk|arap", "\"arap\"",
           "St Venant and Kirchhoff's, or the distance from the nearest rotation, which is another "
           "material: no `poisson`, no `shear`, warp and weft alike")
        .came_later(5),
    number("membrane.poisson", &Membrane::poisson, "1", Range::within(1e3), "0.3",
           "nu12: how much a strip along the warp narrows, by its strain")
        .limited("its square below warp/weft")
        .came_later(5),
    number("membrane.shear", &Membrane::shear, "N/m", Range{1e-6, 1e9}, "350",
           "shear force per width and angle; needed where warp and weft differ")
        .otherwise("stiffness/(2 + 2 poisson)")
        .came_later(5),
    direction("membrane.warp", &Membrane::direction, "[1, 0, 0]",
              "of the warp over the rest shape, as `bending.warp`, and the same where both are "
              "given; needed for a mesh whose stiffnesses differ")
        .otherwise("that of bending; a grid's v")
        .came_later(5),
    number(kMembraneDamping, &Membrane::damping, "s", Range::non_negative(1e3), "1e-3",
           "b, damping in proportion to stiffness, as `links.damping`: strain rates resist with b "
           "times what strains do")
        .limited("not with \"arap\"")
        .came_later(6)
        .left_out_as("damping of the membrane"),

    vector("forces.gravity", &Scene::gravity, "m/s^2", Range::within(1e6), "[0, 0, -1.62]",
           "of every vertex"),
    number("forces.damping", &Scene::damping, "1/s", Range::non_negative(1e6), "0.5",
           "a free particle's velocity decays as exp(-damping t)")
        .left_out_as("damping"),

    vector("wind.velocity", &Wind::velocity, "m/s", Range::within(1e6), "[6, 0, 1.5]",
           "of the air"),
    number("wind.strength", &Wind::strength, "N s/m^3", Range::non_negative(1e6), "0.5",
           "force by area and speed"),
    choice("wind.law", &Wind::law, "relative|literal", "\"literal\"",
           "d is the wind relative to the face, or the wind alone (no terminal speed)")
        .left_out_as("law of the wind"),

    other("collider.type", "string", "", "", "needed", "\"plane\"",
          "\"plane\", \"ball\", \"box\", \"capsule\" or \"mesh\""),
    direction("collider.normal", &Plane::normal, "[0, 1, 0.2]", "plane: points out of the solid"),
    number("collider.offset", &Plane::offset, "m", Range::within(kFar), "-1",
           "plane: of all its points along the unit normal"),
    vector("collider.center", &Ball::center, "m", Range::within(kFar), "[0, -1, 0]", "ball").need(),
    number("collider.radius", &Ball::radius, "m", Range::positive(kFar), "0.3", "ball").need(),
    vector("collider.center", &Box::center, "m", Range::within(kFar), "[0, -1, 0]", "box").need(),
    vector("collider.half_extents", &Box::half_extents, "m", Range::positive(kFar),
           "[0.3, 0.2, 0.3]", "box: half its sides")
        .need(),
    other("collider.rotation", "rotation", "degrees", "not zero", "none",
          "{ axis = [0, 1, 0], angle = 45 }",
          "box, mesh: axis and angle, or a quaternion `[w, x, y, z]` of any length"),
    vector("collider.from", &Capsule::from, "m", Range::within(kFar), "[0, -1, 0]",
           "capsule: one end of its axis")
        .need(),
    vector("collider.to", &Capsule::to, "m", Range::within(kFar), "[0, -1, 0.3]",
           "capsule: the other end; if they are equal it is a ball")
        .need(),
    number("collider.radius", &Capsule::radius, "m", Range::positive(kFar), "0.3", "capsule")
        .need(),
    other("collider.file", "file", "", "", "needed for a mesh", "\"box.obj\"",
          "mesh: OBJ file, relative to the scene; vertices that coincide are one"),
    other("collider.scale", "number", "1", Range{1e-6, 1e6}, "1", "0.01",
          "mesh: metres per unit of its file"),
    other(kFramesKey, "file", "", "", "none: it is rigid", "\"walker.npy\"",
          "mesh: NumPy array [frames, vertices, 3], relative to the scene, in the file's unit and "
          "frame: where the file's vertices are; the first frame is at t = 0, between two they go "
          "straight, after the last they rest; velocity, spin and path move the whole")
        .came_later(4),
    other("collider.fps", "number", "1/s", Range::positive(1e6), "needed with `frames`", "30",
          "mesh: frames in a second"),
    vector("collider.center", &MeshBody::center, "m", Range::within(kFar), "[0, -1, 0]",
           "mesh: where its file's origin is"),
    choice("collider.sides", &MeshBody::sides, "out|both", "\"both\"",
           "mesh: solid and closed, or thin; a thin one needs a `cloth.thickness`, and keeps the "
           "cloth on the side on which it is"),
    number("collider.friction", &Collider::friction, "1", Range::non_negative(1e3), "0.5",
           "Coulomb's coefficient")
        .left_out_as("friction"),
    vector("collider.velocity", &Motion::velocity, "m/s", Range::within(1e6), "[0, 0.1, 0]",
           "of its motion"),
    vector("collider.spin", &Motion::spin, "rad/s", Range::within(1e6), "[0, 1, 0]",
           "about the axis through `pivot`"),
    vector("collider.pivot", &Motion::pivot, "m", Range::within(kFar), "[0, 0, 0]", "of its spin")
        .otherwise("the center, a capsule's middle; a plane's: the origin"),
    other("collider.path", "tables", "s, m", "t growing", "none",
          "[{ t = 0, displacement = [0, 0, 0] }, { t = 1, displacement = [0, 1, 0] }]",
          "linear between its keys, constant outside; adds to `velocity`"),

    other("pin_motion.vertices", "vertices", "", "pinned", "needed", "[\"top-left\"]",
          "that move together"),
    vector("pin_motion.velocity", &Motion::velocity, "m/s", Range::within(1e6), "[0.1, 0, 0]",
           "of their motion"),
    vector("pin_motion.spin", &Motion::spin, "rad/s", Range::within(1e6), "[0, 1, 0]",
           "about the axis through `pivot`"),
    vector("pin_motion.pivot", &Motion::pivot, "m", Range::within(kFar), "[0.5, 0, 0]",
           "of their spin"),
    other("pin_motion.path", "tables", "s, m", "t growing", "none",
          "[{ t = 0, displacement = [0, 0, 0] }, { t = 1, displacement = [0, 0, 1] }]",
          "as of a collider"),
    other("pin_motion.release", "number", "s", Range::positive(1e6), "the cloth's", "2.0",
          "when these pins let go, moved or not: as `cloth.release`"),

    other("seam.a", "vertices", "", "", "needed", "[3, 4, 5]",
          "drawn to those of `b`, one to one, in the order in which they are named: by structural "
          "links of rest length 0, which no strain counts"),
    other("seam.b", "vertices", "", "as many as `a`; none of a face with its partner", "needed",
          "[12, 11, 10]", "see `a`"),

    number("self_collision.radius", &SelfCollision::radius, "m", Range::positive(kFar), "0.01",
           "every particle is a ball of this radius")
        .need()
        .limited("at most half the spacing"),
    flag("self_collision.overlap", &FileKeys::overlap, "true",
         "lets the radius be larger: the particles then overlap at rest"),

    number("time.dt", &FileKeys::dt, "s", Range{1e-7, 10}, "\"1/120\"",
           "rounded to binary32, because Bullet keeps it so: all solvers get the same"),
    number("time.duration", &FileKeys::duration, "s", Range::positive(1e6), "5",
           "rounded up to whole steps")
        .limited(lasting(as_typed(kMaxSteps) + " steps at most")),

    other("fabric", "string", "", "`taut list fabrics`", "none", "\"petrak-m3\"",
          "mass by area and bending stiffness of a fabric as it was measured; `--fabric` and a "
          "study's put them in place of the `cloth.mass`, `cloth.area_density` and "
          "`bending.stiffness` of the scene's file; set beside a fabric these are an error"),
    other("summary", "string", "", "", "\"\"", "\"A flag\"",
          "one sentence; a label, not part of what is simulated"),
};

/// Initial value of a member.
template <class Part, class Value>
Value initial(Value Part::*member) {
  return Part{}.*member;
}

std::string typed(double value, const SceneKey&) { return as_typed(value); }
std::string typed(bool value, const SceneKey&) { return value ? "true" : "false"; }
std::string typed(const Vec3& v, const SceneKey&) { return "[" + join(v, ", ", as_typed) + "]"; }
template <class Enumeration>
requires std::is_enum_v<Enumeration> std::string typed(Enumeration value, const SceneKey& key) {
  return '"' + parts_of(key.choices)[static_cast<std::size_t>(value)] + '"';
}

bool is_index(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

}  // namespace

std::span<const SceneKey> scene_keys() { return kKeys; }

const SceneKey* find_scene_key(std::string_view path) {
  std::string plain;  // without the indices of elements
  for (const std::string& part : parts_of(path, '.'))
    if (!is_index(part)) plain += (plain.empty() ? "" : ".") + part;
  const auto found = std::ranges::find(kKeys, plain, &SceneKey::path);
  return found == std::end(kKeys) ? nullptr : &*found;
}

std::string Range::text() const {
  const Range any;
  std::string low, high;
  if (min != any.min) low = (above_min ? "greater than " : "at least ") + as_typed(min);
  if (max != any.max) high = "at most " + as_typed(max);
  return low + (low.empty() || high.empty() ? "" : " and ") + high;
}

std::string SceneKey::allowed() const {
  std::string text;
  if (type == "direction")
    text = "not zero";
  else if (!choices.empty())
    text = "\"" + join(parts_of(choices), "\" or \"") + "\"";
  else if (range.max != Range{}.max)
    text = range.above_min           ? "above 0, at most " + as_typed(range.max)
           : range.min == -range.max ? "within " + as_typed(range.max)
                                     : as_typed(range.min) + " to " + as_typed(range.max);
  return text + (text.empty() || limits.empty() ? "" : "; ") + std::string(limits);
}

std::string_view to_string(ClothKind kind) { return kind == ClothKind::grid ? "grid" : "mesh"; }

std::string SceneKey::meaning() const {
  std::string text(help);
  if (cloth && !needed_there) text.append("; ").append(to_string(*cloth));
  return text;
}

std::string SceneKey::default_text() const {
  if (needed_there) return "needed for a " + std::string(to_string(*cloth));
  if (needed || !fallback.empty()) return std::string(needed ? "needed" : fallback);
  return std::visit(
      [&]<class Of>(Of of) -> std::string {
        if constexpr (std::is_same_v<Of, std::monostate>)
          return "";
        else
          return typed(initial(of), *this);
      },
      member);
}

}  // namespace taut
