#include <benchmark/benchmark.h>

#include "tests/bench/bench.hpp"

int main(int argc, char** argv) {
  taut::bench::register_projections();
  taut::bench::register_iterations();
  taut::bench::register_contact();
  taut::bench::register_threads();
  taut::bench::register_bodies();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
