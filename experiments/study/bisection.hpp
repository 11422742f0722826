#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"

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
            (status.kind == Status::Kind::extreme && status.reason == "stretch"));
  }
  /// A crash is an answer; want of time or memory is none, nor is a broken protocol.
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
/// looks between `unstable` and the next coarse value for stable values that monotony would rule
/// out. Values without an answer are passed over.
Frontier find_frontier(const SearchRange&, const Trial&);

}  // namespace taut
