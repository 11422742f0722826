// Compiled once for each instruction set, TAUT_SIMD, with the flags that it needs (CMakeLists.txt).
#include <algorithm>
#include <type_traits>

#include "core/solver/simd/kernels_impl.hpp"

namespace taut {

namespace {

struct Isa;  // keeps this file's code apart from that of the other sets

constexpr Simd kSimd = Simd::TAUT_SIMD;
constexpr int kRegister = kSimd == Simd::avx512 ? 64 : kSimd == Simd::avx2 ? 32 : 16;  // bytes

template <class Real, int width>
using LanesOf = std::conditional_t<width == 1, Real, Lanes<Real, std::max(width, 2), Isa>>;

template <class Real>
constexpr Kernels<Real> make() {
  constexpr auto lanes = [](std::size_t number) {
    return kSimd == Simd::scalar ? 1 : kRegister / static_cast<int>(number);
  };
  constexpr int wide = lanes(sizeof(Real));
  constexpr int narrow = std::min(wide, 8);
  constexpr int packed = narrow < 4 ? 1 : narrow;  // whole particles
  return make_kernels<Real, LanesOf<Real, narrow>, LanesOf<Real, wide>, LanesOf<Real, packed>,
                      LanesOf<double, lanes(sizeof(double))>>();
}

}  // namespace

template <Simd simd, class Real>
const Kernels<Real>& kernels_for() {
  static constexpr Kernels<Real> kAll = make<Real>();
  return kAll;
}

template const Kernels<float>& kernels_for<kSimd, float>();
template const Kernels<double>& kernels_for<kSimd, double>();

}  // namespace taut
