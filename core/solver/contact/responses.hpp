#pragma once

#include <memory>
#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// How contact treats a particle inside a collider.
enum class Response {
  /// Pushed out in every sweep, also if it has passed through the collider in this step.
  continuous,
  discrete,  ///< pushed out in every sweep
  before,    ///< pushed out once a substep, before the sweeps
  after,     ///< pushed out once a substep, after the sweeps
  freeze,    ///< put on the surface, where it stays for ever
  halt       ///< put on the surface; its next integration is left out
};
enum class SelfCollisionMethod { grid, octree, off };

struct ContactSettings {
  Response response = Response::continuous;
  bool edges = false, faces = false;  ///< whether these are kept out, and not only vertices
  SelfCollisionMethod self = SelfCollisionMethod::grid;
  Simd simd = Simd::scalar;
};

/// The passes of contact, by when they act. All are empty if the scene has nothing to touch.
template <class Real>
struct ContactPasses {
  using List = std::vector<std::unique_ptr<Pass<Real>>>;
  List before;  ///< once a substep, before the sweeps
  List sweep;   ///< in every sweep, after the links
  List after;   ///< once a substep, after the sweeps
};

/// Makes the passes of contact. solver: the pass of the links if it has Contacts, otherwise null.
/// With a solver, vertices are pushed out of colliders only once, at the end; self-collision also
/// moves its target, and so do faces and edges unless it includes them in its solve.
template <class Real>
ContactPasses<Real> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                 Pass<Real>* solver, ThreadPool&);

}  // namespace taut
