#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/io/document.hpp"
#include "core/io/fabrics.hpp"
#include "core/model/scene_keys.hpp"
#include "core/model/triangle_mesh.hpp"

// Parts of load_scene() that scene_io.cpp, cloth_io.cpp, body_io.cpp and scene_checks.cpp share.

namespace taut {

/// The allowed numbers of a key. Precondition: the key exists.
inline const Range& allowed_at(std::string_view path) { return find_scene_key(path)->range; }

/// Reads a value of the key's kind. If it is absent or wrong, the value keeps its content.
void read_value(Section&, const SceneKey&, double&);
void read_value(Section&, const SceneKey&, Vec3&);
void read_value(Section&, const SceneKey&, bool&);
/// Returns the index of the choice.
int read_choice(Section&, const SceneKey&, int fallback);
template <class Enumeration>
requires std::is_enum_v<Enumeration>
void read_value(Section& section, const SceneKey& key, Enumeration& value) {
  value = static_cast<Enumeration>(read_choice(section, key, static_cast<int>(value)));
}

/// Reads every key of the section that is a member of the part.
template <class Part>
void read_keys(Section& section, Part& part) {
  each_key(section.scene_section(), part,
           [&](const SceneKey& key, auto& value, const auto&) { read_value(section, key, value); });
}

/// Reads [cloth]: mesh, links, start, pins and thickness of the scene. A mesh file is relative to
/// `folder`. A fabric's mass replaces what [cloth] says. Reports errors; returns false if there is
/// no mesh to go on with.
bool read_cloth(Section&, const std::filesystem::path& folder, const Fabric*, const FileKeys&,
                Scene&);

/// Reads the files of a [[collider]] that is a mesh, relative to `folder`: 'file' with 'scale', and
/// 'frames' with 'fps', whose first frame is then its shape. If it is not a valid body, its mesh is
/// null and errors are reported with file and line.
void read_body(Section&, const std::filesystem::path& folder, Collider&);

/// The vertices that a value names: a vertex number, a pair [i, j], the name of an edge or corner
/// of a grid ("top", "bottom-left"), a box {min, max} or a ball {center, radius} around rest
/// positions, or an array of these. Sorted, unique. Reports items that name no vertex; `key` is for
/// messages.
std::vector<int> read_vertices(Section&, const std::string& key, const Mesh&);

/// Reads every [[seam]] and puts its links after the cloth's structural ones.
void read_seams(Section& root, Scene&);

/// Reports errors that concern more than a single key, in a scene with a mesh.
void check_whole(Section& root, const Scene&);

/// Reports what makes contact meaningless in an otherwise complete scene: a cloth that starts
/// inside a collider (moved to its surface, at the scene's thickness, if the scene says so) or
/// crosses itself, a thickness or a particle larger than the spacing, a collider whose path jumps.
void check_contact(Section& root, const FileKeys&, Scene&);

/// Reads 'rotation': { axis = [0, 0, 1], angle = 45 } with the angle in degrees, or a quaternion
/// [w, x, y, z] of any length but zero. Absent: the identity.
Eigen::Quaterniond read_rotation(Section&);

}  // namespace taut
