#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "experiments/case/record.hpp"
#include "experiments/python/values.hpp"

namespace taut::python {

/// A scene with the place that it came from, so that it can be read again with other settings.
struct SourcedScene {
  std::string source;               ///< as given: a name, a path; of a text its name
  std::filesystem::path file;       ///< of a text: how messages call it
  std::optional<std::string> text;  ///< else it is in the file
  SceneSettings settings;
  std::shared_ptr<const Scene> scene;

  Scene read(const SceneSettings& with) const;
  /// The same with these settings, too; one of a key that it has takes its place. Throws
  /// InputError.
  SourcedScene replaced(const SceneSettings& more) const;
  CaseSpec spec() const { return {source, settings, ""}; }
};

/// Of a shipped name, a path, or TOML text that messages call `name`. Throws InputError.
SourcedScene scene_from(py::handle source, const py::dict& settings, const std::string& name);

/// Any of what a function takes as a scene, with the time step and the duration that were said.
SourcedScene timed_scene(py::handle given, const py::object& dt, const py::object& duration);

/// taut.Scene.
void define_scene(py::module_&);

}  // namespace taut::python
