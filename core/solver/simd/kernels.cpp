#include "core/solver/simd/kernels.hpp"

#include <cassert>
#include <type_traits>

namespace taut {

extern const Kernels<float> kScalarFloat, kSse2Float, kAvx2Float, kAvx512Float;
extern const Kernels<double> kScalarDouble, kSse2Double, kAvx2Double, kAvx512Double;

std::string_view to_string(Simd simd) {
  switch (simd) {
    case Simd::scalar:
      return "scalar";
    case Simd::sse2:
      return "sse2";
    case Simd::avx2:
      return "avx2";
    case Simd::avx512:
      return "avx512";
  }
  return "";
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
  constexpr bool single = std::is_same_v<Real, float>;
  const auto pick = [](const auto& f, const auto& d) -> const Kernels<Real>& {
    if constexpr (single)
      return f;
    else
      return d;
  };
#if defined(__x86_64__)
  if (simd == Simd::avx512) return pick(kAvx512Float, kAvx512Double);
  if (simd == Simd::avx2) return pick(kAvx2Float, kAvx2Double);
  if (simd == Simd::sse2) return pick(kSse2Float, kSse2Double);
#endif
  return pick(kScalarFloat, kScalarDouble);
}

template const Kernels<float>& kernels(Simd);
template const Kernels<double>& kernels(Simd);

}  // namespace taut
