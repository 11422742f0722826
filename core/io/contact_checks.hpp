#pragma once

#include "core/io/section.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// What a scene says about how it starts and how fat it is.
struct ContactWishes {
  bool resolve = false;  ///< cloth.start_inside = "resolve": move the cloth out instead of refusing
  bool overlap = false;  ///< self_collision.overlap: particles may overlap at rest
};

/// Reports what makes contact meaningless in an otherwise complete scene: a cloth that starts
/// inside a collider (moved to its surface, at the scene's thickness, if that is wished) or through
/// itself, a thickness or a particle larger than the spacing, a collider whose path jumps.
void check_contact(Section& root, const ContactWishes&, Scene&);

}  // namespace taut
