#pragma once

#include <chrono>

#include "experiments/study/campaign.hpp"

namespace taut {

/// Shows a campaign on stderr: one line that is rewritten, with the time left, on a terminal; a
/// line per case otherwise.
class Progress {
 public:
  Progress();
  void show(const CampaignProgress&, const Record*);
  void finish(const CampaignProgress&);  ///< the last line: how the cases ended

 private:
  std::chrono::steady_clock::time_point start_;
  bool terminal_;
};

/// "ok 88, exploded 4".
std::string counts(const CampaignProgress&);

}  // namespace taut
