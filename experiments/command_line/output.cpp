#include "experiments/command_line/output.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <iostream>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

std::size_t characters(const std::string& text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins));
}

bool g_shown = true;

std::string clock_text(double seconds) {
  return formatted("%d:%02d", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
}

}  // namespace

std::string coloured(std::string_view text, Colour colour) {
  static const bool terminal = isatty(1) == 1 && std::getenv("NO_COLOR") == nullptr;
  if (!terminal) return std::string(text);
  return "\033[" + std::to_string(static_cast<int>(colour)) + "m" + std::string(text) + "\033[0m";
}

void print_columns(const std::vector<Row>& rows, std::size_t names) {
  std::vector<std::size_t> width(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], characters(row[i]));
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool last = i + 1 == row.size();
      const std::string blanks(width[i] - characters(row[i]), ' ');
      std::cout << "  " << (i < names || last ? row[i] + (last ? "" : blanks) : blanks + row[i]);
    }
    std::cout << '\n';
  }
}

std::string counts(const CampaignProgress& campaign) {
  if (campaign.by_status.empty()) return "no case";
  return join(campaign.by_status, ", ", [](const auto& status) {
    return std::string(to_string(status.first)) + " " + std::to_string(status.second);
  });
}

void print_files(const std::vector<std::string>& files, bool json) {
  if (json)
    print_json(Json{{"files", files}});
  else
    for (const std::string& file : files) std::cout << file << '\n';
}

void print_record(const Record& record) {
  std::cout << record.id << "\n  status       " << to_string(record.status.kind);
  if (!record.status.reason.empty()) std::cout << " (" << record.status.reason << ")";
  if (record.status.step >= 0) std::cout << ", step " << record.status.step;
  if (record.status.vertex >= 0) std::cout << ", vertex " << record.status.vertex;
  std::cout << "\n  steps        " << record.steps << " of " << record.dt << " s\n  cloth        "
            << record.vertices << " vertices, " << record.links << " links\n  work         "
            << record.projections << " projections per step\n  state        " << record.digest
            << '\n';
  for (const auto& [name, value] : record.values)
    if (!std::isnan(value)) {
      const ValueSpec* spec = find_value(name).second;
      std::cout << "  " << std::left << std::setw(26) << name << std::setprecision(6) << value
                << ' ' << (!spec || spec->unit.si == "1" ? "" : spec->unit.si) << '\n';
    }
}

Progress::Progress() : start_(std::chrono::steady_clock::now()), terminal_(isatty(2) == 1) {}

void show_progress(bool shown) { g_shown = shown; }

std::ostream& progress() {
  static std::ostream nowhere(nullptr);
  return g_shown ? std::cerr : nowhere;
}

Countdown::Countdown(std::string what)
    : what_(std::move(what)), terminal_(isatty(2) == 1), start_(std::chrono::steady_clock::now()) {}

void Countdown::operator()(std::size_t done, std::size_t total) const {
  if (!g_shown || (!terminal_ && done != total && done % std::max<std::size_t>(1, total / 10) != 0))
    return;
  const double each = seconds_since(start_) / static_cast<double>(done);
  std::cerr << (terminal_ ? "\r\033[K" : "") << what_ << formatted(" %zu/%zu  ", done, total)
            << (done < total ? "left " + clock_text(each * static_cast<double>(total - done))
                             : formatted("%.2g s each", each));
  if (!terminal_ || done == total) std::cerr << '\n';
  std::cerr << std::flush;
}

void Progress::show(const CampaignProgress& campaign, const Record* record) {
  if (!g_shown) return;
  const std::string place =
      "[" + std::to_string(campaign.done()) + "/" + std::to_string(campaign.cases) + "] ";
  if (!terminal_) {
    if (record) std::cerr << place << record->id << ": " << describe(record->status) << '\n';
    return;
  }
  const double elapsed = seconds_since(start_);
  if (record && !record->status.is_result())
    std::cerr << "\r\033[K" << record->id << ": " << describe(record->status) << '\n';
  std::string left = "?";
  if (campaign.work_done > 0)
    left = clock_text(elapsed * (campaign.work - campaign.work_done) / campaign.work_done);
  std::cerr << "\r\033[K" << place << counts(campaign) << "  elapsed " << clock_text(elapsed)
            << "  left " << left << std::flush;
}

void Progress::finish(const CampaignProgress& campaign) {
  if (!g_shown) return;
  if (terminal_) std::cerr << "\r\033[K";
  std::cerr << campaign.done() << "/" << campaign.cases << " cases: " << counts(campaign) << " ("
            << campaign.reused << " were stored already)\n";
}

CampaignProgress run_missing(const std::vector<Case>& cases, const Store& store,
                             const std::string& command, CampaignOptions options) {
  begin_session(store, command, cases, options.shard);
  Progress display;
  options.progress = [&](const CampaignProgress& t, const Record* r) { display.show(t, r); };
  const CampaignProgress campaign = run_cases(cases, store, options);
  display.finish(campaign);
  return campaign;
}

int exit_code(const CampaignProgress& campaign, const Store& store) {
  if (campaign.conflicts > 0)
    std::cerr << campaign.conflicts << " cases gave another result than the one stored: see "
              << "table conflicts of " << store.file().string() << '\n';
  if (campaign.interrupted) return kInterrupted;
  return campaign.conflicts > 0 ? kConflict : kPass;
}

}  // namespace taut
