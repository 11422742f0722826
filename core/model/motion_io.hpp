#pragma once

#include "core/model/scene.hpp"
#include "core/model/section.hpp"

namespace taut {

/// Reads every [[collider]].
void read_colliders(Section& root, Scene&);

/// Reads every [[pin_motion]]. Without a mesh (`built` false) only the motions are judged.
void read_pin_motions(Section& root, bool built, Scene&);

}  // namespace taut
