#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/scene_setting.hpp"

namespace taut {

/// Reads a scene file (TOML; every key is described in experiments/scenes/README.md). The settings
/// replace values of the file before it is checked. Throws InputError with all diagnostics at once:
/// unreadable or malformed file, unknown, duplicate or missing keys, wrong types, non-finite or
/// out-of-range numbers, pins outside the cloth. `remarks`, if given, receives a sentence about
/// skipped lines of its mesh.
Scene load_scene(const std::filesystem::path&, const SceneSettings& settings = {},
                 std::vector<std::string>* remarks = nullptr);

/// load_scene() for text in memory. `file` is for messages; a mesh is searched for beside it.
Scene parse_scene(const std::filesystem::path& file, const std::string& text,
                  const SceneSettings& settings = {});

/// Value of a number or a fraction such as "1/64"; throws InputError. Also used for dt on the
/// command line.
double parse_number(const std::string&);

}  // namespace taut
