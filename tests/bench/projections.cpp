// projection/SIDE/SOLVER: cost of one projection on a square sheet with structural, shear and bend
// links, and its lower bounds: projections of particles that stay in registers, and particles that
// are loaded and stored with an addition in place of the projection.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <functional>

#include "core/reference/textbook.hpp"
#include "core/solver/layout/colour_batches.hpp"
#include "core/solver/simd/kernels.hpp"
#include "tests/bench/bench.hpp"

namespace taut::bench {
namespace {

constexpr int kFew = 2, kMany = 18, kSteps = 8;

Scene sheet(int side) {
  Scene scene;
  scene.mesh = make_sheet({.nu = side, .nv = side, .width = 1, .height = 1, .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true});
  scene.pins = {0, side - 1};
  scene.dt = 1.0 / 64;
  return scene;
}

/// Counters: `projection` [s], the difference between steps with many and with few sweeps per
/// projection; `step` [s], a step without sweeps.
void of_solver(benchmark::State& state, int side, const std::string& text) {
  const Scene scene = sheet(side);
  std::unique_ptr<Solver> solvers[3];
  const int sweeps[] = {0, kFew, kMany};
  for (int i = 0; i < 3; ++i)
    solvers[i] = make(scene, text + ",iterations=" + std::to_string(sweeps[i]));
  const auto clock = text.find("threads=") == text.npos ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  double time[3] = {};
  for (auto _ : state)
    for (const int i : {0, 1, 2, 2, 1, 0})
      time[i] += time_of(*solvers[i], scene.start, kSteps, scene.dt, clock) / 2;
  const double rounds = static_cast<double>(state.iterations());
  const auto projections =
      static_cast<double>(projections_per_step(*solvers[2]) - projections_per_step(*solvers[1]));
  state.counters["projection"] = (time[2] - time[1]) / rounds / projections;
  state.counters["step"] = time[0] / rounds;
}

template <class Real>
void textbook(benchmark::State& state, int side) {
  const Scene scene = sheet(side);
  Textbook<Real> solver(scene, 1);
  for (auto _ : state) solver.sweep();
  state.counters["projection"] = benchmark::Counter(
      static_cast<double>(solver.constraints()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Real>
void in_registers(benchmark::State& state) {
  int projections = 0;
  Real keep = 1;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        keep = kernels<Real>(widest()).in_registers(1 + 0 * keep, 1000, projections));
  state.counters["projection"] = benchmark::Counter(
      projections, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Colour batches in their order.
template <class Real>
void load_and_store(benchmark::State& state, int side) {
  const Scene scene = sheet(side);
  const Layout layout = Layout::packed(scene.start.x.size(), tile_ranks(scene.mesh));
  const ColourBatches<Real> batches(colour(scene.links, scene.mesh), inverse_masses(scene), 1,
                                    layout);
  std::vector<Real> x(layout.length());
  for (auto _ : state)
    for (std::size_t phase = 0; phase < batches.phases(); ++phase)
      for (std::size_t tile = 0; tile < batches.parts(phase); ++tile)
        for (const BatchRun<Real>& run : batches.runs(phase, tile))
          kernels<Real>(widest()).load_and_store(run, x.data());
  state.counters["projection"] = benchmark::Counter(
      static_cast<double>(batches.order(layout).size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void add(int side, const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(("projection/" + std::to_string(side) + "/" + name).c_str(),
                               [run](benchmark::State& state) { run(state); })
      ->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_projections() {
  for (const int side : {32, 128}) {
    add(side, "textbook float", [=](auto& state) { textbook<float>(state, side); });
    add(side, "textbook double", [=](auto& state) { textbook<double>(state, side); });
    for (const std::string text :
         {"jakobsen:layout=interleaved", "jakobsen:layout=interleaved,precision=double",
          "jakobsen:layout=interleaved,projection=exact", "jakobsen:layout=interleaved,simd=avx2",
          "jakobsen:layout=batches", "jakobsen:layout=batches,precision=double",
          "jakobsen:layout=batches,simd=scalar", "jakobsen:layout=interleaved,threads=2",
          "jakobsen:layout=batches,threads=2", "bullet:precision=double"})
      if (text.find("avx2") == text.npos || widest() == Simd::avx512)
        add(side, text, [=](auto& state) { of_solver(state, side, text + ",substeps=1"); });
    add(side, "loads and stores of batches",
        [=](auto& state) { load_and_store<float>(state, side); });
  }
  add(0, "in registers float", in_registers<float>);
  add(0, "in registers double", in_registers<double>);
}

}  // namespace taut::bench
