#include "core/reference/exact_path.hpp"

#include "core/reference/implicit_step.hpp"

namespace taut::reference {

bool has_exact_path(const Scene& scene) {
  return !scene.bending && !scene.self_collision && !scene.wind && scene.colliders.empty() &&
         scene.releases.empty();
}

std::vector<std::vector<Vec3>> exact_path(const Scene& scene, const std::vector<int>& steps) {
  if (!has_exact_path(scene)) return {};
  std::vector<std::vector<Vec3>> places;
  State state = scene.start;
  int done = 0;
  for (const int step : steps) {
    for (; done < step; ++done) {
      std::vector<Vec3> ahead = state.x;
      for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] += scene.dt * state.v[i];
      const ImplicitStep exact(scene, state, done * scene.dt, scene.stiffness);
      ImplicitStep::Minimum minimum = exact.minimum(ahead);
      if (!minimum.problem.empty()) return {};
      for (std::size_t i = 0; i < state.x.size(); ++i)
        state.v[i] = (minimum.x[i] - state.x[i]) / scene.dt;
      state.x = std::move(minimum.x);
    }
    places.push_back(state.x);
  }
  return places;
}

}  // namespace taut::reference
