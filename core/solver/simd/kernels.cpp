#include "core/solver/simd/kernels.hpp"

#include <cassert>
#include <cstddef>
#include <iterator>

namespace taut {

std::string_view to_string(Simd simd) {
  constexpr std::string_view kNames[] = {"scalar", "sse2", "avx2", "avx512"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(Simd::avx512) + 1);
  return kNames[static_cast<std::size_t>(simd)];
}

bool available(Simd simd) {
#if defined(__x86_64__)
  switch (simd) {
    case Simd::avx2:
      return __builtin_cpu_supports("avx2");
    case Simd::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl");
    default:
      return true;
  }
#else
  return simd == Simd::scalar;
#endif
}

Simd widest() {
  for (const Simd simd : {Simd::avx512, Simd::avx2, Simd::sse2})
    if (available(simd)) return simd;
  return Simd::scalar;
}

template <class Real>
const Kernels<Real>& kernels(Simd simd) {
  assert(available(simd));
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kernels_for<Simd::avx512, Real>();
  if (simd == Simd::avx2) return kernels_for<Simd::avx2, Real>();
  if (simd == Simd::sse2) return kernels_for<Simd::sse2, Real>();
#endif
  return kernels_for<Simd::scalar, Real>();
}

template const Kernels<float>& kernels(Simd);
template const Kernels<double>& kernels(Simd);

}  // namespace taut
