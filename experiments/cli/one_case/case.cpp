#include <cmath>
#include <new>
#include <optional>

#include "core/io/positions/positions.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/command_line/verb.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/files.hpp"

namespace taut::verb::one_case {

namespace {

struct Options {
  CaseOptions which;
  bool json = false, verbose = false;
  int frames = 0;
  std::string final_state, trajectory, series, into;
};

void tell(const Snapshot& m, int steps) {
  if (m.step % std::max(1, steps / 20) != 0) return;
  double fastest = 0;
  for (const Vec3& v : m.state.v) fastest = std::max(fastest, v.norm());
  std::cerr << "step " << m.step << "/" << steps << "  t " << general(m.t, 6)
            << " s  fastest vertex " << general(fastest, 6) << " m/s\n";
}

/// Reports the progress of a run that takes over ten seconds, and how long it will last.
class SlowRun {
 public:
  explicit SlowRun(int steps) : steps_(steps) {}
  void at(int step) {
    const double spent = seconds_since(start_);
    if (step == 0 || spent < next_) return;
    next_ = spent + 10;
    const double left = spent / step * (steps_ - step);
    if (spent + left > 10)
      progress() << "step " << step << "/" << steps_ << ", about " << std::lround(left)
                 << " s left\n";
  }

 private:
  int steps_;
  SteadyClock::time_point start_ = SteadyClock::now();
  double next_ = 2;  ///< when to report next [s since the start]
};

/// Writes the requested files, but none for a case of which nothing was computed.
void write_files(const CaseRun& result, const Options& options) {
  if (!result.computed()) {
    std::cerr << result.record.id << ": " << describe(result.record.status) << '\n';
    return;
  }
  if (!options.final_state.empty()) write_durably(options.final_state, to_csv(result.last));
  if (!options.series.empty()) write_durably(options.series, to_csv(result.series));
}

int run(const Options& options) try {
  const Case one = options.which.make();
  continue_in_right_program(one.choice);
  if (!options.into.empty()) return run_into(one, options.into, options.frames);

  tell_remarks(one.remarks);
  for (const std::string& file : {options.final_state, options.series, options.trajectory})
    if (!file.empty()) test_writable(file);
  if (!options.trajectory.empty()) check_positions_name(options.trajectory);
  std::unique_ptr<PositionWriter> motion;  // created with the first state, which may not exist
  SlowRun slow(one.scene->steps);
  const CaseRun result = run_case(
      one,
      {.series_rows = options.series.empty() ? 0 : kSeriesRows, .watch = [&](const Snapshot& m) {
         if (!options.trajectory.empty() && !motion)
           motion = create_positions(options.trajectory, one.scene->mesh);
         if (motion) motion->append(m.t, m.state.x);
         slow.at(m.step);
         if (options.verbose) tell(m, one.scene->steps);
       }});
  write_files(result, options);
  if (options.json)
    std::cout << to_json(result.record, 2) << '\n';
  else
    print(answer_of(result.record, "case"), {});
  if (options.verbose)
    for (const ResolvedSetting& setting : result.record.resolved_settings)
      std::cerr << setting.name << ": " << setting.text << '\n';
  return result.record.status.is_result() ? kPass : kRegression;
} catch (const std::bad_alloc&) {  // thrown while the scene was read
  if (options.into.empty()) throw;
  return kOutOfMemory;
}

void add_options(Arguments& args, Options& options) {
  options.which.bind(args);
  args.add_flag("--json", options.json, "Print the record as JSON");
  args.add_option("--final-state", options.final_state,
                  "Write vertex,x,y,z,vx,vy,vz of the last stable state, full precision (CSV)");
  args.add_option("--trajectory", options.trajectory,
                  "Write every step's positions: .npy, .pc2, or .obj, a file a step");
  args.add_option("--series", options.series, "Write values over time (CSV)");
  args.add_flag("--verbose", options.verbose,
                "Show progress and the solver's resolved settings on stderr");
  args.add_option(own_words::kInto, options.into, "Used by taut run").hidden();
  args.add_option(own_words::kFrames, options.frames, "Used with --into").hidden();
}

}  // namespace
}  // namespace taut::verb::one_case

TAUT_VERB(case) = {
    .name = own_words::kCase,
    .group = VerbGroup::one_case,
    .summary = "Runs one case in this process; a numerical failure is a result (exit 0)",
    .example =
        "taut case hang jakobsen:iterations=1,substeps=15 --dt 1/120 --final-state hang.csv\n"
        "Exit: 0 a result, whatever its status; 1 an external program failed",
    .bind = taut::bind_verb<taut::verb::one_case::add_options, taut::verb::one_case::run>};
