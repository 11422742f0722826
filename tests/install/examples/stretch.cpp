// stretch SCENE.toml [SOLVER]: steps a solver through a scene and prints the RMS strain of the
// links ten times.
#include <cmath>
#include <cstdio>
#include <taut/io/scene_io.hpp>
#include <taut/model/index.hpp>
#include <taut/model/input_error.hpp>
#include <taut/model/solver.hpp>
#include <taut/model/text.hpp>

int main(int argc, char** argv) try {
  if (argc < 2) throw taut::InputError("usage: stretch SCENE.toml [SOLVER]");
  const taut::Scene scene = taut::load_scene(argv[1]);
  const taut::SolverChoice choice = taut::parse_solver(argc > 2 ? argv[2] : "jakobsen");
  for (const std::string& why : choice.entry->unsupported(scene, choice.params))
    throw taut::InputError(why);
  const auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  taut::State state;
  for (int step = 1; step <= scene.steps; ++step) {
    solver->step((step - 1) * scene.dt, scene.dt);
    if (step % ((scene.steps + 9) / 10) != 0 && step != scene.steps) continue;
    solver->store(state);
    double sum = 0;
    for (const taut::Link& link : scene.links) {
      const taut::Vec3 along = state.x[taut::to_index(link.b)] - state.x[taut::to_index(link.a)];
      sum += std::pow(along.norm() / link.rest - 1, 2);
    }
    const double strain = std::sqrt(sum / static_cast<double>(scene.links.size()));
    std::printf("%s s: strain %s\n", taut::shortest(step * scene.dt).c_str(),
                taut::shortest(strain).c_str());
  }
} catch (const taut::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
