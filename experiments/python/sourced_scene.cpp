#include "experiments/python/sourced_scene.hpp"

#include <pybind11/stl.h>

#include <utility>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/python/unlocked.hpp"
#include "experiments/system/data.hpp"

namespace taut::python {

Scene SourcedScene::read(const SceneSettings& with) const {
  return text ? parse_scene(file, *text, with) : load_scene(file, with);
}

SourcedScene SourcedScene::replaced(const SceneSettings& more) const {
  if (file.empty())
    throw InputError("this scene belongs to a solver: call replace() of the scene that you gave");
  SourcedScene other = *this;
  other.settings = taut::replaced(std::move(other.settings), more);
  const Unlocked others_run;
  other.scene = std::make_shared<const Scene>(read(other.settings));
  return other;
}

SourcedScene scene_from(py::handle source, const py::dict& settings, const std::string& name) {
  SourcedScene scene;
  if (!py::isinstance<py::str>(source) && !py::hasattr(source, "__fspath__"))
    throw InputError("scene: a " + type_of(source) +
                     "; must be a taut.Scene, a shipped name, a path or TOML text");
  scene.source = py::cast<std::string>(py::module_::import("os").attr("fspath")(source));
  if (scene.source.find('\n') != std::string::npos) {
    scene.text = std::exchange(scene.source, name);
    scene.file = name + ".toml";
  } else {
    const bool is_path = !py::isinstance<py::str>(source);
    scene.file =
        find_scene(is_path && scene.source.find('/') == std::string::npos ? "./" + scene.source
                                                                          : scene.source);
  }
  return scene.replaced(settings_of(settings));
}

SourcedScene timed_scene(py::handle given, const py::object& dt, const py::object& duration) {
  py::dict times;
  if (!dt.is_none()) times["time.dt"] = dt;
  if (!duration.is_none()) times["time.duration"] = duration;
  if (!py::isinstance<SourcedScene>(given)) return scene_from(given, times, "scene");
  const auto& scene = py::cast<const SourcedScene&>(given);
  return times.empty() ? scene : scene.replaced(settings_of(times));
}

namespace {

/// A demand of a scene on a solver, beyond gravity, links and fixed pins.
struct Effect {
  const char* name;
  bool (*is_in)(const Scene&);
};
constexpr Effect kEffects[] = {
    {"colliders", [](const Scene& s) { return !s.colliders.empty(); }},
    {"moving pins", [](const Scene& s) { return !s.pin_motions.empty(); }},
    {"pins that let go", [](const Scene& s) { return !s.releases.empty(); }},
    {"wind", [](const Scene& s) { return s.wind.has_value(); }},
    {"bending", [](const Scene& s) { return s.bending.has_value(); }},
    {"membrane", [](const Scene& s) { return s.membrane.has_value(); }},
    {"self-collision", [](const Scene& s) { return s.self_collision.has_value(); }},
    {"damping", [](const Scene& s) { return s.damping > 0; }},
    {"damping of links", [](const Scene& s) { return s.link_damping > 0; }},
    {"damping of the membrane",
     [](const Scene& s) { return s.membrane && s.membrane->damping > 0; }},
    {"elastic links", [](const Scene& s) { return s.stiffness != kRigid; }},
};

std::vector<std::string> effects(const Scene& scene) {
  std::vector<std::string> all;
  for (const Effect& effect : kEffects)
    if (effect.is_in(scene)) all.emplace_back(effect.name);
  return all;
}

std::string about_effects() {
  return "What it has besides gravity, rigid links and pins that stay: " +
         join(kEffects, ", ",
              [](const Effect& effect) { return "'" + std::string(effect.name) + "'"; }) +
         ".";
}

py::array places_of_pins(const Scene& scene, double t) {
  std::vector<Vec3> places;
  for (const int pin : scene.pins) places.push_back(pin_position(scene, pin, t));
  return array_of(places);
}

py::array_t<int> links_of(const Scene& scene) {
  py::array_t<int> pairs({static_cast<py::ssize_t>(scene.links.size()), py::ssize_t{2}});
  int* at = pairs.mutable_data();
  for (const Link& link : scene.links) {
    *at++ = link.a;
    *at++ = link.b;
  }
  return pairs;
}

/// Distance and normal of each point with respect to a collider.
py::tuple surface_at(const Scene& scene, std::size_t collider, const py::object& x, double t) {
  if (collider >= scene.colliders.size())
    throw InputError("collider: " + std::to_string(collider) + "; the scene has " +
                     std::to_string(scene.colliders.size()));
  const Doubles points(points_of(x, "x", 2, {}, "(n, 3)"));
  const Shape shape = shape_at(scene.colliders[collider], t);
  std::vector<double> distances;
  std::vector<Vec3> normals;
  for (const Vec3& point : vectors_of(points)) {
    const Surface at = surface(shape, point);
    distances.push_back(at.distance);
    normals.push_back(at.normal);
  }
  return py::make_tuple(array_of(distances), array_of(normals));
}

template <auto member>
auto value_in() {
  return [](const SourcedScene& s) { return (*s.scene).*member; };
}

std::string about(const SourcedScene& s) {
  return "<taut.Scene " + s.scene->name + ": " + std::to_string(s.scene->mesh.size()) +
         " vertices, " + std::to_string(s.scene->links.size()) + " links, " +
         std::to_string(s.scene->steps) + " steps of " + shortest(s.scene->dt) + " s>";
}

}  // namespace

void define_scene(py::module_& m) {
  py::class_<SourcedScene> scene(m, "Scene", doc::kScene);
  scene.def("__repr__", [](const SourcedScene& s) { return text_of(about(s)); })
      .def(
          "replace",
          [](const SourcedScene& s, const py::dict& settings) {
            return s.replaced(settings_of(settings));
          },
          py::arg("settings"), doc::kReplace)
      .def(
          "pin_positions",
          [](const SourcedScene& s, double t) { return places_of_pins(*s.scene, t); }, py::arg("t"),
          doc::kPinPositions)
      .def(
          "surface",
          [](const SourcedScene& s, std::size_t collider, const py::object& x, double t) {
            return surface_at(*s.scene, collider, x, t);
          },
          py::arg("collider"), py::arg("x"), py::arg("t"), doc::kSurface)
      .def_property_readonly(
          "name", [](const SourcedScene& s) { return text_of(s.scene->name); }, "File stem.")
      .def_property_readonly(
          "summary", [](const SourcedScene& s) { return text_of(s.scene->summary); },
          "One sentence.")
      .def_property_readonly(
          "x", [](const SourcedScene& s) { return array_of(s.scene->start.x); },
          "(n, 3) m: where the vertices start. A copy.")
      .def_property_readonly(
          "v", [](const SourcedScene& s) { return array_of(s.scene->start.v); },
          "(n, 3) m/s: how they start. A copy.")
      .def_property_readonly(
          "rest", [](const SourcedScene& s) { return array_of(s.scene->mesh.rest); },
          "(n, 3) m: the shape at rest. A copy.")
      .def_property_readonly(
          "mass", [](const SourcedScene& s) { return array_of(s.scene->mesh.mass); },
          "(n,) kg, pinned vertices included. A copy.")
      .def_property_readonly(
          "inverse_mass", [](const SourcedScene& s) { return array_of(inverse_masses(*s.scene)); },
          "(n,) 1/kg, 0 of pinned vertices. A copy.")
      .def_property_readonly(
          "links", [](const SourcedScene& s) { return links_of(*s.scene); },
          "(m, 2) int: the vertices of each link, in the order of Gauss-Seidel. A copy.")
      .def_property_readonly(
          "rest_lengths",
          [](const SourcedScene& s) {
            std::vector<double> lengths;
            for (const Link& link : s.scene->links) lengths.push_back(link.rest);
            return array_of(lengths);
          },
          "(m,) m: the links' lengths at rest. A copy.")
      .def_property_readonly(
          "families",
          [](const SourcedScene& s) {
            py::list all;
            for (const Link& link : s.scene->links) all.append(text_of(to_string(link.family)));
            return all;
          },
          "m texts: 'structural', 'shear' or 'bend'.")
      .def_property_readonly(
          "triangles",
          [](const SourcedScene& s) {
            const auto& all = s.scene->mesh.triangles;
            return py::array_t<int>({static_cast<py::ssize_t>(all.size()), py::ssize_t{3}},
                                    all.empty() ? nullptr : all.front().data());
          },
          "(f, 3) int: the vertices of each face. A copy.")
      .def_property_readonly(
          "pins",
          [](const SourcedScene& s) {
            return py::array_t<int>(static_cast<py::ssize_t>(s.scene->pins.size()),
                                    s.scene->pins.data());
          },
          "(p,) int: the vertices that no solver moves. A copy.")
      .def_property_readonly(
          "gravity",
          [](const SourcedScene& s) { return Doubles(py::ssize_t{3}, s.scene->gravity.data()); },
          "(3,) m/s^2. A copy.")
      .def_property_readonly(
          "colliders",
          [](const SourcedScene& s) {
            py::list all;
            for (const Collider& c : s.scene->colliders) all.append(text_of(type_name(c.shape)));
            return all;
          },
          "The type of each collider; surface() says where it is.")
      .def_property_readonly(
          "effects", [](const SourcedScene& s) { return effects(*s.scene); },
          about_effects().c_str())
      .def_property_readonly("damping", value_in<&Scene::damping>(),
                             "1/s: a free vertex's velocity decays as exp(-damping t).")
      .def_property_readonly("thickness", value_in<&Scene::thickness>(),
                             "m: cloth keeps this distance from colliders.")
      .def_property_readonly("dt", value_in<&Scene::dt>(), "s: the time step, exact in float32.")
      .def_property_readonly("steps", value_in<&Scene::steps>(), "Steps of the whole duration.")
      .def_property_readonly(
          "duration", [](const SourcedScene& s) { return s.scene->duration(); }, "s: dt * steps.")
      .def_property_readonly(
          "digest", [](const SourcedScene& s) { return digest(*s.scene); },
          "SHA-256 of its content: equal exactly when two scenes are the same simulation.");
}

}  // namespace taut::python
