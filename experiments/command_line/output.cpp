#include "experiments/command_line/output.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/process.hpp"
#include "experiments/system/signals.hpp"
#include "experiments/system/text.hpp"
#include "experiments/timing/judge.hpp"

namespace taut {

namespace {

bool g_shown = true;

/// The text in the colour of its tone: none, green, yellow, red.
std::string coloured(const std::string& text, Cell::Tone tone) {
  constexpr const char* kColours[] = {"", "\033[32m", "\033[33m", "\033[31m"};
  if (tone == Cell::Tone::plain) return text;
  return kColours[static_cast<std::size_t>(tone)] + text + "\033[0m";
}

/// Width of the terminal if standard output is one; lines in a file or a pipe are not limited.
std::size_t columns_of_output() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col
                                                                         : std::string::npos;
}

}  // namespace

void print(const Answer& answer, const Format& format) {
  // Cells contain texts from programs and files, which may hold control characters; JSON escapes
  // them.
  const auto shown = [](const std::string& text) { return printable(text, std::string::npos); };
  const bool colours = isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  if (format.json)
    std::cout << to_json(answer);
  else if (format.markdown)
    std::cout << '`' << typed_command() << "`\n\n" << shown(to_markdown(answer, format.details));
  else if (!format.csv.empty())
    std::cout << shown(to_csv(answer, format.csv == "true" ? "" : format.csv));
  else
    std::cout << to_text(answer, format.details, columns_of_output(),
                         [&](std::string_view part, Cell::Tone tone) {
                           const std::string safe = shown(std::string(part));
                           return colours ? coloured(safe, tone) : safe;
                         });
  std::cout << std::flush;
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

Answer answer_of(const Record& record, std::string kind) {
  Answer answer{std::move(kind), record.id};
  answer.add({"status"}, cell_of(record.status.kind).with(record.status.reason.text()));
  if (const std::string found = off_prediction(record); !found.empty())
    answer.add({"finding"}, found);
  if (record.status.step >= 0) answer.add({"step"}, record.status.step);
  if (record.status.vertex >= 0) answer.add({"vertex"}, record.status.vertex);
  answer.add({"steps"}, record.steps);
  answer.add({"dt", "time step", kTime, 6}, record.dt);
  answer.add({"vertices"}, record.vertices);
  answer.add({"links"}, record.links);
  answer.add({"projections", "projections per step"}, record.projections);
  answer.add({"digest", "final state"}, record.digest);
  for (const auto& [name, value] : record.values) {
    const Column column(name, name, unit_of_value(name), 6);
    answer.add(std::isnan(value) ? column.in_detail() : column, value);
  }
  answer.add(Column("key").in_detail(), record.key);
  return answer;
}

Progress::Progress(bool verbose)
    : start_(std::chrono::steady_clock::now()), terminal_(isatty(2) == 1), verbose_(verbose) {}

void show_progress(bool shown) { g_shown = shown; }

std::ostream& progress() {
  static std::ostream nowhere(nullptr);
  return g_shown ? std::cerr : nowhere;
}

Countdown::Countdown(std::string what)
    : what_(std::move(what)), terminal_(isatty(2) == 1), start_(std::chrono::steady_clock::now()) {}

void Countdown::operator()(std::size_t done, std::size_t total) const {
  if (done == 0) return;  // the time per part is not known yet
  if (!g_shown || (!terminal_ && done != total && done % std::max<std::size_t>(1, total / 10) != 0))
    return;
  const double each = seconds_since(start_) / static_cast<double>(done);
  std::cerr << (terminal_ ? "\r\033[K" : "") << what_ << formatted(" %zu/%zu  ", done, total)
            << (done < total ? "left " + clock_text(each * static_cast<double>(total - done))
                             : general(each, 2) + " s each");
  if (!terminal_ || done == total) std::cerr << '\n';
  std::cerr << std::flush;
}

void Progress::show(const CampaignProgress& campaign, const Record* record) {
  if (!g_shown) return;
  const std::string place =
      "[" + std::to_string(campaign.done()) + "/" + std::to_string(campaign.cases) + "] ";
  constexpr std::size_t kFew = 20;
  if (!terminal_ && (verbose_ || campaign.cases <= kFew)) {
    if (record) std::cerr << place << record->id << ": " << describe(record->status) << '\n';
    return;
  }
  const double elapsed = seconds_since(start_);
  if (record && (verbose_ || !record->status.is_result()))
    std::cerr << (terminal_ ? "\r\033[K" : "") << record->id << ": " << describe(record->status)
              << '\n';
  const double share = campaign.work > 0 ? campaign.work_done / campaign.work : 0;
  const auto tenth = static_cast<std::size_t>(10 * share + 1e-9);
  if (!terminal_ && tenth == told_) return;
  told_ = tenth;
  std::string left = "?";
  if (campaign.work_done > 0)
    left = clock_text(elapsed * (campaign.work - campaign.work_done) / campaign.work_done);
  std::cerr << (terminal_ ? "\r\033[K" : "") << place << counts(campaign) << "  elapsed "
            << clock_text(elapsed) << "  left " << left << (terminal_ ? "" : "\n") << std::flush;
}

std::function<TimingOptions(const std::string&, std::size_t)> tell_timing(TimingOptions options) {
  return [options](const std::string& scene, std::size_t cases) {
    progress() << scene << ": timing " << cases << " cases\n";
    TimingOptions counted = options;
    counted.progress = Countdown("timing round");
    return counted;
  };
}

std::function<void(const CampaignProgress&, const Record*)> show_ended_cases() {
  return [shown = Progress()](const CampaignProgress& campaign, const Record* record) mutable {
    if (record) shown.show(campaign, record);
  };
}

void Progress::finish(const CampaignProgress& campaign) {
  if (!g_shown) return;
  if (terminal_) std::cerr << "\r\033[K";
  std::cerr << campaign.done() << "/" << campaign.cases << " cases: " << counts(campaign) << " ("
            << campaign.reused << " were stored already)\n";
}

CampaignProgress run_missing(const std::vector<StudyCases>& studies, Store& store,
                             const std::string& command, CampaignOptions options, bool verbose) {
  store.begin_session(command, studies, options.shard);
  std::vector<Case> cases;
  for (const StudyCases& study : studies)
    cases.insert(cases.end(), study.cases.begin(), study.cases.end());
  std::ranges::stable_sort(cases, {}, &Case::key);
  const auto same = [](const Case& a, const Case& b) { return a.key == b.key; };
  cases.erase(std::unique(cases.begin(), cases.end(), same), cases.end());
  Progress display(verbose);
  options.progress = [&](const CampaignProgress& t, const Record* r) { display.show(t, r); };
  const CampaignProgress campaign = run_cases(cases, store, options);
  display.finish(campaign);
  return campaign;
}

std::vector<Record> run_and_collect(const StudyCases& study, Store& store,
                                    const std::string& command) {
  store.prepare();
  const int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  if (run_missing({study}, store, command, {.jobs = jobs}).interrupted) throw Interrupted();
  std::vector<Record> records;
  for (const Case& one : study.cases)
    if (auto record = store.find(one)) records.push_back(std::move(*record));
  return records;
}

int exit_code(const CampaignProgress& campaign, const Store& store) {
  if (campaign.conflicts > 0)
    std::cerr << campaign.conflicts << " cases gave another result than the one stored: see "
              << "table conflicts of " << store.file().string() << '\n';
  if (campaign.interrupted) return kInterrupted;
  if (campaign.conflicts > 0) return kConflict;
  return campaign.ended_from_outside > 0 ? kIncomplete : kPass;
}

int exit_code(CheckEnd end) {
  switch (end) {
    case CheckEnd::passed:
      return kPass;
    case CheckEnd::not_run:
      return kIncomplete;
    case CheckEnd::nothing:
      return kNothing;
    case CheckEnd::moved:
      return kRegression;
    case CheckEnd::environment:
      return kEnvironment;
    case CheckEnd::conflict:
      return kConflict;
    case CheckEnd::interrupted:
      return kInterrupted;
  }
  return kUsage;
}

}  // namespace taut
