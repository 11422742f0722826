#include "experiments/python/runs.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/computed_motion.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/python/sourced_scene.hpp"
#include "experiments/python/unlocked.hpp"
#include "experiments/python/values.hpp"

namespace taut::python {

namespace {

/// Result of a run, in Python's types.
struct RunResult {
  Record record;
  double cpu_seconds = 0;
  py::array t, x;
  py::dict series;
  State last;
};

/// Keeps frames, and ends the run if a signal handler raises, as that of Ctrl-C does, or if Python
/// ends.
class Watcher {
 public:
  Watcher(int every, int steps) : every_(every), steps_(steps) {
    if (every < 0)
      throw InputError("every: " + std::to_string(every) +
                       "; must be 1 or more steps, or 0: keep no frames");
  }

  void see(const Snapshot& moment) {
    if (every_ > 0 && (moment.step % every_ == 0 || moment.step == steps_)) {
      t_.push_back(moment.t);
      for (const Vec3& x : moment.state.x) x_.insert(x_.end(), x.begin(), x.end());
    }
    leave_if_python_ends();
    const auto now = std::chrono::steady_clock::now();
    if (now - checked_ < std::chrono::milliseconds(50)) return;
    checked_ = now;
    const py::gil_scoped_acquire own;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

  RunResult result(CaseRun&& run, int vertices) {
    RunResult result{std::move(run.record), run.cpu_seconds, {}, {}, {}, std::move(run.last)};
    const auto frames = static_cast<py::ssize_t>(t_.size());
    result.t = owned(std::move(t_), {frames});
    result.x = owned(std::move(x_), {frames, vertices, 3});
    for (std::size_t c = 0; c < run.series.columns.size(); ++c) {
      std::vector<double> column;
      for (const std::vector<double>& row : run.series.rows) column.push_back(row[c]);
      result.series[text_of(run.series.columns[c])] = array_of(column);
    }
    return result;
  }

 private:
  int every_, steps_;
  std::vector<double> t_, x_;
  std::chrono::steady_clock::time_point checked_ = std::chrono::steady_clock::now();
};

/// Calls run(options) without the interpreter's lock.
template <class Run>
RunResult watched(const Scene& scene, int every, const Run& run) {
  Watcher watcher(every, scene.steps);
  const RunOptions options{
      .every = every, .timed = true, .watch = [&](const Snapshot& moment) { watcher.see(moment); }};
  std::optional<CaseRun> done;
  {
    const Unlocked others_run;
    done = run(options);
  }
  return watcher.result(std::move(*done), scene.mesh.size());
}

/// Frames from a file, or from an array, which has to outlive them.
ComputedFrames frames_of(const py::object& positions, const py::array& array) {
  ComputedFrames frames{.name = "positions"};
  if (!array) {
    const auto file = py::cast<std::filesystem::path>(positions);
    frames.name = file.string();
    frames.positions = open_positions(file);
    return frames;
  }
  const auto size = static_cast<std::size_t>(array.size()),
             n = static_cast<std::size_t>(array.shape(1));
  if (array.itemsize() == 4)
    frames.positions =
        positions_in(std::span(static_cast<const float*>(array.data()), size), n, frames.name);
  else
    frames.positions =
        positions_in(std::span(static_cast<const double*>(array.data()), size), n, frames.name);
  return frames;
}

/// Throws InputError that names the first frame and vertex with a coordinate that is not finite.
void check_finite(PositionReader& positions) {
  for (int k = 0; k < positions.header().frames; ++k) {
    const std::vector<Vec3> x = positions.read(k);
    const auto bad = std::ranges::find_if_not(x, [](const Vec3& v) { return v.allFinite(); });
    if (bad == x.end()) continue;
    throw InputError("positions: frame " + std::to_string(k) + ", vertex " +
                     std::to_string(bad - x.begin()) +
                     " is not finite; allow_nan=True scores it as a run that exploded there");
  }
}

RunResult simulate(const py::object& scene, const std::string& solver, const py::object& dt,
                   const py::object& duration, int every) {
  const SourcedScene timed = timed_scene(scene, dt, duration);
  const Case one = case_of(timed.spec(), timed.scene, parse_solver(solver));
  return watched(*one.scene, every,
                 [&](const RunOptions& options) { return run_case(one, options); });
}

RunResult score(const py::object& scene, const py::object& positions, const py::object& fps,
                const py::object& scale, const std::string& up, const py::object& rest, int every,
                bool allow_nan) {
  const SourcedScene given = timed_scene(scene, py::none(), py::none());
  const bool is_file = py::isinstance<py::str>(positions) || py::hasattr(positions, "__fspath__");
  py::array array = py::reinterpret_steal<py::array>(py::handle());
  Doubles at_rest;
  if (!is_file) {
    const std::string n = std::to_string(given.scene->mesh.size());
    array = points_of(positions, "positions", 3, given.scene->mesh.size(),
                      "(frames, " + n + ", 3) for this scene", true);
    array = array.attr("astype")(array.itemsize() == 4 ? "float32" : "float64",
                                 py::arg("order") = "C", py::arg("copy") = false);
  }
  if (!is_file && array.shape(0) < 2)
    throw InputError("positions: " + std::to_string(array.shape(0)) +
                     " frames; a motion has two at least, the start and what follows");
  ComputedFrames frames = frames_of(positions, array);
  if (!fps.is_none()) frames.fps = above_zero(fps, "fps");
  frames.scale = above_zero(scale, "scale");
  if (up != "y" && up != "z") throw InputError("up: '" + up + "'; must be 'y' or 'z'");
  frames.z_up = up == "z";
  if (!rest.is_none()) {
    at_rest = Doubles(points_of(rest, "rest", 2, given.scene->mesh.size(),
                                "(" + std::to_string(given.scene->mesh.size()) + ", 3)"));
    frames.rest = positions_in(std::span(static_cast<const double*>(at_rest.data()),
                                         static_cast<std::size_t>(at_rest.size())),
                               static_cast<std::size_t>(at_rest.shape(0)), "rest");
  }
  if (!is_file && !allow_nan) check_finite(*frames.positions);
  const auto load = [&](const SceneSettings& with) { return given.read(with); };
  const Scene timed = load(fitted(load, given.settings, frames));
  return watched(timed, every,
                 [&](const RunOptions& options) { return taut::score(timed, frames, options); });
}

std::string about(const RunResult& r) {
  return "<taut.Run " + r.record.scene + " " + r.record.spec.solver + ": " +
         describe(r.record.status) + ", " + std::to_string(r.t.size()) + " frames>";
}

}  // namespace

void define_run(py::module_& m) {
  py::class_<RunResult> run(m, "Run", doc::kRun);
  run.def("__repr__", [](const RunResult& r) { return text_of(about(r)); })
      .def_property_readonly(
          "status", [](const RunResult& r) { return text_of(to_string(r.record.status.kind)); },
          "'ok', 'exploded', 'unsettled', 'extreme' or 'unsupported' (GLOSSARY.md).")
      .def_property_readonly(
          "verdict", [](const RunResult& r) { return text_of(describe(r.record.status)); },
          "The status with its reason, step and vertex: 'exploded (energy) at step 12, vertex 3'.")
      .def_property_readonly(
          "values", [](const RunResult& r) { return r.record.values; },
          "Every metric's values by name, in SI units (taut.metrics()); NaN: no meaning here.")
      .def_readonly("t", &RunResult::t, "(T,) s: the times of the frames.")
      .def_readonly("x", &RunResult::x,
                    "(T, n, 3) float64 m: the positions in the frames, up to the last stable one.")
      .def_readonly("series", &RunResult::series,
                    "Arrays (T,) by name: 'step', 't' and each value that has a meaning at a "
                    "moment, at the times of the frames.")
      .def_property_readonly(
          "x_end", [](const RunResult& r) { return array_of(r.last.x); },
          "(n, 3) m: positions after the last stable step; (0, 3): nothing was computed. A copy.")
      .def_property_readonly(
          "v_end", [](const RunResult& r) { return array_of(r.last.v); },
          "(n, 3) m/s: velocities after the last stable step. A copy.")
      .def_readonly("cpu_seconds", &RunResult::cpu_seconds,
                    "s: CPU time of all threads of this process during all steps: a first "
                    "impression; `taut bench` measures. NaN for positions.")
      .def_property_readonly(
          "record",
          [](const RunResult& r) {
            return py::module_::import("json").attr("loads")(text_of(to_json(r.record)));
          },
          "The record that a results file keeps, as `taut case --json` prints it: a dict.");

  m.def("simulate", simulate, py::arg("scene"), py::arg("solver") = "jakobsen", py::kw_only(),
        py::arg("dt") = py::none(), py::arg("duration") = py::none(), py::arg("every") = 1,
        doc::kSimulate);
  m.def("score", score, py::arg("scene"), py::arg("positions"), py::kw_only(),
        py::arg("fps") = py::none(), py::arg("scale") = 1.0, py::arg("up") = "y",
        py::arg("rest") = py::none(), py::arg("every") = 1, py::arg("allow_nan") = false,
        doc::kScore);
}

}  // namespace taut::python
