#include "experiments/film/recorded_runs.hpp"

#include <memory>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/settings.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"

namespace taut {

namespace {

namespace fs = std::filesystem;

/// "#0B6BCB"
Rgb8 colour_of(std::string_view hex) {
  return rgb(static_cast<std::uint32_t>(std::stoul(std::string(hex.substr(1)), nullptr, 16)));
}

/// `taut case` in a process of its own: what crashes or hangs there costs one panel, and Bullet's
/// float build gets the program that it needs.
class CaseProcess {
 public:
  CaseProcess(const RunRequest& request, const SolverChoice& choice, const fs::path& trajectory)
      : trajectory_(trajectory),
        process_(command(request, choice, trajectory),
                 {.output = ProcessOptions::Stream::piped,
                  .errors = ProcessOptions::Stream::inherited}) {}

  /// Waits; gives how the case ended.
  Status finish() {
    const std::string json = process_.read_all(kSeconds);
    const auto end = process_.wait(0.1);
    if (end && end->good()) return record_from_json(json, "taut case").status;
    if (!end) return {Status::Kind::timeout, "600 s"};
    return {Status::Kind::crash, "the case's process ended early"};
  }
  const fs::path& trajectory() const { return trajectory_; }
  Series series() const {
    return fs::exists(table(trajectory_)) ? series_from_csv(read_text(table(trajectory_)))
                                          : Series{};
  }

 private:
  static constexpr double kSeconds = 600;
  static fs::path table(fs::path trajectory) { return trajectory.replace_extension(".csv"); }
  static std::vector<std::string> command(const RunRequest& request, const SolverChoice& choice,
                                          const fs::path& trajectory) {
    const std::string program(choice.entry->program ? choice.entry->program(choice.params) : "");
    std::vector<std::string> words{sibling_program(program), "case", request.scene,
                                   choice.canonical()};
    for (const std::string& value : request.overrides) words.insert(words.end(), {"--set", value});
    words.insert(words.end(),
                 {"--json", "--trajectory", trajectory, "--series", table(trajectory)});
    return words;
  }
  fs::path trajectory_;
  Process process_;
};

RecordedRun record_run(const Scene& scene, const SolverChoice& choice, CaseProcess& process) {
  const Status status = process.finish();
  if (status.kind == Status::Kind::unsupported)
    throw InputError(choice.brief() + " cannot run " + scene.name + ": " + status.reason);
  if (!fs::exists(process.trajectory()))
    throw InputError(choice.brief() + " left no trajectory of " + scene.name + ": " +
                     std::string(to_string(status.kind)) + ", " + status.reason);
  RecordedRun run = recorded_run(scene, read_trajectory(process.trajectory()));
  if (run.stop && status.kind != Status::Kind::ok) run.stop->why = to_string(status.kind);
  run.title = report::solver_title(choice.entry->name);
  run.settings = report::brief_settings(choice.canonical());
  return run;
}

/// What a file holds, under the name of the solver that it says made it.
RecordedRun stored_run(const Scene& scene, const std::string& file) {
  Trajectory trajectory = read_trajectory(file);
  const TrajectoryHeader& header = trajectory.header;
  if (header.vertices != scene.mesh.size())
    throw InputError(
        {{file, 0, 0,
          "a trajectory of '" + header.scene + "' with " + std::to_string(header.vertices) +
              " vertices; " + scene.name + " has " + std::to_string(scene.mesh.size())}});
  RecordedRun run = recorded_run(scene, std::move(trajectory));
  const std::string& solver = run.trajectory.header.solver;
  const std::string name = solver.substr(0, solver.find(':'));
  run.title = report::solver_title(name);
  run.settings = report::brief_settings(solver);
  run.colour = colour_of(report::solver_style(name).colour.light);
  return run;
}

}  // namespace

RunSet record_runs(const RunRequest& request, const std::function<void(const std::string&)>& say) {
  std::vector<SolverChoice> choices;
  for (const std::string& solver : request.solvers) choices.push_back(parse_solver(solver));
  RunSet set{load_scene(find_scene(request.scene), request.overrides), {}};
  const Scratch scratch;
  std::vector<std::unique_ptr<CaseProcess>> processes;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    say("running " + choices[k].brief() + " on " + set.scene.name);
    processes.push_back(std::make_unique<CaseProcess>(
        request, choices[k], scratch.path() / (std::to_string(k) + ".traj")));
  }
  for (std::size_t k = 0; k < choices.size(); ++k) {
    RecordedRun& run = set.runs.emplace_back(record_run(set.scene, choices[k], *processes[k]));
    run.colour = colour_of(report::solver_style(choices[k].entry->name).colour.light);
    set.series.push_back(processes[k]->series());
  }
  for (const std::string& file : request.files) set.runs.push_back(stored_run(set.scene, file));
  return set;
}

}  // namespace taut
