#pragma once

#include <string>
#include <vector>

#include "core/model/solver.hpp"

namespace taut {

/// A solver that can say which scene it holds, read from the engine's own objects.
class HoldsScene {
 public:
  virtual ~HoldsScene() = default;
  /// Right after load(state), the scene it was built from with scene.start = state, up to rounding
  /// to the engine's scalar type; what an engine has no place for is listed in
  /// bullet_ref/README.md.
  virtual Scene read_back() const = 0;
};

/// The scene inside one of Bullet's solvers. Throws std::bad_cast for a solver that is not one.
Scene read_back(const Solver&);

/// Where `held` is not the simulation that `asked` describes, a sentence each; empty: the same.
/// Numbers agree if they differ by no more than `tolerance` relative to the larger of 1 and their
/// size. Not compared, for Bullet has no place for them: the labels, the mesh's grid, and the
/// masses of pinned vertices.
std::vector<std::string> differences(const Scene& asked, const Scene& held, double tolerance);

}  // namespace taut
