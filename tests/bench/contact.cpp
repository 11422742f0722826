// contact/SIDE/SCENE/SETTING: cost of contact in addition to the structural links of the same
// cloth, from a state in which the cloth lies on its obstacle.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <functional>

#include "core/io/scene_io.hpp"
#include "experiments/system/data.hpp"
#include "tests/bench/bench.hpp"

namespace taut::bench {
namespace {

constexpr int kSweeps[] = {2, 18};

struct Subject {
  std::string scene;
  int side = 0;
  double seconds = 0;  ///< time until the cloth lies
  std::string setting;
  int steps = 4;  ///< steps timed in a row from that state
};

/// Loads the scene with thickness and radius scaled to the spacing. With self-collision the time
/// step scales as well, so that a particle moves the same number of diameters per step.
Scene load(const Subject& s) {
  const double spacing = 0.8 / (s.side - 1);
  const std::string n = std::to_string(s.side);
  SceneSettings changes{"cloth.grid=[" + n + "," + n + "]",
                        "cloth.thickness=" + std::to_string(0.4 * spacing)};
  if (s.scene == "crumple")
    for (const std::string& change : {"self_collision.radius=" + std::to_string(0.48 * spacing),
                                      "time.dt=" + std::to_string(spacing / 6.4)})
      changes.push_back(change);
  return load_scene(find_scene(s.scene), changes);
}

std::string with_sweeps(int sweeps, const std::string& setting) {
  return "jakobsen:substeps=1,iterations=" + std::to_string(sweeps) + "," + setting;
}

State settled(const Scene& scene, double seconds) {
  const auto solver = make(scene, with_sweeps(scene.self_collision ? 8 : 24, "order=coloured"));
  time_of(*solver, scene.start, static_cast<int>(seconds / scene.dt), scene.dt);
  State state;
  solver->store(state);
  return state;
}

/// Counters [s per particle]: `sweep` over the structural links; contact `in_sweep`, and `in_step`
/// for the rest of the step. `touching`: share of particles in contact with a collider at the
/// start.
void run(benchmark::State& state, const Subject& s) {
  Scene scene = load(s);
  const State start = settled(scene, s.seconds);
  std::erase_if(scene.links, [](const Link& l) { return l.family != Family::structural; });
  Scene bare = scene;
  bare.colliders.clear();
  bare.self_collision.reset();
  std::unique_ptr<Solver> solvers[4];  // without and with contact, each with few and many sweeps
  for (std::size_t i = 0; i < 4; ++i)
    solvers[i] = make(i < 2 ? bare : scene, with_sweeps(kSweeps[i % 2], s.setting));
  double time[4] = {};
  for (auto _ : state)
    for (const int i : {0, 1, 2, 3, 3, 2, 1, 0})
      time[i] += time_of(*solvers[i], start, s.steps, scene.dt) / 2;
  const auto particles = static_cast<double>(start.x.size());
  const double unit = 1 / (static_cast<double>(state.iterations()) * particles);
  constexpr double kMore = kSweeps[1] - kSweeps[0];
  const double links = (time[1] - time[0]) / kMore, both = (time[3] - time[2]) / kMore;
  state.counters["sweep"] = unit * links;
  state.counters["in_sweep"] = unit * (both - links);
  state.counters["in_step"] = unit * (time[2] - time[0] - kSweeps[0] * (both - links));
  const auto touches = [&](const Vec3& x) {
    return std::ranges::any_of(scene.colliders, [&](const Collider& c) {
      return surface(c.shape, x).distance < 1.1 * scene.thickness;
    });
  };
  state.counters["touching"] =
      static_cast<double>(std::ranges::count_if(start.x, touches)) / particles;
}

void add(const Subject& s) {
  std::string name = "contact/" + std::to_string(s.side) + "/" + s.scene + "/" + s.setting;
  if (s.scene == "crumple") {
    name += s.seconds < 0.5 ? "/begins to fold" : "/all of it folds";
    name += "/" + std::to_string(s.steps) + " steps";
  }
  benchmark::RegisterBenchmark(name.c_str(), [s](benchmark::State& state) {
    run(state, s);
  })->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_contact() {
  for (const int side : {64, 128}) {
    for (const char* scene : {"plane", "ball", "box"})
      for (const char* response : {"continuous", "discrete", "after"})
        for (const char* order : {"mesh", "coloured"})
          add({scene, side, 0.75, std::string("contact=") + response + ",order=" + order});
    for (const double seconds : {0.3, 0.6})
      for (const int steps : {1, 8})  // the first step after loading has to search for pairs
        for (const char* order : {"mesh", "coloured"})
          add({"crumple", side, seconds, std::string("self=grid,order=") + order, steps});
  }
}

}  // namespace taut::bench
