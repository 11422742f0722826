#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/study/campaign.hpp"

namespace taut {

/// Range in which to search for the largest stable value of a setting.
struct SearchRange {
  double from = 0, to = 0;
  bool whole = false;       ///< whole numbers only
  double tolerance = 0.01;  ///< width of the bracket, relative to its upper end
  /// Number of values tried first, including both ends; evenly spaced, or geometrically if from >
  /// 0. Between two neighbours of them the search assumes at most one frontier.
  int coarse = 9;
};

/// Outcome of the run with one value.
struct Outcome {
  Status status;
  std::string symptom = {};  ///< a fault that the status does not show; "": none
};

struct Probed : Outcome {
  double value = 0;
  /// A large strain alone is no instability, however far the cloth stretches.
  bool stable() const {
    return symptom.empty() &&
           (status.kind == Status::Kind::ok ||
            (status.kind == Status::Kind::extreme && status.reason == Reason::stretch));
  }
  /// Whether the outcome is known. A crash is; lack of time or memory and a broken protocol are
  /// not.
  bool known() const { return status.is_result() || status.kind == Status::Kind::crash; }
};

/// The largest stable value below which no unstable one was found, and what was found above it.
struct Frontier {
  enum class Kind {
    bracketed,    ///< between `stable` and `unstable`
    all_stable,   ///< stable up to the end of the range
    none_stable,  ///< unstable from its start
    /// No outcome is known: the solver refuses the scene and no judge calls that a symptom, every
    /// run lacked time or memory, or the search was interrupted.
    not_answered,
  };
  Kind kind = Kind::not_answered;
  double stable = 0, unstable = 0;  ///< the bracket, as far as `kind` gives it a meaning
  /// Stable values above `unstable`, which show that stability is not monotone.
  std::vector<double> stable_above;
  std::size_t above = 0;       ///< number of values tried above the bracket
  std::vector<Probed> probes;  ///< all probes, in ascending order of value
  const Probed* at(double value) const;
};

/// "bracketed", "all stable", "none stable", "not answered".
std::string_view to_string(Frontier::Kind);

/// Runs these values and returns their outcomes; fewer if interrupted.
using Trial = std::function<std::vector<Outcome>(const std::vector<double>&)>;

/// Tries the coarse values and halves the first interval whose ends differ until it is narrow. Then
/// looks for stable values between `unstable` and the next value tried, which would show that
/// stability is not monotone. Ignores values whose outcome is not known.
Frontier find_frontier(const SearchRange&, const Trial&);

/// Direction in which a setting becomes harder. Downwards, the search ascends in 1/setting.
enum class Direction { up, down, down_in_whole_numbers };

/// The question how far one setting of a case can go.
struct FrontierQuestion {
  CaseSpec base;
  /// "dt", a parameter of the solver, or a scene key ("wind.strength"). Several that take the same
  /// value are joined: "structural|shear".
  std::string of = "dt";
  SearchRange range;  ///< range of the setting, or if downwards of 1/setting
  Direction direction = Direction::up;

  /// The setting for the search's `value`.
  double setting(double value) const;
  /// The case with that setting. Throws InputError if it makes no sense.
  CaseSpec at(double value) const;
};

/// The range of a search for the time step, unless another is given [s].
inline constexpr SearchRange kTimeSteps{.from = 2e-3, .to = 0.5};

/// The range of a search. Ends that are not given default to kTimeSteps for "dt", and for a
/// parameter to its own bounds if they are meaningful. Throws InputError if there is no such
/// parameter, if it is not a number, or if the range has to be given.
SearchRange range_of(const CaseSpec& base, const std::string& of, std::optional<double> from,
                     std::optional<double> to);

struct CaseFrontier {
  Frontier frontier;
  std::vector<Record> records;  ///< records of the probes, in ascending order of value
  std::size_t ran = 0;          ///< number of cases that were not stored yet
  bool interrupted = false;
};

/// Returns what is wrong with a case beyond its status; "" if nothing.
using Judge = std::function<std::string(const Case&, const Record&)>;

/// Finds the frontier of a setting. Every probe is a case in a process of its own, and is stored.
CaseFrontier find_frontier(const FrontierQuestion&, Store&, const CampaignOptions&,
                           const Judge& = {});

/// Frontier according to linear theory (linear_stability.hpp).
struct Prediction {
  Frontier::Kind kind = Frontier::Kind::bracketed;
  double value = 0;  ///< the frontier, if bracketed
  /// Growth per step of the fastest mode, just above the frontier or, without one, at the end of
  /// the range; 0: not known.
  double growth = 0;
  std::string law;
};
/// Nothing if there is no theory. Precondition: as for find_frontier().
std::optional<Prediction> predicted_frontier(const FrontierQuestion&);

}  // namespace taut
