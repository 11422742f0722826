#pragma once

#include <memory>
#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// What happens to a particle inside a collider.
enum class Response {
  continuous,  ///< out in every sweep, also what has passed through the collider in this step
  discrete,    ///< out in every sweep
  before,      ///< out once a substep, before the sweeps
  after,       ///< out once a substep, after the sweeps
  freeze,      ///< on to the surface, where it stays for ever
  halt         ///< on to the surface; its next integration is left out
};
enum class SelfCollisionMethod { grid, octree, off };

struct ContactSettings {
  Response response = Response::continuous;
  bool edges = false, faces = false;  ///< are kept out, too, not only vertices
  SelfCollisionMethod self = SelfCollisionMethod::grid;
  Simd simd = Simd::scalar;
};

/// The passes of contact, by when they act. All empty if the scene has nothing to touch.
template <class Real>
struct ContactPasses {
  using List = std::vector<std::unique_ptr<Pass<Real>>>;
  List before;  ///< once a substep, before the sweeps
  List sweep;   ///< in every sweep, after the links
  List after;   ///< once a substep, after the sweeps
};

/// solver: that of the links if it has Contacts, else null. Vertices are then put out of colliders
/// once, at the end. Self-collision moves its target, too, and so do faces and edges unless it
/// takes them into its solve.
template <class Real>
ContactPasses<Real> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                 Pass<Real>* solver, ThreadPool&);

}  // namespace taut
