#include "experiments/timing/bench/kernels.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "core/model/solver.hpp"
#include "core/reference/textbook.hpp"
#include "core/solver/simd/kernels.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

namespace {

constexpr int kNoSweeps = 0, kFewSweeps = 2, kManySweeps = 18;
constexpr int kParts = 5;  ///< of a sample
constexpr int kRoundsOfCores =
    10;  ///< in the place of each round: they differ more than kernels do

/// A step of so many sweeps: none, few or many.
using Work = std::function<void(int sweeps)>;

struct Kernel {
  KernelRow row;
  Work work;
  std::function<void()> reload = [] {};  ///< the step without sweeps starts at rest again
  double projections = 0;                ///< between few and many
  double structural = 0;                 ///< projections of a sweep over the structural links alone
  int repeats = 1;                       ///< in one part of a sample
  double fastest_few = 1, fastest_many = 1;  ///< s, of all parts so far
};

Scene sheet(int side) {
  Scene scene;
  scene.mesh = make_sheet({.nu = side, .nv = side, .width = 1, .height = 1, .mass = 0.2});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true});
  scene.pins = {0, side - 1};
  scene.dt = 1.0 / 64;
  scene.steps = 1;
  return scene;
}

template <class Real>
Kernel textbook(const Scene& scene, const std::string& name) {
  const auto kernel = std::make_shared<Textbook<Real>>(scene, 1);
  // 3 differences, 5 for the square, root, 2 for w1 + w2 and its product, 2 for diff, 2 + 12 to
  // move
  return {.row = {.name = name, .flops = 27, .bytes = 15 * static_cast<int>(sizeof(Real)) + 8},
          .work =
              [kernel](int sweeps) {
                for (int k = 0; k < sweeps; ++k) kernel->sweep();
              },
          .projections = static_cast<double>(kernel->constraints()) * (kManySweeps - kFewSweeps)};
}

/// A solver; `name` is its text without iterations.
Kernel of_solver(const Scene& scene, const std::string& name, int flops, int bytes) {
  const auto make = [&](int iterations) {
    const SolverChoice choice =
        parse_solver(with(name, "iterations=" + std::to_string(iterations)));
    std::shared_ptr<Solver> solver = choice.entry->make(scene, choice.params);
    solver->load(scene.start);
    return solver;
  };
  const auto none = make(kNoSweeps), few = make(kFewSweeps), many = make(kManySweeps);
  const double h = scene.dt;
  const State start = scene.start;
  const auto projections = [](const Solver& s) {
    return static_cast<double>(projections_per_step(s));
  };
  const bool threads = name.find("threads=2") != std::string::npos;
  return {.row = {.name = name, .threads = threads ? 2 : 1, .flops = flops, .bytes = bytes},
          .work =
              [=](int sweeps) {
                (sweeps == kManySweeps ? many : sweeps == kFewSweeps ? few : none)->step(0, h);
              },
          .reload = [=] { none->load(start); },
          .projections = projections(*many) - projections(*few)};
}

/// Additions, multiplications, division (and root) of project_distance between equal masses.
constexpr int kSqrtFree = 21, kExact = 22;

std::vector<Kernel> kernels_of(const Scene& scene, bool bullet) {
  // Bullet's float and double builds are different programs; this one has one of them.
  const auto linked = [](const char* precision) {
    const SolverChoice choice = parse_solver(std::string("bullet:precision=") + precision);
    try {
      choice.entry->make(sheet(2), choice.params);
    } catch (const std::exception&) {
      return false;
    }
    return true;
  };
  std::vector<Kernel> all;
  all.push_back(textbook<float>(scene, "textbook, float"));
  all.push_back(textbook<double>(scene, "textbook, double"));
  const auto add = [&](const std::string& name, const std::string& layout, bool exact, bool single,
                       int threads) {
    const int word = single ? 4 : 8, flops = exact ? kExact : kSqrtFree;
    const int points = layout == "interleaved" ? 12 : 16;  // numbers read and written
    const int list = layout == "interleaved" ? 0 : 8 + word;
    all.push_back(of_solver(scene,
                            "jakobsen:substeps=1,layout=" + layout +
                                ",projection=" + (exact ? "exact" : "sqrt-free") +
                                ",precision=" + (single ? "float" : "double") +
                                (threads > 1 ? ",threads=" + std::to_string(threads) : "") + name,
                            flops, points * word + list));
  };
  for (const bool single : {true, false})
    for (const bool exact : {true, false}) {
      add(",simd=scalar", "batches", exact, single, 1);
      add("", "batches", exact, single, 1);
      if (scene.mesh.grid->nu >= 17) add("", "interleaved", exact, single, 1);
    }
  // Half as wide as the widest: what the width is worth.
  if (widest() == Simd::avx512 && scene.mesh.grid->nu >= 17)
    add(",simd=avx2", "interleaved", false, true, 1);
  add("", "batches", false, true, 2);
  if (scene.mesh.grid->nu >= 17) add("", "interleaved", false, true, 2);
  if (bullet)
    for (const char* precision : {"float", "double"})
      if (linked(precision))
        all.push_back(of_solver(scene, std::string("bullet:precision=") + precision, 27,
                                precision[0] == 'f' ? 76 : 152));
  return all;
}

double time_part(Kernel& kernel, int sweeps) {
  const clockid_t clock = kernel.row.threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  const int repeats = kernel.repeats * (sweeps == kNoSweeps ? kManySweeps : 1);
  if (sweeps == kNoSweeps) kernel.reload();  // no link holds it: it would fall ever farther
  const double begin = seconds_of(clock);
  for (int r = 0; r < repeats; ++r) kernel.work(sweeps);
  return (seconds_of(clock) - begin) / repeats;
}

double time_once(Kernel& kernel, int sweeps) {
  double sum = 0, fastest = 1;
  for (int part = 0; part < kParts; ++part) {
    const double time = time_part(kernel, sweeps);
    sum += time, fastest = std::min(fastest, time);
  }
  if (sweeps == kFewSweeps) kernel.fastest_few = std::min(kernel.fastest_few, fastest);
  if (sweeps == kManySweeps) kernel.fastest_many = std::min(kernel.fastest_many, fastest);
  return sum / kParts;
}

struct Sample {
  double projection;  ///< ns
  double fixed;       ///< structural sweeps
};

Sample sample(Kernel& kernel, bool back) {
  const double first = time_once(kernel, back ? kManySweeps : kFewSweeps);
  const double second = time_once(kernel, back ? kFewSweeps : kManySweeps);
  const double projection = (back ? first - second : second - first) / kernel.projections;
  return {1e9 * projection, time_once(kernel, kNoSweeps) / (projection * kernel.structural)};
}

constexpr int kSweepsOfStep = 16;

std::unique_ptr<Solver> sweeping(const Scene& scene, int threads) {
  const SolverChoice choice =
      parse_solver("jakobsen:substeps=1,iterations=" + std::to_string(kSweepsOfStep) +
                   ",threads=" + std::to_string(threads));
  auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  return solver;
}

double time_of(Solver& solver, int steps, double dt) {
  const double begin = seconds_of(CLOCK_MONOTONIC);
  for (int n = 0; n < steps; ++n) solver.step(0, dt);
  return seconds_of(CLOCK_MONOTONIC) - begin;
}

/// From when both are at the start to when both are done.
double time_of_both(Solver& a, Solver& b, int steps, double dt) {
  std::atomic<int> ready{0};
  const auto start = [&] {
    for (++ready; ready < 2;) std::this_thread::yield();
  };
  std::thread other([&] {
    start();
    time_of(b, steps, dt);
  });
  start();
  const double begin = seconds_of(CLOCK_MONOTONIC);
  time_of(a, steps, dt);
  other.join();
  return seconds_of(CLOCK_MONOTONIC) - begin;
}

/// Interleaved: each round times one thread, two threads, one thread again and two unrelated
/// sheets, `seconds` each.
TwoCores bench_two_cores(const Scene& scene, int rounds, double seconds) {
  const auto one = sweeping(scene, 1), another = sweeping(scene, 1), two = sweeping(scene, 2);
  const double dt = scene.dt;
  for (Solver* solver : {another.get(), two.get()}) time_of(*solver, 1, dt);
  const double step = std::min(time_of(*one, 1, dt), time_of(*one, 1, dt));
  const int steps = times_within(seconds, step, 100000);
  TwoCores cores;
  for (int round = 0; round < rounds; ++round) {
    const double before = time_of(*one, steps, dt), shared = time_of(*two, steps, dt);
    const double after = time_of(*one, steps, dt);  // meanwhile the second thread falls asleep
    const double both = time_of_both(*one, *another, steps, dt);
    cores.add(before, shared, after, both);
  }
  return cores;
}

}  // namespace

Interval KernelBench::ratio(std::size_t i, std::size_t j) const {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < rows[i].samples.size(); ++r)
    ratios.push_back(rows[i].samples[r] / rows[j].samples[r]);
  return bootstrap_median(ratios);
}

KernelBench bench_kernels(const KernelBenchOptions& options) {
  const Scene scene = sheet(options.side);
  std::vector<Kernel> kernels = kernels_of(scene, options.bullet);
  const auto structural = static_cast<double>(
      std::count_if(scene.links.begin(), scene.links.end(),
                    [](const Link& link) { return link.family == Family::structural; }));
  const double flop[] = {seconds_per_flop(true), seconds_per_flop(false)};
  for (Kernel& kernel : kernels) {
    const bool single = kernel.row.name.find("float") != std::string::npos;
    kernel.row.floor = 1e9 * flop[single ? 0 : 1] * kernel.row.flops / kernel.row.threads;
    kernel.structural = structural;
    kernel.work(kManySweeps);
    kernel.repeats = times_within(options.seconds / kParts, time_part(kernel, kManySweeps), 100000);
  }
  for (int round = 0; round < options.rounds; ++round) {
    std::vector<Sample> forth, back(kernels.size());
    for (Kernel& kernel : kernels) forth.push_back(sample(kernel, false));
    for (std::size_t i = kernels.size(); i-- > 0;) back[i] = sample(kernels[i], true);
    for (std::size_t i = 0; i < kernels.size(); ++i) {
      kernels[i].row.samples.push_back((forth[i].projection + back[i].projection) / 2);
      kernels[i].row.fixed.push_back((forth[i].fixed + back[i].fixed) / 2);
    }
    options.progress(static_cast<std::size_t>(round) + 1, static_cast<std::size_t>(options.rounds));
  }
  KernelBench bench{
      .side = options.side,
      .rows = {},
      .arithmetic_float = 1e9 * seconds_per_projection(true),
      .arithmetic_double = 1e9 * seconds_per_projection(false),
      .traffic_float = 1e9 * seconds_per_link_traffic(scene, true),
      .traffic_double = 1e9 * seconds_per_link_traffic(scene, false),
      .two_cores = bench_two_cores(scene, kRoundsOfCores * options.rounds, options.seconds)};
  for (Kernel& kernel : kernels) {
    kernel.row.fastest = 1e9 * (kernel.fastest_many - kernel.fastest_few) / kernel.projections;
    bench.rows.push_back(std::move(kernel.row));
  }
  return bench;
}

}  // namespace taut
