#include "core/solver/simd/kernels_impl.hpp"

namespace taut {

namespace {
struct Isa;
}

extern const Kernels<float> kSse2Float;
extern const Kernels<double> kSse2Double;

const Kernels<float> kSse2Float =
    make_kernels<float, Lanes<float, 4, Isa>, Lanes<float, 4, Isa>, Lanes<float, 4, Isa>>();
const Kernels<double> kSse2Double =
    make_kernels<double, Lanes<double, 2, Isa>, Lanes<double, 2, Isa>, double>();

}  // namespace taut
