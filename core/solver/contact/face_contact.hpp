#pragma once

#include <memory>
#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Contact of these faces and edges (is_edge()) with a collider that is neither a plane nor a thin
/// body. solver: null, or the pass of the links that includes pieces in its solve. only_passed:
/// moves only edges that have passed through something.
template <class Real>
std::unique_ptr<Pass<Real>> make_face_contact(const Collider&, double thickness, bool continuous,
                                              std::vector<Triangle> pieces, Pass<Real>* solver,
                                              bool only_passed = false);

}  // namespace taut
