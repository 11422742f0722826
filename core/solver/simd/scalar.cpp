#include "core/solver/simd/kernels_impl.hpp"

namespace taut {

namespace {
struct Isa;
}

extern const Kernels<float> kScalarFloat;
extern const Kernels<double> kScalarDouble;

const Kernels<float> kScalarFloat = make_kernels<float, float, float, float>();
const Kernels<double> kScalarDouble = make_kernels<double, double, double, double>();

}  // namespace taut
