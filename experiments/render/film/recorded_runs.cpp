#include "experiments/render/film/recorded_runs.hpp"

#include <list>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace {

namespace fs = std::filesystem;

/// "#0B6BCB"
Rgb8 colour_of(std::string_view hex) {
  return rgb(static_cast<std::uint32_t>(std::stoul(std::string(hex.substr(1)), nullptr, 16)));
}

/// The motion of a case with the title, settings and colour of its solver.
RecordedRun shown_run(const Case& one, std::vector<Frame> frames) {
  RecordedRun run =
      recorded_run(*one.scene, {one.choice.canonical(), one.scene->dt, std::move(frames)});
  const std::string_view name = one.choice.entry->name;
  run.title = report::solver_title(name);
  run.settings = report::brief_settings(one.choice);
  run.colour = colour_of(report::solver_style(name).colour.light);
  return run;
}

RecordedRun finished_run(IsolatedCase& process) {
  const Case& one = process.of();
  const Status status = process.wait().status;
  if (status.kind == Status::Kind::unsupported)
    throw InputError(one.choice.brief() + " cannot run " + one.scene->name + ": " +
                     status.reason.text());
  const fs::path motion = process.folder() / kFramesFile;
  if (!fs::exists(motion))
    throw InputError(one.choice.brief() + " left no motion of " + one.scene->name + ": " +
                     std::string(to_string(status.kind)) + ", " + status.reason.text());
  RecordedRun run = shown_run(one, frames_in(read_text(motion), one.scene->mesh.size()));
  if (run.stop && status.kind != Status::Kind::ok) run.stop->why = to_string(status.kind);
  return run;
}

}  // namespace

RunSet record_runs(const RunRequest& request, const std::function<void(const std::string&)>& say) {
  RunSet set{load_scene(find_scene(request.scene), request.settings), {}};
  const Scratch scratch;
  CaseMaker maker;
  std::list<IsolatedCase> processes;
  for (const std::string& solver : request.solvers) {
    const Case one = maker.make({request.scene, request.settings, solver});
    say("running " + one.choice.brief() + " on " + set.scene.name);
    const fs::path folder = scratch.path() / std::to_string(processes.size());
    make_folder(folder);
    processes.emplace_back(one, folder, Limits{.seconds = 600, .bytes = 0}, set.scene.steps + 1);
  }
  for (IsolatedCase& process : processes) {
    set.runs.push_back(finished_run(process));
    const fs::path series = process.folder() / kSeriesFile;
    set.series.push_back(fs::exists(series) ? series_from_json(read_text(series), series.string())
                                            : Series{});
  }
  return set;
}

}  // namespace taut
