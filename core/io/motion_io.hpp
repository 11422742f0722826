#pragma once

#include "core/io/section.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// Reads 'rotation': { axis = [0, 0, 1], angle = 45 } with the angle in degrees, or a quaternion
/// [w, x, y, z] of any length but zero. Absent: the identity.
Eigen::Quaterniond read_rotation(Section&);

/// Reads every [[collider]].
void read_colliders(Section& root, Scene&);

/// Reads every [[pin_motion]]. Without a mesh (`built` false) only the motions are judged.
void read_pin_motions(Section& root, bool built, Scene&);

}  // namespace taut
