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

// What one page can carry and one person look at; beyond it the model says how much it leaves out.
// Tables, fronts and counts are of all cases nevertheless.
inline constexpr std::size_t kMostCases = 4000;   ///< listed; more if more are named
inline constexpr std::size_t kMostPoints = 1000;  ///< of a chart
inline constexpr std::size_t kMostCurves = 40;    ///< of a chart of more points than that
inline constexpr std::size_t kMostCells = 10000;  ///< of all maps

/// At most `most` places in a list of n, spread evenly, first and last among them.
std::vector<std::size_t> places_of(std::size_t n, std::size_t most);

/// What parts of a page refer to: cases by key, quantities by name.
class CaseList {
 public:
  /// Every record of the input, each once; a key as short as it may be.
  explicit CaseList(const ReportInput&);
  /// The short key, and from now on the case is named; "" if it is no case of the input.
  std::string key(const std::string& key);
  std::string key(const Record& r) { return key(r.key); }
  const Quantity& use(const std::string& name);

  const std::vector<const Record*>& cases() const { return cases_; }
  /// Those that are named, and as many others, spread evenly, as make kMostCases.
  std::vector<const Record*> listed() const;
  const std::map<std::string, Quantity>& quantities() const { return quantities_; }
  std::set<std::string> studies_of(const Record& r) const;
  /// No study that is compared has it, and no bench.
  bool only_in_maps(const Record& r) const;

 private:
  struct Known {
    std::vector<const std::string*> studies;
    bool named = false;
  };
  std::size_t length_ = 12;
  std::vector<const Record*> cases_;
  std::set<std::string> maps_;                         ///< studies of which the page has maps alone
  std::unordered_map<std::string_view, Known> known_;  ///< by key
  std::map<std::string, Quantity> quantities_;
};

}  // namespace taut::report
