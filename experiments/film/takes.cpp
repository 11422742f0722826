#include "experiments/film/takes.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/palette.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

namespace fs = std::filesystem;

/// "#0B6BCB"
Rgb8 colour_of(std::string_view hex) {
  return rgb(static_cast<std::uint32_t>(std::stoul(std::string(hex.substr(1)), nullptr, 16)));
}

/// The work of a step, sweeps and substeps, and what else tells this choice from the defaults.
/// Defaults differ between solvers: of work nothing goes without saying.
std::string caption_settings(const SolverChoice& choice) {
  std::string settings;
  for (const ParamSpec& spec : choice.params.specs()) {
    const std::string_view value = choice.params.value(spec.name);
    if (spec.name == "iterations" || spec.name == "substeps" || value != spec.default_value)
      settings +=
          (settings.empty() ? ":" : ",") + std::string(spec.name) + "=" + std::string(value);
  }
  return readable_settings(settings);
}

/// The same of a text that some program wrote: as it stands if this one knows no such solver.
std::string caption_settings(const std::string& solver) try {
  return caption_settings(parse_solver(solver));
} catch (const InputError&) {
  return readable_settings(solver);
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// A folder of this process's own, gone with it.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "taut_takes_XXXXXX").string();
    if (!mkdtemp(name.data())) throw InputError("cannot make a folder in " + name);
    folder_ = name;
  }
  ~Scratch() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fs::path file(std::size_t k) const { return folder_ / (std::to_string(k) + ".traj"); }

 private:
  fs::path folder_;
};

/// `taut case` in a process of its own: what crashes or hangs there costs one panel, and Bullet's
/// float build gets the program that it needs.
class CaseProcess {
 public:
  CaseProcess(const TakeRequest& request, const SolverChoice& choice, const fs::path& trajectory)
      : trajectory_(trajectory) {
    const std::string program(choice.entry->program ? choice.entry->program(choice.params) : "");
    std::string command = "exec timeout 600 " + quoted(sibling_program(program).string()) +
                          " case " + quoted(request.scene) + " " + quoted(choice.canonical());
    for (const std::string& value : request.overrides) command += " --set " + quoted(value);
    command += " --json --trajectory " + quoted(trajectory.string());
    pipe_ = popen(command.c_str(), "r");
  }
  ~CaseProcess() {
    if (pipe_) pclose(pipe_);
  }
  CaseProcess(const CaseProcess&) = delete;
  CaseProcess& operator=(const CaseProcess&) = delete;

  /// Waits; gives how the case ended.
  Status finish() {
    std::string json;
    char piece[4096];
    while (const std::size_t got = pipe_ ? std::fread(piece, 1, sizeof piece, pipe_) : 0)
      json.append(piece, got);
    const int ended = pipe_ ? pclose(pipe_) : -1;
    pipe_ = nullptr;
    if (ended == 0) return record_from_json(json, "taut case").status;
    if (WIFEXITED(ended) && WEXITSTATUS(ended) == 124) return {Status::Kind::timeout, "600 s"};
    return {Status::Kind::crash, "the case's process ended early"};
  }
  const fs::path& trajectory() const { return trajectory_; }

 private:
  fs::path trajectory_;
  FILE* pipe_ = nullptr;
};

Take make_take(const Scene& scene, const SolverChoice& choice, CaseProcess& process) {
  const Status status = process.finish();
  if (status.kind == Status::Kind::unsupported)
    throw InputError(choice.brief() + " cannot run " + scene.name + ": " + status.reason);
  if (!fs::exists(process.trajectory()))
    throw InputError(choice.brief() + " left no trajectory of " + scene.name + ": " +
                     std::string(to_string(status.kind)) + ", " + status.reason);
  Take take = take_of(scene, read_trajectory(process.trajectory()));
  if (take.stop && status.kind != Status::Kind::ok) take.stop->why = to_string(status.kind);
  take.title = report::solver_title(choice.entry->name);
  take.settings = caption_settings(choice);
  return take;
}

/// What a file holds, under the name of the solver that it says made it.
Take stored_take(const Scene& scene, const std::string& file) {
  Trajectory trajectory = read_trajectory(file);
  const TrajectoryHeader& header = trajectory.header;
  if (header.vertices != scene.mesh.size())
    throw InputError(
        {{file, 0, 0,
          "a trajectory of '" + header.scene + "' with " + std::to_string(header.vertices) +
              " vertices; " + scene.name + " has " + std::to_string(scene.mesh.size())}});
  Take take = take_of(scene, std::move(trajectory));
  const std::string& solver = take.trajectory.header.solver;
  const std::string name = solver.substr(0, solver.find(':'));
  take.title = report::solver_title(name);
  take.settings = caption_settings(solver);
  take.colour = colour_of(report::solver_style(name).colour.light);
  return take;
}

}  // namespace

TakeSet make_takes(const TakeRequest& request, const std::function<void(const std::string&)>& say) {
  std::vector<SolverChoice> choices;
  for (const std::string& solver : request.solvers) choices.push_back(parse_solver(solver));
  TakeSet set{load_scene(find_scene(request.scene), request.overrides), {}};
  const Scratch scratch;
  std::vector<std::unique_ptr<CaseProcess>> processes;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    say("running " + choices[k].brief() + " on " + set.scene.name);
    processes.push_back(std::make_unique<CaseProcess>(request, choices[k], scratch.file(k)));
  }
  for (std::size_t k = 0; k < choices.size(); ++k) {
    Take& take = set.takes.emplace_back(make_take(set.scene, choices[k], *processes[k]));
    take.colour = colour_of(report::solver_style(choices[k].entry->name).colour.light);
  }
  for (const std::string& file : request.files) set.takes.push_back(stored_take(set.scene, file));
  return set;
}

}  // namespace taut
