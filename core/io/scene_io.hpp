#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/scene_setting.hpp"

namespace taut {

/// Reads a scene file (TOML; every key is described in experiments/scenes/README.md).
/// The settings replace values of the file before it is judged. Throws InputError with every
/// diagnostic at once: unreadable or malformed file, unknown, duplicate or missing keys, wrong
/// types, non-finite or out-of-range numbers, pins outside the cloth. `remarks`, if given, gets
/// what was skipped of its mesh, a sentence.
Scene load_scene(const std::filesystem::path&, const SceneSettings& settings = {},
                 std::vector<std::string>* remarks = nullptr);

/// The same for text that is already in memory; `file` names it in messages, and a mesh is looked
/// for beside it.
Scene parse_scene(const std::filesystem::path& file, const std::string& text,
                  const SceneSettings& settings = {});

/// A number or a fraction such as "1/64"; throws InputError. Used for dt on the command line too.
double parse_number(const std::string&);

}  // namespace taut
