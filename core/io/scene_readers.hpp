#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/io/section.hpp"
#include "core/model/scene.hpp"

// What scene_io.cpp reads a scene with, part by part.

namespace taut {

/// Largest coordinate, size or displacement that a scene may hold [m].
inline constexpr double kFar = 1e6;

/// Reads [cloth]: mesh, links, start, pins and thickness of the scene; a mesh file is relative to
/// `folder`. Reports what is wrong; false if there is no mesh to go on with.
bool read_cloth(Section&, const std::filesystem::path& folder, const LinkChoice&, Scene&);

/// The vertices that a value names: a vertex number, a pair [i, j], the name of an edge or corner
/// of a grid ("top", "bottom-left"), a box {min, max} around rest positions, or an array of these.
/// Sorted, unique. Reports what names none; `key` is for the messages.
std::vector<int> read_vertices(Section&, const std::string& key, const Mesh&);

/// Reads 'rotation': { axis = [0, 0, 1], angle = 45 } with the angle in degrees, or a quaternion
/// [w, x, y, z] of any length but zero. Absent: the identity.
Eigen::Quaterniond read_rotation(Section&);

/// Reads every [[collider]].
void read_colliders(Section& root, Scene&);

/// Reads every [[pin_motion]]. Without a mesh (`built` false) only the motions are judged.
void read_pin_motions(Section& root, bool built, Scene&);

}  // namespace taut
