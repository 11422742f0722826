#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/study/campaign.hpp"

namespace taut {

/// The stored cases of a study as settings x scenes, both in the order of the plan.
class StudyTable {
 public:
  explicit StudyTable(StudyRecords);

  /// A metric's value with three digits: a line per setting, a column per scene. A failure, and
  /// an extreme, prints its status, a value without a meaning "-", one of an unsettled case a "~".
  std::string text(const std::string& value) const;
  /// By [setting, scene].
  const std::map<std::pair<std::string, std::string>, Record>& records() const { return records_; }

 private:
  std::vector<std::string> settings_, scenes_;
  std::map<std::pair<std::string, std::string>, Record> records_;
};

}  // namespace taut
