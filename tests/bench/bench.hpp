#pragma once

#include <memory>
#include <string>

#include "core/model/solver.hpp"
#include "experiments/system/clock.hpp"

namespace taut::bench {

inline std::unique_ptr<Solver> make(const Scene& scene, const std::string& text) {
  const SolverChoice choice = parse_solver(text);
  return choice.entry->make(scene, choice.params);
}

/// Seconds per step, measured over `steps` steps from this state. CLOCK_THREAD_CPUTIME_ID counts
/// this thread only.
inline double time_of(Solver& solver, const State& start, int steps, double dt,
                      clockid_t clock = CLOCK_THREAD_CPUTIME_ID) {
  solver.load(start);
  const double begin = seconds_of(clock);
  for (int n = 0; n < steps; ++n) solver.step(n * dt, dt);
  return (seconds_of(clock) - begin) / steps;
}

void register_projections();
void register_iterations();
void register_contact();
void register_threads();
void register_bodies();

}  // namespace taut::bench
