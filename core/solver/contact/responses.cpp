#include "core/solver/contact/responses.hpp"

#include <set>
#include <utility>

#include "core/solver/contact/augmented_contacts.hpp"
#include "core/solver/contact/collide.hpp"
#include "core/solver/contact/face_contact.hpp"
#include "core/solver/contact/octree.hpp"
#include "core/solver/contact/quick_fixes.hpp"
#include "core/solver/contact/self_collision.hpp"

namespace taut {

namespace {

template <class Real>
void add_response(const Collider& collider, const Scene& scene, const Layout& layout,
                  const ContactSettings& settings, const Pass<Real>* solver, ThreadPool& pool,
                  ContactPasses<Real>& passes) {
  const auto project = [&](bool continuous) {
    return make_collide<Real>(collider, scene, layout, continuous, settings.simd, pool);
  };
  auto& swept = solver ? passes.after : passes.sweep;
  switch (settings.response) {
    case Response::continuous:
    case Response::discrete:
      if (!solver || !solver->leaves_colliders())
        swept.push_back(project(settings.response == Response::continuous));
      break;
    case Response::before:
      passes.before.push_back(project(false));
      break;
    case Response::after:
      passes.after.push_back(project(false));
      break;
    case Response::freeze:
      passes.sweep.push_back(make_freeze<Real>(collider, scene, settings.simd, pool));
      break;
    case Response::halt:
      passes.before.push_back(make_halt<Real>(collider, scene, settings.simd, pool));
      break;
  }
}

/// Faces and edges to be kept out of the collider. A face keeps its own sides out of the closed
/// forms; at a body of triangles, and in a solve, it leaves them to the edges.
std::vector<Triangle> pieces_of(const Scene& scene, const Collider& collider,
                                const ContactSettings& settings, bool in_solve) {
  if (!settings.edges || std::holds_alternative<Plane>(collider.shape)) return {};
  std::set<std::pair<int, int>> edges;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && link.rest > kSeamRest)
      edges.insert(std::minmax(link.a, link.b));
  const bool faces_have_sides =
      settings.faces && !in_solve && !std::holds_alternative<MeshBody>(collider.shape);
  for (const Triangle& face : scene.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto side = std::minmax(face[k], face[(k + 1) % 3]);
      if (faces_have_sides)
        edges.erase(side);
      else
        edges.insert(side);
    }
  std::vector<Triangle> pieces;
  if (settings.faces) pieces = scene.mesh.triangles;
  for (const auto& [a, b] : edges) pieces.push_back({a, b, b});
  return pieces;
}

/// Whether the solver moves all vertices in one solution; null: it has no target.
template <class Real>
bool solves_at_once(Pass<Real>* solver) {
  if (!solver) return false;
  const TouchingPieces* pieces = solver->touching_pieces();
  return solver->leaves_colliders() || (pieces && pieces->solved);
}

}  // namespace

template <class Real>
ContactPasses<Real> make_contact(const Scene& scene, const Layout& layout,
                                 const ContactSettings& settings, Pass<Real>* solver,
                                 ThreadPool& pool) {
  ContactPasses<Real> passes;
  if (scene.self_collision && settings.self == SelfCollisionMethod::grid)
    passes.sweep.push_back(make_self_collision(scene, settings.simd, solver, pool));
  if (scene.self_collision && settings.self == SelfCollisionMethod::octree)
    passes.sweep.push_back(make_octree<Real>(scene));
  const bool in_solve = solver && solver->touching_pieces();
  for (const Collider& collider : scene.colliders)
    if (auto pieces = pieces_of(scene, collider, settings, in_solve); !pieces.empty()) {
      // The iterates of a solve are no path: only where it ends can an edge have passed through.
      // Sweeps over vertices, and a solve at a body that deforms, lose threads without the test.
      const bool continuous = settings.response == Response::continuous;
      const bool at_end = continuous && !collider.frames && solves_at_once(solver);
      if (at_end)
        passes.after.push_back(
            make_face_contact<Real>(collider, scene.thickness, true, pieces, nullptr, true));
      passes.sweep.push_back(make_face_contact(collider, scene.thickness, continuous && !at_end,
                                               std::move(pieces), solver));
    }
  for (const Collider& collider : scene.colliders)
    add_response(collider, scene, layout, settings, solver, pool, passes);
  return passes;
}

template ContactPasses<float> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                           Pass<float>*, ThreadPool&);
template ContactPasses<double> make_contact(const Scene&, const Layout&, const ContactSettings&,
                                            Pass<double>*, ThreadPool&);

}  // namespace taut
