#pragma once

#include <cmath>

namespace taut {

/// The larger of two numbers; NaN if one of them is NaN, which std::max() may lose.
inline double larger(double a, double b) { return std::isnan(a) || b <= a ? a : b; }

}  // namespace taut
