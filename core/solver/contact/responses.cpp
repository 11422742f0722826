#include "core/solver/contact/responses.hpp"

#include "core/solver/jakobsen_params.hpp"
#include "core/solver/passes/face_contact.hpp"
#include "core/solver/passes/octree.hpp"
#include "core/solver/passes/report_fixes.hpp"
#include "core/solver/passes/self_collide.hpp"

namespace taut {

namespace {

template <class Real>
void add_response(const Collider& collider, const Scene& scene, const Params& params,
                  ContactPasses<Real>& passes) {
  const Simd simd = simd_of(params);
  const auto project = [&](bool swept) {
    return std::make_unique<CollidePass<Real>>(collider, scene, swept, simd);
  };
  if (params.is("contact", "swept"))
    passes.sweep.push_back(project(true));
  else if (params.is("contact", "sweep"))
    passes.sweep.push_back(project(false));
  else if (params.is("contact", "before"))
    passes.before.push_back(project(false));
  else if (params.is("contact", "after"))
    passes.after.push_back(project(false));
  else if (params.is("contact", "freeze"))
    passes.sweep.push_back(std::make_unique<FreezePass<Real>>(collider, scene, simd));
  else
    passes.before.push_back(std::make_unique<HaltPass<Real>>(collider, scene, simd));
}

}  // namespace

template <class Real>
ContactPasses<Real> make_contact(const Scene& scene, const Params& params) {
  ContactPasses<Real> passes;
  if (scene.self_collision && params.is("self", "grid"))
    passes.sweep.push_back(std::make_unique<SelfCollidePass<Real>>(scene, simd_of(params)));
  if (scene.self_collision && params.is("self", "octree"))
    passes.sweep.push_back(std::make_unique<OctreePass<Real>>(scene));
  for (const Collider& collider : scene.colliders)
    if (params.is("faces", "on") && !std::holds_alternative<Plane>(collider.shape) &&
        !scene.mesh.triangles.empty())
      passes.sweep.push_back(
          std::make_unique<FaceContactPass<Real>>(collider, scene.thickness, scene.mesh.triangles));
  for (const Collider& collider : scene.colliders) add_response(collider, scene, params, passes);
  return passes;
}

template ContactPasses<float> make_contact(const Scene&, const Params&);
template ContactPasses<double> make_contact(const Scene&, const Params&);

ResolvedSettings contact_settings(const Scene& scene, const Params& params) {
  ResolvedSettings lines;
  if (!scene.colliders.empty())
    lines = {{"contact response", std::string(params.choice("contact"))},
             {"friction", "Coulomb: tangential correction at most mu times the depth"},
             {"contact distance", "the scene's thickness"},
             {"contact of faces", std::string(params.choice("faces"))}};
  if (scene.self_collision)
    lines.emplace_back("self-collision", std::string(params.choice("self")));
  return lines;
}

}  // namespace taut
