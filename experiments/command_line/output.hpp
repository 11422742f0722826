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

enum class Colour { red = 31, green = 32, yellow = 33 };

/// The text in a colour if stdout is a terminal and $NO_COLOR is not set; else as it is.
std::string coloured(std::string_view text, Colour);

/// How an answer is printed: add_format().
struct Format {
  bool json = false, markdown = false;
  std::string csv;       ///< the table; "true": the first; "": no CSV
  bool details = false;  ///< people see all that the data have

  /// Whether it is for programs: standard output then holds nothing else.
  bool is_data() const { return json || markdown || !csv.empty(); }
};

/// Prints the answer on stdout: on a terminal verdicts in colour; as Markdown with the command that
/// makes it. Throws InputError: no such table.
void print(const Answer&, const Format&);

/// The files that a verb wrote: a line each, or {"files": [...]}.
void print_files(const std::vector<std::string>& files, bool json);

/// What ran, how it ended, every value that has a meaning.
Answer answer_of(const Record&, std::string kind);

/// Shows a campaign on stderr: one line that is rewritten, with the time left, on a terminal; else
/// a line for every tenth part, and one per case if there are few or all are asked for.
class Progress {
 public:
  explicit Progress(bool verbose = false);
  void show(const CampaignProgress&, const Record*);
  void finish(const CampaignProgress&);  ///< the last line: how the cases ended

 private:
  std::chrono::steady_clock::time_point start_;
  bool terminal_, verbose_;
  std::size_t told_ = 0;  ///< tenths of the work
};
/// A campaign's `progress` that shows it as each case ends.
std::function<void(const CampaignProgress&, const Record*)> show_ended_cases();

/// Runs what the store lacks, each case once, in a session that `command` names, with progress on
/// stderr.
CampaignProgress run_missing(const std::vector<StudyCases>&, Store&, const std::string& command,
                             CampaignOptions, bool verbose = false);

/// The same on all cores, and what is then stored of each case. Throws InputError, Interrupted.
std::vector<Record> run_and_collect(const StudyCases&, Store&, const std::string& command);

/// The exit code of a campaign; says where the results are that differ from those stored.
int exit_code(const CampaignProgress&, const Store&);
/// The exit code of a comparison with baselines.
int exit_code(CheckEnd);

/// "frame 12/80  left 0:14" on stderr, rewritten on a terminal; every tenth part elsewhere. The end
/// says what one took: "frame 80/80  0.15 s each".
class Countdown {
 public:
  explicit Countdown(std::string what);
  void operator()(std::size_t done, std::size_t total) const;

 private:
  std::string what_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_;
};

/// What bench_study() asks before each scene: these options, with a line for the scene and a
/// countdown of its rounds.
std::function<TimingOptions(const std::string& scene, std::size_t cases)> tell_timing(
    TimingOptions);

/// Whether progress is shown; --quiet switches it off.
void show_progress(bool);
/// Where news of progress go: stderr, or nowhere.
std::ostream& progress();

/// "ok 88, exploded 4".
std::string counts(const CampaignProgress&);

}  // namespace taut
