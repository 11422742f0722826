#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"

namespace taut::report {

// Limits on what a page can carry and a person can look at. The model says how much is left out
// beyond them. Tables, fronts and counts cover all cases nevertheless.
inline constexpr std::size_t kMostCases = 4000;   ///< cases listed; more if more are named
inline constexpr std::size_t kMostPoints = 1000;  ///< points in a chart
inline constexpr std::size_t kMostCurves = 40;    ///< curves in a chart with more points than that
inline constexpr std::size_t kMostCells = 10000;  ///< cells of all maps together

/// At most `most` indices into a list of n, evenly spread and including the first and the last.
std::vector<std::size_t> places_of(std::size_t n, std::size_t most);

/// The cases (by key) and quantities (by name) to which parts of a page refer.
class CaseList {
 public:
  /// Contains every record of the input once, and shortens keys as far as they stay distinct.
  explicit CaseList(const ReportInput&);
  /// The short key of a case, which then counts as named; "" if it is not a case of the input.
  std::string key(const std::string& key);
  std::string key(const Record& r) { return key(r.key); }
  const Quantity& use(const std::string& name);

  const std::vector<const Record*>& cases() const { return cases_; }
  /// The named cases, and as many others, evenly spread, as make up kMostCases.
  std::vector<const Record*> listed() const;
  const std::map<std::string, Quantity>& quantities() const { return quantities_; }
  std::set<std::string> studies_of(const Record& r) const;
  /// Whether neither a compared study nor a bench has the case.
  bool only_in_maps(const Record& r) const;

 private:
  struct Known {
    std::vector<const std::string*> studies;
    bool named = false;
  };
  std::size_t length_ = 12;
  std::vector<const Record*> cases_;
  std::set<std::string> maps_;  ///< studies of which the page shows only maps
  std::unordered_map<std::string_view, Known> known_;  ///< by key
  std::map<std::string, Quantity> quantities_;
};

}  // namespace taut::report
