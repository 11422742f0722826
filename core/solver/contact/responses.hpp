#pragma once

#include <memory>
#include <vector>

#include "core/model/solver.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// The passes of contact, by when they act. All empty if the scene has nothing to touch.
template <class Real>
struct ContactPasses {
  using List = std::vector<std::unique_ptr<Pass<Real>>>;
  List before;  ///< once a substep, before the sweeps
  List sweep;   ///< in every sweep, after the links
  List after;   ///< once a substep, after the sweeps
};

/// As the parameters contact, ... say.
template <class Real>
ContactPasses<Real> make_contact(const Scene&, const Params&);

/// What the fairness panel says of contact.
ResolvedSettings contact_settings(const Scene&, const Params&);

}  // namespace taut
