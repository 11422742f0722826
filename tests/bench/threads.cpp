// threads/SIDE/SCENE: speed of two threads on one sheet, compared with two independent sheets of
// one thread each, in multiples of a single thread's speed (wall time).
#include <benchmark/benchmark.h>

#include <thread>

#include "core/io/scene_io.hpp"
#include "experiments/system/data.hpp"
#include "tests/bench/bench.hpp"

namespace taut::bench {
namespace {

constexpr int kSteps = 4;

/// Loads the scene; with self-collision, radius and thickness scale with the spacing.
Scene load(const std::string& name, int side) {
  const Scene shipped = load_scene(find_scene(name));
  const std::string n = std::to_string(side);
  const double finer = (shipped.mesh.grid->nu - 1.0) / (side - 1);
  SceneSettings changes{"cloth.grid=[" + n + "," + n + "]"};
  if (shipped.self_collision)
    for (const auto& [key, value] :
         {std::pair("self_collision.radius", shipped.self_collision->radius),
          std::pair("cloth.thickness", shipped.thickness)})
      changes.push_back(std::string(key) + "=" + std::to_string(value * finer));
  return load_scene(find_scene(name), changes);
}

/// Counters: `two_threads` and `unrelated`, in multiples of a single thread. The ratios share no
/// measured time: a slow single thread would otherwise flatter both.
void run(benchmark::State& state, const std::string& name, int side) {
  const Scene scene = load(name, side);
  const std::string setting = "jakobsen:iterations=1,substeps=15";
  const auto one = make(scene, setting), another = make(scene, setting),
             two = make(scene, setting + ",threads=2");
  State start;
  time_of(*one, scene.start, scene.steps / 2, scene.dt);
  one->store(start);
  const auto time = [&](Solver& solver) {
    return time_of(solver, start, kSteps, scene.dt, CLOCK_MONOTONIC);
  };
  double before = 0, shared = 0, after = 0, both = 0;
  for (auto _ : state) {
    before += time(*one);
    shared += time(*two);
    after += time(*one);
    const double begin = seconds_of(CLOCK_MONOTONIC);
    std::thread other([&] { time(*another); });
    time(*one);
    other.join();
    both += (seconds_of(CLOCK_MONOTONIC) - begin) / kSteps;
  }
  state.counters["two_threads"] = before / shared;
  state.counters["unrelated"] = 2 * after / both;
}

}  // namespace

void register_threads() {
  for (const std::string scene : {"hang", "flag", "plane", "ball", "box", "crumple"})
    benchmark::RegisterBenchmark(("threads/128/" + scene).c_str(),
                                 [scene](benchmark::State& state) { run(state, scene, 128); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

}  // namespace taut::bench
