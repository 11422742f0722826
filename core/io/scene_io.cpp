#include "core/io/scene_io.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/scene_readers.hpp"
#include "core/io/section.hpp"
#include "core/model/crossings.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

const Value kAbsent;

/// What a scene says about how it starts and how fat it is.
struct ContactRules {
  bool resolve = false;  ///< cloth.start_inside = "resolve": move the cloth out instead of refusing
  bool overlap = false;  ///< self_collision.overlap: particles may overlap at rest
};

/// The section of that name, or an empty one that stands at the document's start.
const Value& part(Section& root, const std::string& key) {
  const Value* table = root.table(key);
  return table ? *table : kAbsent;
}

LinkChoice read_links(Section& links) {
  LinkChoice choice;
  choice.structural = links.boolean("structural", true);
  choice.shear = links.boolean("shear", true);
  choice.bend = links.boolean("bend", false);
  links.finish();
  return choice;
}

void read_forces(Section& forces, Scene& scene) {
  scene.gravity = forces.vec3("gravity", 1e6, Vec3(0, -9.81, 0));
  scene.damping = forces.number("damping", Range::non_negative(1e6), 0);
  forces.finish();
}

Wind read_wind(Section& section) {
  Wind wind;
  wind.velocity = section.vec3("velocity", 1e6, Vec3::Zero());
  wind.strength = section.number("strength", Range::non_negative(1e6), 0.1);
  wind.law = section.choice("law", {"relative", "literal"}, "relative") == "relative"
                 ? Wind::Law::relative
                 : Wind::Law::literal;
  section.finish();
  return wind;
}

SelfCollision read_self_collision(Section& section, ContactRules& rules) {
  section.need({"radius"});
  SelfCollision self;
  self.radius = section.number("radius", Range::positive(kFar), 1);
  rules.overlap = section.boolean("overlap", false);
  section.finish();
  return self;
}

/// dt is rounded to binary32: Bullet keeps it so even in its double build, and every solver gets
/// the same. The number of steps forgives that rounding.
void read_time(Section& time, Scene& scene) {
  const double dt = time.number("dt", {1e-7, 10}, 1.0 / 64);
  const double duration = time.number("duration", Range::positive(1e6), 10);
  time.finish();
  scene.dt = static_cast<double>(static_cast<float>(dt));
  const double steps = std::ceil(duration / scene.dt * (1 - 1e-7));
  constexpr double kMaxSteps = 1e9;
  if (steps > kMaxSteps) {
    time.report("duration", "makes " + shortest(steps) + " steps; at most 1e9 are allowed");
    return;
  }
  scene.steps = std::max(1, static_cast<int>(steps));
}

constexpr double kShortestLink = 1e-9;  ///< m

/// What no single key is to blame for.
void check_whole(Section& root, Diagnostics& diagnostics, const Scene& scene) {
  for (const Link& link : scene.links)
    if (!(link.rest >= kShortestLink)) {
      diagnostics.report(root.place("cloth"), "vertices " + std::to_string(link.a) + " and " +
                                                  std::to_string(link.b) +
                                                  " coincide: their link has no length");
      break;
    }
  if (scene.wind && scene.mesh.triangles.empty())
    diagnostics.report(root.place("wind"), "[wind] acts on faces, and this cloth has none");
}

bool pinned(const Scene& scene, std::size_t i) {
  return std::binary_search(scene.pins.begin(), scene.pins.end(), static_cast<int>(i));
}

/// Moves the free vertices out, collider after collider.
void resolve(Scene& scene) {
  for (const Collider& collider : scene.colliders) {
    const Shape shape = shape_at(collider, 0);
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      const Surface s = surface(shape, scene.start.x[i]);
      if (s.distance < scene.thickness && !pinned(scene, i))
        scene.start.x[i] += (scene.thickness - s.distance) * s.normal;
    }
  }
}

/// A pinned vertex may be inside: that is how a cloth is fixed to an obstacle.
void judge_start(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const Shape shape = shape_at(collider, 0);
  const double rounding = 1e-9 * extent(scene);  // of what the file says
  double deepest = 0;
  std::size_t vertex = 0, count = 0;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    const double depth = -surface(shape, scene.start.x[i]).distance;
    if (pinned(scene, i) || depth <= rounding) continue;
    ++count;
    if (depth > deepest) deepest = depth, vertex = i;
  }
  if (count == 0) return;
  root.diagnostics().report(
      item.place, "the cloth starts inside this " + std::string(type_name(collider.shape)) + ": " +
                      std::to_string(count) + " vertices, vertex " + std::to_string(vertex) + " " +
                      shortest(deepest) +
                      " m deep; move one of them, or set start_inside = \"resolve\" in [cloth]");
}

void judge_path(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const auto& path = collider.motion.path;
  const double farthest = extent(scene);  // m, in one time step
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double speed =
        (path[k].displacement - path[k - 1].displacement).norm() / (path[k].t - path[k - 1].t);
    if (speed * scene.dt <= farthest) continue;
    root.diagnostics().report(
        item.place, "the path jumps: from key " + std::to_string(k) + " to key " +
                        std::to_string(k + 1) + " it makes " + shortest(speed * scene.dt) +
                        " m in one time step, more than the size of the cloth");
    return;
  }
}

/// Length of the shortest link between neighbours [m]; 0 if there is none.
double spacing(const Scene& scene) {
  double least = 0;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && (least == 0 || link.rest < least)) least = link.rest;
  return least;
}

void judge_sizes(Section& root, const ContactRules& rules, const Scene& scene) {
  const double least = spacing(scene);
  if (least == 0) return;
  if (scene.thickness > least && !scene.colliders.empty())
    root.report("cloth", "thickness " + shortest(scene.thickness) +
                             " m is larger than the spacing " + shortest(least) +
                             " m of the vertices");
  if (!scene.self_collision || rules.overlap) return;
  if (2 * scene.self_collision->radius > least * (1 + 1e-9))
    root.report("self_collision", "particles of radius " + shortest(scene.self_collision->radius) +
                                      " m overlap at rest, where they are " + shortest(least) +
                                      " m apart: at most half of that, or set overlap = true");
}

/// Reports what makes contact meaningless in an otherwise complete scene: a cloth that starts
/// inside a collider (moved to its surface, at the scene's thickness, if the scene says so) or
/// through itself, a thickness or a particle larger than the spacing, a collider whose path jumps.
void check_contact(Section& root, const ContactRules& rules, Scene& scene) {
  if (rules.resolve) resolve(scene);
  const auto items = root.tables("collider");
  for (std::size_t k = 0; k < items.size() && k < scene.colliders.size(); ++k) {
    judge_start(*items[k], root, scene.colliders[k], scene);
    judge_path(*items[k], root, scene.colliders[k], scene);
  }
  judge_sizes(root, rules, scene);
  if (!scene.self_collision) return;
  const auto pairs = crossings(scene.mesh.triangles, scene.start.x);
  if (!pairs.empty())
    root.report("self_collision",
                "the cloth starts through itself: " + std::to_string(pairs.size()) +
                    " pairs of faces cross, the first being " + std::to_string(pairs[0][0]) +
                    " and " + std::to_string(pairs[0][1]));
}

Scene scene_of(const Document& document, const std::filesystem::path& path) {
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the scene");
  Scene scene;
  scene.name = printable(path.stem().string());
  scene.summary = root.string("summary").value_or("");

  root.need({"cloth"});
  Section links(diagnostics, part(root, "links"), "[links]");
  const LinkChoice choice = read_links(links);
  Section cloth(diagnostics, part(root, "cloth"), "[cloth]");
  const bool built = root.table("cloth") && read_cloth(cloth, path.parent_path(), choice, scene);
  ContactRules rules;
  rules.resolve = cloth.choice("start_inside", {"error", "resolve"}, "error") == "resolve";
  if (root.table("cloth")) cloth.finish();
  Section forces(diagnostics, part(root, "forces"), "[forces]");
  read_forces(forces, scene);
  if (const Value* table = root.table("wind")) {
    Section wind(diagnostics, *table, "[wind]");
    scene.wind = read_wind(wind);
  }
  if (const Value* table = root.table("self_collision")) {
    Section self(diagnostics, *table, "[self_collision]");
    scene.self_collision = read_self_collision(self, rules);
  }
  read_colliders(root, scene);
  read_pin_motions(root, built, scene);
  Section time(diagnostics, part(root, "time"), "[time]");
  read_time(time, scene);
  root.finish();
  if (built) check_whole(root, diagnostics, scene);
  if (built && diagnostics.clean()) check_contact(root, rules, scene);
  diagnostics.throw_if_any();
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return scene_of(read_document(path, overrides), path);
}

Scene parse_scene(const std::filesystem::path& file, const std::string& text,
                  const std::vector<std::string>& overrides) {
  return scene_of(parse_document(file.string(), text, overrides), file);
}

}  // namespace taut
