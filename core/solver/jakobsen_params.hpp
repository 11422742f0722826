#pragma once

#include <optional>

#include "core/model/solver.hpp"
#include "core/solver/order.hpp"
#include "core/solver/passes/jacobi.hpp"
#include "core/solver/stick.hpp"

namespace taut {

/// Every method of the report is a parameter of `jakobsen`.
extern const std::span<const ParamSpec> kJakobsenParams;

Order order_of(const Params&);
std::optional<Jacobi> jacobi_of(const Params&);  ///< empty: Gauss-Seidel
Firmness firmness(const Params&, double substep, int iterations);

Effective jakobsen_effective(const Scene&, const Params&);

}  // namespace taut
