#pragma once

#include <optional>
#include <string>

#include "experiments/study/bisection.hpp"
#include "experiments/study/campaign.hpp"

namespace taut {

/// How far one setting of a case can go.
struct FrontierQuestion {
  CaseSpec base;
  std::string of = "dt";  ///< "dt", a parameter of the solver, or a scene key ("wind.strength")
  SearchRange range;

  /// The case with the setting at this value. Throws InputError what makes no sense.
  CaseSpec at(double value) const;
};

/// The ends where they are given; else for "dt" 1e-3 to 0.5 s and for a parameter what it may be,
/// if that has bounds that mean something. Throws InputError if there is no such parameter, if it
/// is no number, or if the range has to be given.
SearchRange range_of(const CaseSpec& base, const std::string& of, std::optional<double> from,
                     std::optional<double> to);

struct CaseFrontier {
  Frontier frontier;
  std::vector<Record> records;  ///< of the probes, ascending in value
  std::size_t ran = 0;          ///< were not stored yet
  bool interrupted = false;
};

/// Every probe is a case of its own process, through the store.
CaseFrontier find_frontier(const FrontierQuestion&, const Store&, const Session&,
                           const CampaignOptions&);

/// Where linear theory has the frontier (linear_stability.hpp).
struct Prediction {
  Frontier::Kind kind = Frontier::Kind::bracketed;
  double value = 0;   ///< if bracketed
  double growth = 0;  ///< of the fastest mode per step, just above the frontier or, without one, at
                      ///< the end of the range; 0: not known
  std::string law;
};
/// Empty if there is no theory. Precondition: as of find_frontier.
std::optional<Prediction> predicted_frontier(const FrontierQuestion&);

}  // namespace taut
