#include "core/io/scene_io.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/io/document.hpp"
#include "core/io/scene_readers.hpp"
#include "core/model/angle.hpp"
#include "core/model/index.hpp"
#include "core/model/membrane.hpp"
#include "core/model/text.hpp"

namespace taut {

Eigen::Quaterniond read_rotation(Section& section) {
  const Value* value = section.find("rotation");
  if (!value) return Eigen::Quaterniond::Identity();
  if (value->is_array()) {
    const auto q = section.numbers("rotation", 4, Range::within(1e6));
    if (!q) return Eigen::Quaterniond::Identity();
    const Eigen::Quaterniond rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    if (rotation.norm() > 1e-6) return rotation.normalized();
    section.report("rotation", "must not be zero");
    return Eigen::Quaterniond::Identity();
  }
  if (!value->is_table()) {
    section.report("rotation",
                   "must be { axis, angle } or a quaternion [w, x, y, z], not " + describe(*value));
    return Eigen::Quaterniond::Identity();
  }
  Section rotation(section.diagnostics(), *value, "'rotation' in " + section.name());
  rotation.need({"axis", "angle"});
  const Vec3 axis = rotation.direction("axis", Vec3::UnitY());
  const double angle = rotation.number("angle", Range::within(360), 0);
  rotation.finish();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle * kDegree, axis));
}

void read_value(Section& section, const SceneKey& key, double& value) {
  value = section.number(std::string(key.name()), key.range, value);
  if (key.needed) section.need({key.name()});
}

void read_value(Section& section, const SceneKey& key, bool& value) {
  value = section.boolean(std::string(key.name()), value);
}

void read_value(Section& section, const SceneKey& key, Vec3& value) {
  const std::string name(key.name());
  if (key.needed) section.need({key.name()});
  if (key.type == "direction")
    value = section.direction(name, value);
  else
    value = section.vec3(name, key.range, value);
}

int read_choice(Section& section, const SceneKey& key, int fallback) {
  const std::vector<std::string> all = parts_of(key.choices);
  const std::string name = section.choice(std::string(key.name()), all, all[to_index(fallback)]);
  return static_cast<int>(std::ranges::find(all, name) - all.begin());
}

namespace {

std::vector<Motion::Key> read_path(Section& section) {
  std::vector<Motion::Key> path;
  for (const Value* item : section.tables("path")) {
    Section key(section.diagnostics(), *item, "'path' in " + section.name());
    key.need({"t", "displacement"});
    const auto t = key.number("t", Range::within(1e6));
    const Vec3 displacement = key.vec3("displacement", Range::within(kFar), Vec3::Zero());
    key.finish();
    if (!t) continue;
    if (!path.empty() && *t - path.back().t < 1e-9)
      key.report("t", "must grow from key to key: " + as_typed(*t) + " follows " +
                          as_typed(path.back().t));
    else
      path.push_back({*t, displacement});
  }
  return path;
}

Motion read_motion(Section& section, const Vec3& pivot) {
  Motion motion;
  motion.pivot = pivot;
  read_keys(section, motion);
  motion.path = read_path(section);
  return motion;
}

Vec3 middle(const Plane&) { return Vec3::Zero(); }
Vec3 middle(const Ball& ball) { return ball.center; }
Vec3 middle(const Box& box) { return box.center; }
Vec3 middle(const Capsule& capsule) { return capsule.middle(); }
Vec3 middle(const MeshBody& body) { return body.center; }

Collider read_collider(Section& section, const std::filesystem::path& folder) {
  Collider collider;
  section.need({"type"});
  const std::vector<Shape> shapes = shapes_of_each_type();
  std::vector<std::string> types;
  for (const Shape& shape : shapes) types.emplace_back(type_name(shape));
  const std::string type = section.choice("type", types, "");
  for (const Shape& shape : shapes)
    if (type_name(shape) == type) collider.shape = shape;
  if (type.empty())
    section.know();  // without a type all keys are accepted
  else
    std::visit([&](auto& shape) { read_keys(section, shape); }, collider.shape);
  if (Box* box = std::get_if<Box>(&collider.shape)) box->rotation = read_rotation(section);
  if (MeshBody* body = std::get_if<MeshBody>(&collider.shape)) {
    body->rotation = read_rotation(section);
    read_body(section, folder, collider);
  }
  read_keys(section, collider);
  const Vec3 pivot = std::visit([](const auto& shape) { return middle(shape); }, collider.shape);
  collider.motion = read_motion(section, pivot);
  section.finish();
  return collider;
}

/// Velocity at t = 0 of the point that starts at x [m/s].
Vec3 initial_velocity(const Motion& motion, const Vec3& x) {
  Vec3 v = motion.velocity + motion.spin.cross(x - motion.pivot);
  const auto& path = motion.path;
  for (std::size_t k = 0; k + 1 < path.size(); ++k)
    if (path[k].t <= 0 && 0 < path[k + 1].t)
      v += (path[k + 1].displacement - path[k].displacement) / (path[k + 1].t - path[k].t);
  return v;
}

/// Reads every [[collider]].
void read_colliders(Section& root, const std::filesystem::path& folder, Scene& scene) {
  for (const Value* item : root.tables("collider")) {
    Section section(root.diagnostics(), *item, "[[collider]]", "collider");
    scene.colliders.push_back(read_collider(section, folder));
  }
}

/// Most release times: each makes a solver of its own.
constexpr std::size_t kMostReleases = 64;

/// Release times [s] and the pins released then, as in the file.
using Timed = std::vector<std::pair<double, std::vector<int>>>;

/// Reads every [[pin_motion]]; those with a `release` of their own go to `timed`. Without a mesh
/// (`built` false) only the motions are checked.
void read_pin_motions(Section& root, bool built, Scene& scene, Timed& timed) {
  std::set<int> moved;
  for (const Value* item : root.tables("pin_motion")) {
    Section section(root.diagnostics(), *item, "[[pin_motion]]", "pin_motion");
    PinMotion group;
    section.need({"vertices"});
    if (built) group.vertices = read_vertices(section, "vertices", scene.mesh);
    group.motion = read_motion(section, Vec3::Zero());
    const auto release = section.number("release", allowed_at("pin_motion.release"));
    section.finish();
    for (const int vertex : group.vertices) {
      const bool pinned = std::binary_search(scene.pins.begin(), scene.pins.end(), vertex);
      if (!pinned) {
        section.report("vertices", "names vertex " + std::to_string(vertex) + ", which is no pin");
        break;
      }
      if (!moved.insert(vertex).second) {
        section.report("vertices", "names vertex " + std::to_string(vertex) +
                                       ", which another pin_motion moves");
        break;
      }
      const auto v = static_cast<std::size_t>(vertex);
      scene.start.v[v] = initial_velocity(group.motion, scene.start.x[v]);
    }
    if (release) timed.emplace_back(*release, group.vertices);
    if (!group.motion.at_rest()) scene.pin_motions.push_back(std::move(group));
  }
}

/// Release time [s] of pins without their own; empty: they hold.
std::optional<double> read_release(Section& cloth) {
  const auto release = cloth.number("release", allowed_at("cloth.release"));
  if (release && !cloth.find("pins"))
    cloth.report("release", "lets go of pins, and this cloth has none");
  return release;
}

/// Puts each release at the first step boundary at or after its time, with a tolerance for the
/// rounding of dt. A release at or after the end has no effect, and a remark says so.
void set_releases(const std::optional<double>& of_others, Timed timed, Section& root,
                  Scene& scene) {
  if (of_others) {
    std::vector<int> others = scene.pins;
    for (const auto& one : timed)
      std::erase_if(others, [&](int v) { return std::ranges::binary_search(one.second, v); });
    timed.emplace_back(*of_others, std::move(others));
  }
  std::map<int, std::vector<int>> at;
  for (const auto& [t, vertices] : timed) {
    const double steps = std::ceil(t / scene.dt * (1 - 1e-7));
    if (steps < scene.steps) {
      std::vector<int>& together = at[std::max(1, static_cast<int>(steps))];
      together.insert(together.end(), vertices.begin(), vertices.end());
    } else {
      root.diagnostics().remark("no pin lets go at " + as_typed(t) + " s: the run ends at " +
                                as_typed(scene.duration()) + " s");
    }
  }
  if (at.size() > kMostReleases)
    root.report("cloth", "pins let go at " + std::to_string(at.size()) +
                             " different steps; at most " + std::to_string(kMostReleases) +
                             " are allowed");
  for (auto& [step, vertices] : at) {
    std::ranges::sort(vertices);
    if (!vertices.empty()) scene.releases.push_back({step, std::move(vertices)});
  }
}

const Value kAbsent;

/// The table of that name, or an empty one at the start of the document.
const Value& part(Section& root, const std::string& key) {
  const Value* table = root.table(key);
  return table ? *table : kAbsent;
}

/// Reads the stiffness [N/m] of each family; families that are not given are rigid.
void read_stiffness(Section& links, Scene& scene) {
  const Value* table = links.table("stiffness");
  if (!table) return;
  Section stiffness(links.diagnostics(), *table, "[links] stiffness");
  for (const Family family : kFamilies)
    if (const auto k =
            stiffness.number(std::string(to_string(family)), allowed_at("links.stiffness")))
      scene.stiffness[static_cast<std::size_t>(family)] = *k;
  stiffness.finish();
}

/// The fabric that the scene names; null if none.
const Fabric* read_fabric(Section& root) {
  const auto name = root.string("fabric");
  if (!name) return nullptr;
  std::string problem;
  const Fabric* fabric = find_fabric(*name, problem);
  if (!fabric) root.report("fabric", problem);
  return fabric;
}

/// Reports values that conflict with the fabric. A fabric from a study or the command line replaces
/// the values of the scene's file; a value that is set in the same source as the fabric or after it
/// conflicts.
void judge_fabric(Section& root) {
  const Value* fabric = root.find("fabric");
  if (!fabric) return;
  for (const auto& [name, keys] : {std::pair("cloth", std::vector{"mass", "area_density"}),
                                   std::pair("bending", std::vector{"stiffness"})})
    for (const char* key : keys) {
      const Value* table = root.table(name);
      const Value* value = table ? table->find(key) : nullptr;
      if (!value || (fabric->place.setting >= 0 && value->latest_setting() < 0)) continue;
      root.diagnostics().report(value->place, std::string("'") + key + "' in [" + name +
                                                  "] conflicts with fabric = \"" + fabric->string +
                                                  "\", which sets it: remove one");
    }
}

/// Reads the 'stiffness' of a section of the cloth: one number, or that of warp and weft.
template <class Part>
void read_warp_and_weft(Section& section, Part& part) {
  const Range& range = allowed_at(section.scene_section() + ".stiffness");
  const Value* value = section.find("stiffness");
  if (value && value->is_table()) {
    Section both(section.diagnostics(), *value, "'stiffness' in " + section.name());
    both.need({"warp", "weft"});
    part.warp = both.number("warp", range, 1);
    part.weft = both.number("weft", range, 1);
    both.finish();
  } else {
    part.warp = part.weft = section.number("stiffness", range, 1);
  }
}

/// Reads bending: one stiffness [N m], or that of warp and weft, unless the fabric has it. The
/// direction of the warp is v of a grid unless given.
Bending read_bending(Section& section, const Fabric* fabric) {
  Bending bending;
  if (!fabric) section.need({"stiffness"});
  read_warp_and_weft(section, bending);
  if (fabric) {
    bending.warp = fabric->warp;
    bending.weft = fabric->weft;
  }
  bending.direction.setZero();
  read_keys(section, bending);
  section.finish();
  return bending;
}

/// Reports what arap, which has one number, does not have.
void judge_arap(Section& section, const Membrane& membrane) {
  for (const char* key : {"poisson", "shear"})
    if (section.find(key))
      section.report(key, "is not free with law = \"arap\": it is " +
                              std::string(key[0] == 'p' ? "0" : "half the stiffness"));
  if (membrane.warp != membrane.weft)
    section.report("stiffness", "must be one number with law = \"arap\"");
  if (membrane.damping > 0)
    section.report("damping", "is of Green's strain, which law = \"arap\" does not have");
}

/// Reads the membrane: its stiffness [N/m] and, unless given, the shear of a material that is the
/// same in all directions. Its direction is zero unless given.
Membrane read_membrane(Section& section) {
  Membrane membrane;
  section.need({"stiffness"});
  read_warp_and_weft(section, membrane);
  membrane.direction.setZero();
  read_keys(section, membrane);
  if (membrane.law == Membrane::Law::arap) {
    judge_arap(section, membrane);
    membrane.shear = membrane.warp / 2;
  } else if (const double most = most_poisson(membrane); !(std::abs(membrane.poisson) < most)) {
    section.report("poisson", "must be within " + as_typed(most) +
                                  ", the root of warp over weft: beyond it a strain has a negative "
                                  "energy");
  } else if (!section.find("shear")) {
    if (membrane.warp != membrane.weft)
      section.missing("shear");
    else
      membrane.shear = membrane.warp / (2 + 2 * membrane.poisson);
  }
  section.finish();
  return membrane;
}

/// Reports links along faces that a membrane already stretches.
void judge_doubled(Section& links, const FileKeys& said) {
  for (const auto& [key, there] :
       {std::pair("structural", said.structural), std::pair("shear", said.shear)})
    if (there)
      links.report(key,
                   "doubles the membrane: [membrane] resists what these links resist; leave "
                   "one of them out");
}

/// Gives bending and membrane the one direction of the warp, where only one of them says it.
void agree_on_warp(Section& root, Scene& scene) {
  Vec3& bent = scene.bending->direction;
  Vec3& stretched = scene.membrane->direction;
  if (bent.isZero(0)) bent = stretched;
  if (stretched.isZero(0)) stretched = bent;
  if ((bent - stretched).norm() > 1e-9)
    root.diagnostics().report(
        root.table("membrane")->find("warp")->place,
        "'warp' in [membrane] is not that of [bending]: a cloth has one warp");
}

/// Sets dt and the number of steps. dt is rounded to binary32, which is how Bullet keeps it even in
/// its double build, so that every solver gets the same. The number of steps tolerates this
/// rounding.
void set_steps(const FileKeys& said, Section& time, Scene& scene) {
  scene.dt = static_cast<double>(static_cast<float>(said.dt));
  const double steps = std::ceil(said.duration / scene.dt * (1 - 1e-7));
  if (steps > kMaxSteps) {
    time.report("duration", "makes " + as_typed(steps) + " steps; at most " + as_typed(kMaxSteps) +
                                " are allowed");
    return;
  }
  scene.steps = std::max(1, static_cast<int>(steps));
}

/// Sets the warp's direction if the scene does not: along v of a grid; any direction if warp and
/// weft are equally stiff.
template <class Part>
void complete(Part& part, const Mesh& mesh, bool alike) {
  if (!part.direction.isZero(0)) return;
  if (mesh.grid && mesh.grid->nv > 1)
    part.direction = (mesh.rest[to_index(mesh.grid->nu)] - mesh.rest[0]).normalized();
  else if (alike)
    part.direction = -Vec3::UnitY();
}
bool is_isotropic(const Membrane& m) {
  return m.warp == m.weft && m.poisson > -1 && m.shear == m.warp / (2 + 2 * m.poisson);
}

Scene scene_of(const Document& document, const std::filesystem::path& path,
               std::vector<std::string>* remarks = nullptr) {
  Diagnostics diagnostics(document);
  Section root(diagnostics, document.root, "the scene");
  Scene scene;
  scene.name = printable(path.stem().string());
  scene.summary = root.string("summary").value_or("");

  root.need({"cloth"});
  const Fabric* fabric = read_fabric(root);
  if (fabric) judge_fabric(root);
  FileKeys said;
  const auto read = [&](const char* name, auto&... own) {  // own: a part with keys of this section
    Section section(diagnostics, part(root, name), "[" + std::string(name) + "]", name);
    read_keys(section, said);
    read_keys(section, scene);
    (read_keys(section, own), ...);
    return section;
  };
  const bool membrane = root.table("membrane");
  if (membrane) said.structural = said.shear = false;
  Section links = read("links");
  read_stiffness(links, scene);
  if (membrane) judge_doubled(links, said);
  links.finish();
  Section cloth = read("cloth");
  const bool built =
      root.table("cloth") && read_cloth(cloth, path.parent_path(), fabric, said, scene);
  const std::optional<double> release = read_release(cloth);
  if (root.table("cloth")) cloth.finish();
  read("forces").finish();
  if (root.table("bending") || fabric) {
    Section bending = read("bending");
    scene.bending = read_bending(bending, fabric);
  }
  if (membrane) {
    Section section(diagnostics, part(root, "membrane"), "[membrane]", "membrane");
    scene.membrane = read_membrane(section);
  }
  if (root.table("wind")) read("wind", scene.wind.emplace()).finish();
  if (root.table("self_collision")) read("self_collision", scene.self_collision.emplace()).finish();
  if (built)
    read_seams(root, scene);
  else
    root.tables("seam");
  read_colliders(root, path.parent_path(), scene);
  Timed timed;
  read_pin_motions(root, built, scene, timed);
  Section time = read("time");
  time.finish();
  set_steps(said, time, scene);
  set_releases(release, std::move(timed), root, scene);
  std::vector<std::string> paths;
  for (const SceneKey& key : scene_keys()) paths.emplace_back(key.path);
  root.finish(paths);
  if (scene.bending && scene.membrane) agree_on_warp(root, scene);
  if (built && scene.bending)
    complete(*scene.bending, scene.mesh, scene.bending->warp == scene.bending->weft);
  if (built && scene.membrane)
    complete(*scene.membrane, scene.mesh,
             scene.membrane->law == Membrane::Law::arap || is_isotropic(*scene.membrane));
  if (built) check_whole(root, scene);
  if (built && diagnostics.clean()) check_contact(root, said, scene);
  diagnostics.throw_if_any();
  if (remarks) *remarks = diagnostics.remarks();
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const SceneSettings& settings,
                 std::vector<std::string>* remarks) {
  return scene_of(read_document(path, settings), path, remarks);
}

Scene parse_scene(const std::filesystem::path& file, const std::string& text,
                  const SceneSettings& settings) {
  return scene_of(parse_document(file.string(), text, settings), file);
}

}  // namespace taut
