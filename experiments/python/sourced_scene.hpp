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

/// A scene together with its source, so that it can be read again with other settings.
struct SourcedScene {
  std::string source;               ///< as given: a name or a path; for a text, its name
  std::filesystem::path file;       ///< for a text, its name in messages
  std::optional<std::string> text;  ///< if empty, the text is in the file
  SceneSettings settings;
  std::shared_ptr<const Scene> scene;

  Scene read(const SceneSettings& with) const;
  /// The scene with additional settings. A setting with the same key is replaced. Throws
  /// InputError.
  SourcedScene replaced(const SceneSettings& more) const;
  CaseSpec spec() const { return {source, settings, ""}; }
};

/// Reads a scene from a shipped name, a path, or TOML text that messages call `name`. Throws
/// InputError.
SourcedScene scene_from(py::handle source, const py::dict& settings, const std::string& name);

/// Anything that a function accepts as a scene, with the time step and duration applied if they are
/// given.
SourcedScene timed_scene(py::handle given, const py::object& dt, const py::object& duration);

/// Defines taut.Scene.
void define_scene(py::module_&);

}  // namespace taut::python
