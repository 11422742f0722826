#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/check.hpp"
#include "experiments/case/record.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// Format of a printed answer; see add_format().
struct Format {
  bool json = false, markdown = false;
  std::string csv;       ///< name of the table; "true": the first one; "": no CSV
  bool details = false;  ///< whether people see everything that data contain

  /// Whether the output is for programs; standard output then contains nothing else.
  bool is_data() const { return json || markdown || !csv.empty(); }
};

/// Prints the answer on stdout: on a terminal with tones as colours unless $NO_COLOR is set, and as
/// Markdown with the command that makes it. Throws InputError if there is no such table.
void print(const Answer&, const Format&);

/// Prints the files that a verb wrote: one line each, or {"files": [...]}.
void print_files(const std::vector<std::string>& files, bool json);

/// The answer for one case: what ran, how it ended, and every meaningful value.
Answer answer_of(const Record&, std::string kind);

/// Shows a campaign on stderr. On a terminal, one line is rewritten and includes the time left.
/// Otherwise there is a line for every tenth of the work, and one per case if there are few or
/// `verbose` is set.
class Progress {
 public:
  explicit Progress(bool verbose = false);
  void show(const CampaignProgress&, const Record*);
  void finish(const CampaignProgress&);  ///< prints the last line: how the cases ended

 private:
  std::chrono::steady_clock::time_point start_;
  bool terminal_, verbose_;
  std::size_t told_ = 0;  ///< tenths of the work reported so far
};
/// A `progress` function for a campaign that reports each case as it ends.
std::function<void(const CampaignProgress&, const Record*)> show_ended_cases();

/// Runs the cases that the store lacks, each once, in a session with this command. Shows progress
/// on stderr.
CampaignProgress run_missing(const std::vector<StudyCases>&, Store&, const std::string& command,
                             CampaignOptions, bool verbose = false);

/// run_missing() on all cores. Returns the stored records. Throws InputError, Interrupted.
std::vector<Record> run_and_collect(const StudyCases&, Store&, const std::string& command);

/// Exit code of a campaign. If results differ from stored ones, reports where they are.
int exit_code(const CampaignProgress&, const Store&);
/// Exit code of a comparison with baselines.
int exit_code(CheckEnd);

/// Shows "frame 12/80  left 0:14" on stderr, rewritten on a terminal, otherwise for every tenth
/// part. The last line gives the time per part: "frame 80/80  0.15 s each".
class Countdown {
 public:
  explicit Countdown(std::string what);
  void operator()(std::size_t done, std::size_t total) const;

 private:
  std::string what_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_;
};

/// A function for bench_study() that prints a line for each scene and returns these options with a
/// countdown of its rounds.
std::function<TimingOptions(const std::string& scene, std::size_t cases)> tell_timing(
    TimingOptions);

/// Switches progress on or off; --quiet switches it off.
void show_progress(bool);
/// Stream for progress: stderr, or one that discards everything.
std::ostream& progress();

/// "ok 88, exploded 4".
std::string counts(const CampaignProgress&);

}  // namespace taut
