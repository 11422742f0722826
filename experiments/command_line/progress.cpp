#include "experiments/command_line/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace taut {

namespace {

std::string clock_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%d:%02d", static_cast<int>(seconds) / 60,
                static_cast<int>(seconds) % 60);
  return text;
}

std::string outcome(const Record& record) {
  std::string text(to_string(record.status.kind));
  if (!record.status.reason.empty()) text += " (" + record.status.reason + ")";
  if (record.status.step >= 0) text += " at step " + std::to_string(record.status.step);
  return text;
}

}  // namespace

std::string counts(const CampaignProgress& campaign) {
  std::string text;
  for (const auto& [kind, count] : campaign.by_status)
    text += (text.empty() ? "" : ", ") + std::string(to_string(kind)) + " " + std::to_string(count);
  return text.empty() ? "no case" : text;
}

Progress::Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(2) == 1) {}

void Progress::show(const CampaignProgress& campaign, const Record* record) {
  const std::string place =
      "[" + std::to_string(campaign.done()) + "/" + std::to_string(campaign.cases) + "] ";
  if (!terminal_) {
    if (record) std::cerr << place << record->id << ": " << outcome(*record) << '\n';
    return;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  if (record && !record->status.is_result())
    std::cerr << "\r\033[K" << record->id << ": " << outcome(*record) << '\n';
  std::string left = "?";
  if (campaign.work_done > 0)
    left = clock_text(elapsed.count() * (campaign.work - campaign.work_done) / campaign.work_done);
  std::cerr << "\r\033[K" << place << counts(campaign) << "  elapsed "
            << clock_text(elapsed.count()) << "  left " << left << std::flush;
}

void Progress::finish(const CampaignProgress& campaign) {
  if (terminal_) std::cerr << "\r\033[K";
  std::cerr << campaign.done() << "/" << campaign.cases << " cases: " << counts(campaign) << " ("
            << campaign.reused << " were stored already)\n";
}

}  // namespace taut
