#pragma once

// Parts of the model as JSON. Included by sources of the model only: the JSON library is large.

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/claims/rivals.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

// What one page can carry and one person look at; beyond it the model says how much it leaves out.
// Sentences, fronts and counts are of all cases nevertheless.
inline constexpr std::size_t kMostCases = 4000;   ///< listed; more if more are named
inline constexpr std::size_t kMostPoints = 1000;  ///< of a chart
inline constexpr std::size_t kMostCurves = 40;    ///< of a chart of more points than that
inline constexpr std::size_t kMostValues = 300;   ///< of the basis of a claim
inline constexpr std::size_t kMostCells = 10000;  ///< of all maps

/// Places in a list of n of at most `most` that are spread evenly, first and last among them.
std::vector<std::size_t> spread(std::size_t n, std::size_t most);

/// What parts of the model refer to: cases by key, quantities by name.
class References {
 public:
  /// Every record of the input, each once; a key as short as it may be.
  explicit References(const ReportInput&);
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

/// A number, or null if it is none.
Json json_number(double);
Json json_interval(const Interval&, std::size_t n);
/// Appends a field unless it is empty.
void add_if(Json& object, const char* name, Json value);

Json json_of(const Claim&, References&);
Json json_of(const Chart&, References&);
Json json_of(const StatusMap&, const std::string& id, References&);
Json json_of(const SceneMedia&, const ReportInput&, References&, std::size_t& budget);
/// What accuracy costs; its charts and tables go to those of the model.
Json json_of_cost(const BenchSession&, References&, Json& charts, Json& tables);
/// What two folders have otherwise; its table goes to those of the model.
Json json_of(const Differences&, References&, Json& tables);
/// What scenes require and how far solvers go; null without either. Its tables go to the model's.
Json json_of_limits(const ReportInput&, Json& tables);
/// What Vasilovici's report claims, with verdicts: as its truths say now, if they were checked.
Json json_of_seed_claims(const std::optional<Truths>&);
/// Settings of every rival on a scene, row by row; null without a case.
Json json_of_fairness(const QuotedScene&, const Rivals&, References&);

}  // namespace taut::report
