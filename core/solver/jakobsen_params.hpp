#pragma once

#include "core/model/solver.hpp"
#include "core/solver/constraints/relaxation.hpp"
#include "core/solver/contact/responses.hpp"

namespace taut {

/// Every method that `jakobsen` can compute is one of these.
extern const std::span<const ParamSpec> kJakobsenParams;

Simd simd_of(const Params&);  ///< throws InputError if this machine does not have it
RelaxationSettings relaxation_settings(const Params&);
ContactSettings contact_settings(const Params&);

ResolvedSettings jakobsen_settings(const Scene&, const Params&);

}  // namespace taut
