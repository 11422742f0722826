#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Reads a scene file (TOML; every key is described in experiments/scenes/README.md).
/// `overrides` are TOML assignments with dotted keys that replace values of the file before it is
/// judged, such as "cloth.grid=[16, 16]" or "time.dt=\"1/120\"". Throws InputError with every
/// diagnostic at once: unreadable or malformed file, unknown, duplicate or missing keys, wrong
/// types, non-finite or out-of-range numbers, pins outside the cloth. `remarks`, if given, gets
/// what was skipped of its mesh, a sentence.
Scene load_scene(const std::filesystem::path&, const std::vector<std::string>& overrides = {},
                 std::vector<std::string>* remarks = nullptr);

/// The same for text that is already in memory; `file` names it in messages, and a mesh is looked
/// for beside it.
Scene parse_scene(const std::filesystem::path& file, const std::string& text,
                  const std::vector<std::string>& overrides = {});

/// A number or a fraction such as "1/64"; throws InputError. Used for dt on the command line too.
double parse_number(const std::string&);

}  // namespace taut
