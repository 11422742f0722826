// How fast this machine computes when nothing stands in the way, in vectors of the widest kind:
// twelve independent chains of alternating multiplications and additions; projections of particles
// that stay in registers; and particles that are moved for projections that are left out.
#include <algorithm>
#include <atomic>
#include <thread>

#include "core/solver/layout/colour_batches.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/timing/bench/kernels.hpp"

namespace taut {

namespace {

constexpr int kChains = 12, kRounds = 20000;

template <class Real, int lanes>
struct Vectors {
  using V [[gnu::vector_size(lanes * sizeof(Real))]] = Real;

  [[gnu::always_inline]] static Real chains(Real factor) {
    V c[kChains];
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) c[i] = static_cast<Real>(i) - V{};
    const V f = factor - V{};
    for (int r = 0; r < kRounds; ++r) {
#pragma GCC unroll 12
      for (int i = 0; i < kChains; ++i) c[i] = c[i] * f;
#pragma GCC unroll 12
      for (int i = 0; i < kChains; ++i) c[i] = c[i] + f;
    }
    Real sum = 0;
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) sum += c[i][0];
    return sum;
  }
};

template <class Real>
[[gnu::target("avx512f,avx512vl")]] Real widest_avx512(Real f) {
  return Vectors<Real, 64 / sizeof(Real)>::chains(f);
}
template <class Real>
[[gnu::target("avx2")]] Real widest_avx2(Real f) {
  return Vectors<Real, 32 / sizeof(Real)>::chains(f);
}
template <class Real>
Real widest_sse2(Real f) {
  return Vectors<Real, 16 / sizeof(Real)>::chains(f);
}

/// CPU seconds of one call: the fastest of twenty.
template <class Real, class F>
double fastest(const F& run, Real value) {
  double best = 1;
  volatile Real keep = value;
  for (int attempt = 0; attempt < 20; ++attempt) {
    const double begin = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    keep = keep + 0 * run(keep);
    best = std::min(best, seconds_of(CLOCK_THREAD_CPUTIME_ID) - begin);
  }
  return best;
}

template <class Real>
double flop() {
  const Simd simd = widest();
  const auto run = simd == Simd::avx512 ? widest_avx512<Real>
                   : simd == Simd::avx2 ? widest_avx2<Real>
                                        : widest_sse2<Real>;
  const std::size_t bytes = simd == Simd::avx512 ? 64 : simd == Simd::avx2 ? 32 : 16;
  return fastest(run, static_cast<Real>(0.5)) /
         (2.0 * kChains * kRounds * static_cast<double>(bytes / sizeof(Real)));
}

template <class Real>
double projection() {
  const Kernels<Real>& widest_kernels = kernels<Real>(widest());
  int projections = 0;
  const auto run = [&](Real rest) {
    return widest_kernels.in_registers(rest, kRounds, projections);
  };
  return fastest(run, Real(1)) / projections;
}

template <class Real>
double traffic(const Scene& scene) {
  const Layout layout = Layout::packed(scene.start.x.size(), tile_ranks(scene.mesh));
  const ColourBatches<Real> batches(colour(scene.links, scene.mesh), inverse_masses(scene), 1,
                                    layout);
  std::vector<Real> x(layout.length());
  const auto load_and_store = kernels<Real>(widest()).load_and_store;
  const auto sweep = [&](Real) {
    for (std::size_t phase = 0; phase < batches.phases(); ++phase)
      for (std::size_t tile = 0; tile < batches.parts(phase); ++tile)
        for (const BatchRun<Real>& run : batches.runs(phase, tile)) load_and_store(run, x.data());
    return x[0];
  };
  return fastest(sweep, Real(0)) / static_cast<double>(batches.order(layout).size());
}

}  // namespace

double seconds_per_handover() {
  constexpr int kAttempts = 50, kTrips = 100;
  std::atomic<int> turn{0};
  const auto wait_for = [&turn](int n) {
    for (int tries = 0; turn.load(std::memory_order_acquire) != n; ++tries)
      if (tries > 10000) std::this_thread::yield();
  };
  const auto pass_on = [&turn](int n) { turn.store(n + 1, std::memory_order_release); };
  std::thread other([&] {
    for (int n = 1; n < 2 * kAttempts * kTrips; n += 2) wait_for(n), pass_on(n);
  });
  double best = 1;
  for (int attempt = 0, n = 0; attempt < kAttempts; ++attempt) {
    const double begin = seconds_of(CLOCK_MONOTONIC);
    for (int trip = 0; trip < kTrips; ++trip, n += 2) pass_on(n), wait_for(n + 2);
    best = std::min(best, (seconds_of(CLOCK_MONOTONIC) - begin) / (2 * kTrips));
  }
  other.join();
  return best;
}

double seconds_per_flop(bool single) { return single ? flop<float>() : flop<double>(); }

double seconds_per_projection(bool single) {
  return single ? projection<float>() : projection<double>();
}

double seconds_per_link_traffic(const Scene& scene, bool single) {
  return single ? traffic<float>(scene) : traffic<double>(scene);
}

}  // namespace taut
