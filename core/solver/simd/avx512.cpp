// Compiled with -mavx512f -mavx512vl.
#include "core/solver/simd/kernels_impl.hpp"

namespace taut {

namespace {
struct Isa;
}

extern const Kernels<float> kAvx512Float;
extern const Kernels<double> kAvx512Double;

const Kernels<float> kAvx512Float =
    make_kernels<float, Lanes<float, 8, Isa>, Lanes<float, 16, Isa>, Lanes<float, 8, Isa>>();
const Kernels<double> kAvx512Double =
    make_kernels<double, Lanes<double, 8, Isa>, Lanes<double, 8, Isa>, Lanes<double, 8, Isa>>();

}  // namespace taut
