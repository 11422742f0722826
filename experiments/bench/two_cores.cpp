#include "experiments/bench/two_cores.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "core/model/solver.hpp"

namespace taut {

namespace {

constexpr int kSweepsOfStep = 16;

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::unique_ptr<Solver> make(const Scene& scene, int threads) {
  const SolverChoice choice =
      parse_solver("jakobsen:substeps=1,iterations=" + std::to_string(kSweepsOfStep) +
                   ",threads=" + std::to_string(threads));
  auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  return solver;
}

double time_of(Solver& solver, int steps, double dt) {
  const auto begin = Clock::now();
  for (int n = 0; n < steps; ++n) solver.step(0, dt);
  return since(begin);
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
  const auto begin = Clock::now();
  time_of(a, steps, dt);
  other.join();
  return since(begin);
}

}  // namespace

TwoCores bench_two_cores(const Scene& scene, int rounds, double seconds) {
  const auto one = make(scene, 1), another = make(scene, 1), two = make(scene, 2);
  const double dt = scene.dt;
  for (Solver* solver : {another.get(), two.get()}) time_of(*solver, 1, dt);
  const double step = std::min(time_of(*one, 1, dt), time_of(*one, 1, dt));
  const int steps = std::clamp(static_cast<int>(seconds / std::max(step, 1e-9)), 1, 100000);
  std::vector<double> threads, unrelated, share, while_free;
  for (int round = 0; round < rounds; ++round) {
    const double before = time_of(*one, steps, dt), shared = time_of(*two, steps, dt);
    const double after = time_of(*one, steps, dt);  // meanwhile the second thread falls asleep
    const double both = time_of_both(*one, *another, steps, dt);
    threads.push_back(before / shared);
    unrelated.push_back(2 * after / both);
    share.push_back(both / 2 / shared);
    if (unrelated.back() >= TwoCores::kFree) while_free.push_back(threads.back());
  }
  return {.threads = bootstrap_median(threads),
          .unrelated = bootstrap_median(unrelated),
          .share = bootstrap_median(share),
          .threads_while_free = bootstrap_median(while_free),
          .free = static_cast<double>(while_free.size()) / static_cast<double>(rounds)};
}

}  // namespace taut
