#include "core/io/scene_io.hpp"

#include <cmath>

#include "core/io/cloth_io.hpp"
#include "core/io/contact_checks.hpp"
#include "core/io/motion_io.hpp"
#include "core/io/section.hpp"
#include "core/model/printable.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

const Value kAbsent;

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

SelfCollision read_self_collision(Section& section, ContactWishes& wishes) {
  if (!section.find("radius")) section.missing("radius");
  SelfCollision self;
  self.radius = section.number("radius", Range::positive(kFar), 1);
  wishes.overlap = section.boolean("overlap", false);
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

Scene scene_of(const Document& document, const std::filesystem::path& path) {
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the scene");
  Scene scene;
  scene.name = printable(path.stem().string());
  scene.summary = root.string("summary").value_or("");

  if (!root.find("cloth")) root.missing("cloth");
  Section links(diagnostics, part(root, "links"), "[links]");
  const LinkChoice choice = read_links(links);
  Section cloth(diagnostics, part(root, "cloth"), "[cloth]");
  const bool built = root.table("cloth") && read_cloth(cloth, path.parent_path(), choice, scene);
  ContactWishes wishes;
  wishes.resolve = cloth.choice("start_inside", {"error", "resolve"}, "error") == "resolve";
  if (root.table("cloth")) cloth.finish();
  Section forces(diagnostics, part(root, "forces"), "[forces]");
  read_forces(forces, scene);
  if (const Value* table = root.table("wind")) {
    Section wind(diagnostics, *table, "[wind]");
    scene.wind = read_wind(wind);
  }
  if (const Value* table = root.table("self_collision")) {
    Section self(diagnostics, *table, "[self_collision]");
    scene.self_collision = read_self_collision(self, wishes);
  }
  read_colliders(root, scene);
  read_pin_motions(root, built, scene);
  Section time(diagnostics, part(root, "time"), "[time]");
  read_time(time, scene);
  root.finish();
  if (built) check_whole(root, diagnostics, scene);
  if (built && diagnostics.clean()) check_contact(root, wishes, scene);
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
