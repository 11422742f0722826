#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/study/campaign.hpp"

namespace taut {

/// Where to look for the largest stable value of one setting.
struct SearchRange {
  double from = 0, to = 0;
  bool whole = false;       ///< whole numbers only
  double tolerance = 0.01;  ///< width of the bracket, relative to its upper end
  int coarse = 9;  ///< how many values are tried first, ends included, evenly spaced (geometrically
                   ///< if from > 0): between two of them the frontier is taken to be one
};

/// How one value turned out.
struct Outcome {
  Status status;
  std::string symptom = {};  ///< what is wrong by another measure than its status; "": nothing
};

struct Probed : Outcome {
  double value = 0;
  /// However far it stretches: a large strain alone is no instability.
  bool stable() const {
    return symptom.empty() &&
           (status.kind == Status::Kind::ok ||
            (status.kind == Status::Kind::extreme && status.reason == reason::kStretch));
  }
  /// A crash is an answer; lack of time or memory and a broken protocol are not.
  bool known() const { return status.is_result() || status.kind == Status::Kind::crash; }
};

/// The largest stable value below which nothing was found that is not stable, and what lies above.
struct Frontier {
  enum class Kind {
    bracketed,     ///< between `stable` and `unstable`
    all_stable,    ///< up to the end of the range
    none_stable,   ///< from its start on
    not_answered,  ///< the solver cannot do the scene and that is no symptom, it never had the time
                   ///< or memory, or the search was interrupted
  };
  Kind kind = Kind::not_answered;
  double stable = 0, unstable = 0;   ///< the bracket; meaningless where `kind` says so
  std::vector<double> stable_above;  ///< stable values above `unstable`: not monotone
  std::size_t above = 0;             ///< values tried above the bracket
  std::vector<Probed> probes;        ///< all, ascending
  const Probed* at(double value) const;
};

/// "bracketed", "all stable", "none stable", "not answered".
std::string_view to_string(Frontier::Kind);

/// Gives the outcome for each value; fewer if it was interrupted.
using Trial = std::function<std::vector<Outcome>(const std::vector<double>&)>;

/// Tries the coarse values, halves the first interval whose ends differ until it is narrow, then
/// looks between `unstable` and the next value tried for stable values that monotony would rule
/// out. Values without an answer are passed over.
Frontier find_frontier(const SearchRange&, const Trial&);

/// Which way a setting becomes harder. Downwards, the search goes up in 1/setting.
enum class Direction { up, down, down_in_whole_numbers };

/// How far one setting of a case can go.
struct FrontierQuestion {
  CaseSpec base;
  /// "dt", a parameter of the solver, or a scene key ("wind.strength"); several that take the same
  /// value as "structural|shear".
  std::string of = "dt";
  SearchRange range;  ///< of the setting, or downwards of 1/setting
  Direction direction = Direction::up;

  /// The setting where the search is at `value`.
  double setting(double value) const;
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

/// What is wrong with a case by more than its status; "": nothing.
using Judge = std::function<std::string(const Case&, const Record&)>;

/// Every probe is a case of its own process, through the store.
CaseFrontier find_frontier(const FrontierQuestion&, Store&, const CampaignOptions&,
                           const Judge& = {});

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
