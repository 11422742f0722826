#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/io/document.hpp"
#include "core/io/fabrics.hpp"
#include "core/model/scene.hpp"

// What scene_io.cpp and cloth_io.cpp read a scene with.

namespace taut {

/// Largest coordinate, size or displacement that a scene may hold [m].
inline constexpr double kFar = 1e6;

/// Reads [cloth]: mesh, links, start, pins and thickness of the scene; a mesh file is relative to
/// `folder`. A fabric's mass stands in the place of what [cloth] says. Reports what is wrong; false
/// if there is no mesh to go on with.
bool read_cloth(Section&, const std::filesystem::path& folder, const LinkChoice&, const Fabric*,
                Scene&);

/// The vertices that a value names: a vertex number, a pair [i, j], the name of an edge or corner
/// of a grid ("top", "bottom-left"), a box {min, max} or a ball {center, radius} around rest
/// positions, or an array of these.
/// Sorted, unique. Reports what names none; `key` is for the messages.
std::vector<int> read_vertices(Section&, const std::string& key, const Mesh&);

/// Reads 'rotation': { axis = [0, 0, 1], angle = 45 } with the angle in degrees, or a quaternion
/// [w, x, y, z] of any length but zero. Absent: the identity.
Eigen::Quaterniond read_rotation(Section&);

}  // namespace taut
