#pragma once

// Parts of the model as JSON. Included by sources of the model only: the JSON library is large.

#include <map>
#include <set>
#include <string>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/claims/rivals.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

/// What parts of the model refer to: cases by key, quantities by name.
class References {
 public:
  /// Every record of the input, each once; a key as short as it may be.
  explicit References(const ReportInput&);
  /// The short key; "" if it is no case of the input.
  std::string key(const std::string& key) const;
  std::string key(const Record& r) const { return key(r.key); }
  const Quantity& use(const std::string& name);

  const std::vector<const Record*>& cases() const { return cases_; }
  const std::map<std::string, Quantity>& quantities() const { return quantities_; }
  std::set<std::string> studies_of(const Record& r) const { return studies_.at(r.key); }

 private:
  std::size_t length_ = 12;
  std::vector<const Record*> cases_;
  std::map<std::string, std::set<std::string>> studies_;  ///< by key
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
Json json_of_fairness(const QuotedScene&, const Rivals&, const References&);

}  // namespace taut::report
