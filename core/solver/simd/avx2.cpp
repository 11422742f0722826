// Compiled with -mavx2.
#include "core/solver/simd/kernels_impl.hpp"

namespace taut {

namespace {
struct Isa;
}

extern const Kernels<float> kAvx2Float;
extern const Kernels<double> kAvx2Double;

const Kernels<float> kAvx2Float =
    make_kernels<float, Lanes<float, 8, Isa>, Lanes<float, 8, Isa>, Lanes<float, 8, Isa>>();
const Kernels<double> kAvx2Double =
    make_kernels<double, Lanes<double, 4, Isa>, Lanes<double, 4, Isa>, Lanes<double, 4, Isa>>();

}  // namespace taut
