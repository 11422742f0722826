#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/trade.hpp"

namespace taut {

/// What is asked for: the cheapest setting within an error, or the most accurate within a cost.
/// Exactly one is set.
struct Wish {
  std::optional<double> error;   ///< of the metric, its SI unit
  std::optional<double> budget;  ///< CPU seconds per simulated second

  bool grants(const Offer&) const;
  /// Whether a serves the wish better than b; a grant beats every refusal.
  bool prefers(const Offer& a, const Offer& b) const;
};

/// Runs a setting ("jakobsen:iterations=1,substeps=16"); nothing: time is up, search no further.
using Try = std::function<std::optional<Offer>(const std::string& setting)>;

/// Looks for the setting of `solver` (its text fixes what it names) that serves the wish best,
/// and gives all that it tried. It walks the accuracy knobs of the solver's
/// entry, not their grid:
///   1. columns of the second knob (sweeps, or a stiffness): in each, the fewest substeps that
///      reach the error by doubling, from half of what the column before needed; or the most that
///      the budget allows. Two columns without progress end it, as does a cost far above what
///      `known`, the offers of others, have.
///   2. error: bisection of the substeps, then of the sweeps, between the last doubling.
///   3. the entry's alternatives, one at a time; each with as few substeps as it then needs.
std::vector<Offer> search_settings(const std::string& solver, const Wish&, const Try&,
                                   std::vector<Offer> known = {});

}  // namespace taut
