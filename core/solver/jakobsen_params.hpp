#pragma once

#include <optional>

#include "core/model/solver.hpp"
#include "core/solver/order.hpp"
#include "core/solver/passes/jacobi.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/stick.hpp"

namespace taut {

/// Every method of the report is a parameter of `jakobsen`.
extern const std::span<const ParamSpec> kJakobsenParams;

/// How the links of order=coloured are laid out.
enum class Path {
  automatic,  ///< strips if the scene is a regular sheet, else packed
  strips,     ///< the same; make_relaxation throws InputError for any other scene
  packed      ///< any mesh
};

Path path_of(const Params&);
Simd simd_of(const Params&);  ///< throws InputError if this machine does not have it
Projection projection_of(const Params&);
Order order_of(const Params&);
std::optional<Jacobi> jacobi_of(const Params&);  ///< empty: Gauss-Seidel
Firmness firmness(const Params&, double substep, int iterations);

ResolvedSettings jakobsen_settings(const Scene&, const Params&);

}  // namespace taut
