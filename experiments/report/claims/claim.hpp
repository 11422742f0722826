#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/compared_solvers.hpp"
#include "experiments/report/input.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

// What one page can carry and one person look at; beyond it the model says how much it leaves out.
// Sentences, fronts and counts are of all cases nevertheless.
inline constexpr std::size_t kMostCases = 4000;   ///< listed; more if more are named
inline constexpr std::size_t kMostPoints = 1000;  ///< of a chart
inline constexpr std::size_t kMostCurves = 40;    ///< of a chart of more points than that
inline constexpr std::size_t kMostValues = 300;   ///< of the basis of a claim
inline constexpr std::size_t kMostCells = 10000;  ///< of all maps

/// At most `most` places in a list of n, spread evenly, first and last among them.
std::vector<std::size_t> places_of(std::size_t n, std::size_t most);

/// What parts of the model refer to: cases by key, quantities by name.
class Citations {
 public:
  /// Every record of the input, each once; a key as short as it may be.
  explicit Citations(const ReportInput&);
  /// The short key, and from now on the case is named; "" if it is no case of the input.
  std::string key(const std::string& key);
  std::string key(const Record& r) { return key(r.key); }
  const Quantity& use(const std::string& name);

  const std::vector<const Record*>& cases() const { return cases_; }
  /// Those that are named, and as many others, spread evenly, as make kMostCases.
  std::vector<const Record*> listed() const;
  const std::map<std::string, Quantity>& quantities() const { return quantities_; }
  std::set<std::string> studies_of(const Record& r) const;

 private:
  struct Known {
    std::vector<const std::string*> studies;
    bool named = false;
  };
  std::size_t length_ = 12;
  std::vector<const Record*> cases_;
  std::unordered_map<std::string_view, Known> known_;  ///< by key
  std::map<std::string, Quantity> quantities_;
};

/// Values of one quantity that a claim rests on. Points to the cases that it looked at. Looking at
/// a case is the only way to get its value here, and every case that was looked at is counted by
/// its status, whether it has a value or not.
class Evidence {
 public:
  /// `metric`: a name that quantity() knows; it says of which part of the run the values speak.
  /// `rule`: what was done with them.
  Evidence(const std::string& metric, std::string rule)
      : quantity_(report::quantity(metric)), rule_(std::move(rule)) {}

  /// The case's value; nothing if the case did not complete or the value has no meaning there.
  std::optional<double> look(const std::string& label, const Record&);
  /// The same of what BenchedCase::cost() gives of it [s per simulated second].
  void look(const BenchedCase&, const Interval& cost, const std::string& label);
  /// Why something did not go in: a sentence.
  void leave_out(const std::string& sentence);

  /// One case as it was seen.
  struct Seen {
    const Record* record = nullptr;
    std::string label;
    double value = 0;  ///< NaN: none
    std::optional<Interval> interval = {};
    std::size_t n = 1;
    std::string why = {};  ///< of a case that could not be timed, what ended it
  };
  /// What was seen as a text: the value, or why there is none.
  std::string text(const Seen&) const;
  const std::vector<Seen>& seen() const { return seen_; }
  const Quantity& quantity() const { return quantity_; }
  const std::string& rule() const { return rule_; }
  const std::string& left_out() const { return left_out_; }

 private:
  Quantity quantity_;
  std::string rule_, left_out_;
  std::vector<Seen> seen_;
};

enum class ClaimKind { headline, tile, note };
std::string_view to_string(ClaimKind);

/// A bar of a tile.
struct Bar {
  std::string solver, label;
  std::optional<double> value;  ///< SI; nothing: none
  std::optional<Interval> interval;
  std::string text;
};

/// A comparison in words. There is no other way to put one on the page, and none without the values
/// that it rests on.
struct Claim {
  /// `about`: "all", a scene, "cost", "only", "failures", "differences". Throws std::logic_error
  /// without evidence or with evidence that looked at no case.
  Claim(std::string id, ClaimKind, std::string about, std::string sentence, Certainty,
        std::vector<Evidence>);

  std::string id;
  ClaimKind kind;
  std::string about, sentence;
  Certainty sure;
  std::shared_ptr<const std::vector<Evidence>> basis;  ///< its tile has the same
  std::vector<std::string> strong = {};                ///< parts of the sentence to emphasise
  bool quotes = false;  ///< its values are of the quoted cases alone: a film may show just these
  std::string heading = {};    ///< of a tile
  std::vector<Bar> bars = {};  ///< of a tile: of the first evidence's quantity

  /// The claim as a tile on the same basis: a heading, a bar for each solver and what the bars are.
  /// Each bar's text is in the claim's sentence.
  Claim tile(std::string heading, std::string what, std::vector<Bar>) const;
};

/// The value of kErrorMetric whose price heads the page.
inline constexpr double kPricedError = 0.01;

/// As the model has it (model/MODEL.md).
Json json_of(const Claim&, Citations&);

/// Errors, penetration, largest stable time step and failures, over all scenes and scene by scene.
std::vector<Claim> physics_claims(const ComparedSolvers&);
/// What a step of the same work costs, then the priced error, each at its best, and apart from that
/// with what only one has.
/// Empty without a bench.
std::vector<Claim> cost_claims(const ReportInput&);
/// How the cases that two results folders have ended, what values and costs differ, and by how
/// much. Empty with one folder alone.
std::vector<Claim> difference_claims(const ReportInput&);

/// What the input's results do not show, a sentence each.
std::vector<std::string> caveats(const ReportInput&);

/// Geometric mean of independent ratios: their errors add as squares of logarithms.
Interval geometric_mean(const std::vector<Interval>&);
double geometric_mean(const std::vector<double>&);
/// The opening and these names as a sentence; "" without names.
std::string sentence_if(const std::string& opening, const std::vector<std::string>& names);
/// "1/11" or "71 %" of what is compared with; below 1.
std::string share_text(double ratio);
/// Why there is nothing to say of two costs: "too noisy to judge". Precondition: no difference.
std::string undecided(Certainty);

}  // namespace taut::report
