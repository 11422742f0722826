#pragma once

#include "core/model/solver.hpp"

namespace taut {

/// A solver that can report the scene that it holds, read from the engine's own objects.
class HoldsScene {
 public:
  virtual ~HoldsScene() = default;
  /// Right after load(state): the scene that the solver was built from, with scene.start = state,
  /// up to rounding to the engine's scalar type. bullet_ref/README.md lists what an engine has no
  /// place for.
  virtual Scene read_back() const = 0;
};

/// The scene inside one of Bullet's solvers. Throws std::bad_cast for any other solver.
inline Scene read_back(const Solver& solver) {
  return dynamic_cast<const HoldsScene&>(solver).read_back();
}

}  // namespace taut
