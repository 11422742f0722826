// iteration/SIDE/SOLVER: cost of one iteration per vertex of each solver on a square sheet with
// structural and shear links, measured alternately with a sweep of Jakobsen's in float.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/solver/simd/kernels.hpp"
#include "tests/bench/bench.hpp"

namespace taut::bench {
namespace {

constexpr int kSteps = 4;

Scene net(int side) {
  Scene scene;
  scene.mesh = make_sheet({.nu = side, .nv = side, .width = 1, .height = 1, .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = false});
  scene.pins = {0, side - 1};
  scene.dt = 1.0 / 64;
  return scene;
}

/// Parameter `by` that sets the number of repetitions, and two values of it.
struct Repeated {
  std::string solver, by;
  int few = 2, many = 18;
  std::string with(int times) const { return solver + ',' + by + '=' + std::to_string(times); }
};

/// Cost per iteration and vertex, from the difference between steps with many and with few
/// iterations.
class Iterations {
 public:
  Iterations(const Scene& scene, const Repeated& what)
      : scene_(scene),
        few_(make(scene, what.with(what.few))),
        many_(make(scene, what.with(what.many))),
        share_(1.0 / (what.many - what.few) / static_cast<double>(scene.start.x.size())) {}
  double seconds() const {
    return share_ * (time_of(*many_, scene_.start, kSteps, scene_.dt) -
                     time_of(*few_, scene_.start, kSteps, scene_.dt));
  }

 private:
  const Scene& scene_;
  std::unique_ptr<Solver> few_, many_;
  double share_;
};

/// Counters: `iteration` [s], and `sweeps`, its ratio to a sweep of Jakobsen's.
void measure(benchmark::State& state, int side, const Repeated& what) {
  const Scene scene = net(side);
  const Iterations own(scene, what);
  const Iterations jakobsen(scene, {"jakobsen:order=coloured,substeps=1", "iterations"});
  double time = 0, sweep = 0;
  for (auto _ : state) {
    sweep += jakobsen.seconds();
    time += 2 * own.seconds();
    sweep += jakobsen.seconds();
  }
  state.counters["iteration"] = time / 2 / static_cast<double>(state.iterations());
  state.counters["sweeps"] = time / sweep;
}

/// Rows of a solver in both precisions if it has them, with one substep. Newton's iterations stop
/// at convergence, so that their number stays low.
std::vector<Repeated> rows_of(const SolverEntry& entry) {
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(entry.params, [&](const ParamSpec& p) { return p.name == name; });
  };
  Repeated row{std::string(entry.name) + ':', std::string(entry.accuracy.sweeps)};
  if (row.by.empty())
    row.by = entry.accuracy.substeps;
  else
    row.solver += std::string(entry.accuracy.substeps) + "=1";
  if (entry.name == "implicit") {
    row.few = 1;
    row.many = 4;
  }
  std::vector<Repeated> rows;
  for (const char* precision : {"float", "double"}) {
    Repeated& one = rows.emplace_back(row);
    if (has("precision"))
      one.solver += std::string(one.solver.back() == ':' ? "" : ",") + "precision=" + precision;
  }
  if (!has("precision")) rows.pop_back();
  // the float version is another program
  if (entry.name.starts_with("bullet")) rows.erase(rows.begin());
  return rows;
}

}  // namespace

void register_iterations() {
  for (const int side : {32, 128})
    for (const SolverEntry* entry : solvers())
      for (const Repeated& row : rows_of(*entry))
        benchmark::RegisterBenchmark(
            ("iteration/" + std::to_string(side) + '/' + row.solver).c_str(),
            [=](benchmark::State& state) { measure(state, side, row); })
            ->Unit(benchmark::kMicrosecond);
}

}  // namespace taut::bench
