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

std::string counts(const Tally& tally) {
  std::string text;
  for (const auto& [kind, count] : tally.by_status)
    text += (text.empty() ? "" : ", ") + std::string(to_string(kind)) + " " + std::to_string(count);
  return text.empty() ? "no case" : text;
}

Progress::Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(2) == 1) {}

void Progress::show(const Tally& tally, const Record* record) {
  const std::string place =
      "[" + std::to_string(tally.done()) + "/" + std::to_string(tally.cases) + "] ";
  if (!terminal_) {
    if (record) std::cerr << place << record->id << ": " << outcome(*record) << '\n';
    return;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  if (record && !record->status.is_result())
    std::cerr << "\r\033[K" << record->id << ": " << outcome(*record) << '\n';
  std::string left = "?";
  if (tally.work_done > 0)
    left = clock_text(elapsed.count() * (tally.work - tally.work_done) / tally.work_done);
  std::cerr << "\r\033[K" << place << counts(tally) << "  elapsed " << clock_text(elapsed.count())
            << "  left " << left << std::flush;
}

void Progress::finish(const Tally& tally) {
  if (terminal_) std::cerr << "\r\033[K";
  std::cerr << tally.done() << "/" << tally.cases << " cases: " << counts(tally) << " ("
            << tally.reused << " were stored already)\n";
}

}  // namespace taut
