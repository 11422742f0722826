// The Python module taut._taut: what experiments/python/taut offers, on the library's public
// headers. No physics and no metrics here: scenes are read, solvers stepped and motions judged by
// the library.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/positions/positions.hpp"
#include "core/io/scene_io.hpp"
#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/computed_motion.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/system/data.hpp"

namespace py = pybind11;

namespace taut::python {
namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

// ---- Texts, arrays and what is wrong with them

/// Text from outside may be anything; what is no UTF-8 comes as Python has it in file names.
py::str text_of(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

std::string type_of(py::handle value) {
  return py::cast<std::string>(py::type::of(value).attr("__name__"));
}

/// "(121, 256, 3)".
std::string shape_of(const py::array& array) {
  return py::cast<std::string>(py::repr(array.attr("shape")));
}

/// The value as an array of numbers of this many dimensions that ends with [count][3]. Throws
/// InputError that names `what`, its type and shape; `floats` refuses integers, too.
py::array points_of(py::handle value, const std::string& what, py::ssize_t dimensions,
                    std::optional<py::ssize_t> count, const std::string& wanted,
                    bool floats = false) {
  const py::array array = py::array::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw InputError(what + ": a " + type_of(value) + "; must be an array " + wanted);
  }
  const char kind = array.dtype().kind();
  if (kind == 'O' && !py::isinstance<py::array>(value))
    throw InputError(what + ": a " + type_of(value) + "; must be an array " + wanted);
  const std::string dtype = py::cast<std::string>(py::str(array.dtype()));
  if (floats ? kind != 'f' || (array.itemsize() != 4 && array.itemsize() != 8)
             : kind != 'f' && kind != 'i' && kind != 'u')
    throw InputError(what + ": an array of " + dtype + "; must be of float64" +
                     (floats ? " or float32" : "") + ", " + wanted);
  if (array.ndim() != dimensions || array.shape(dimensions - 1) != 3 ||
      (count && array.shape(dimensions - 2) != *count))
    throw InputError(what + ": an array of shape " + shape_of(array) + "; must be " + wanted);
  return array;
}

py::array array_of(const std::vector<Vec3>& vectors) {
  return Doubles({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}},
                 reinterpret_cast<const double*>(vectors.data()));
}

py::array array_of(const std::vector<double>& values) {
  return Doubles(static_cast<py::ssize_t>(values.size()), values.data());
}

/// An array of this shape that owns the numbers: no copy.
py::array owned(std::vector<double>&& values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<double>>(std::move(values));
  const double* first = kept->data();
  const py::capsule owner(kept.get(),
                          [](void* all) { delete static_cast<std::vector<double>*>(all); });
  kept.release();
  return Doubles(std::move(shape), first, owner);
}

std::vector<Vec3> vectors_of(const Doubles& array) {
  const auto* first = reinterpret_cast<const Vec3*>(array.data());
  return {first, first + array.shape(0)};
}

/// As TOML has it. Throws InputError that names `key`.
std::string toml_of(py::handle value, const std::string& key) {
  const auto all = [&](py::handle list) {
    std::vector<std::string> parts;
    for (const py::handle part : list) parts.push_back(toml_of(part, key));
    return join(parts, ", ");
  };
  if (py::isinstance<py::bool_>(value)) return py::cast<bool>(value) ? "true" : "false";
  if (py::isinstance<py::str>(value))
    return py::cast<std::string>(
        py::module_::import("json").attr("dumps")(value, py::arg("ensure_ascii") = false));
  if (py::isinstance<py::int_>(value)) return py::cast<std::string>(py::str(value));
  if (py::isinstance<py::float_>(value)) return shortest(py::cast<double>(value));
  if (py::hasattr(value, "tolist")) return toml_of(value.attr("tolist")(), key);
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value))
    return "[" + all(value) + "]";
  if (py::isinstance<py::dict>(value)) {
    std::vector<std::string> parts;
    for (const auto& [name, part] : py::reinterpret_borrow<py::dict>(value))
      parts.push_back(toml_of(py::str(name), key) + " = " + toml_of(part, key));
    return "{ " + join(parts, ", ") + " }";
  }
  throw InputError("settings: '" + key + "' is a " + type_of(value) +
                   "; must be a number, a text, a bool, a list or a dict of them");
}

std::vector<std::string> overrides_of(const py::dict& settings) {
  std::vector<std::string> overrides;
  for (const auto& [name, value] : settings) {
    const auto key = py::cast<std::string>(py::str(name));
    overrides.push_back(key + "=" + toml_of(value, key));
  }
  return overrides;
}

// ---- Scenes

/// A scene with the place that it came from, so that it can be read again with other settings.
struct SourcedScene {
  std::string source;               ///< as given: a name, a path; of a text its name
  std::filesystem::path file;       ///< of a text: how messages call it
  std::optional<std::string> text;  ///< else it is in the file
  std::vector<std::string> overrides;
  std::shared_ptr<const Scene> scene;

  Scene read(const std::vector<std::string>& with) const {
    return text ? parse_scene(file, *text, with) : load_scene(file, with);
  }
  SourcedScene replaced(const std::vector<std::string>& more) const {
    if (file.empty())
      throw InputError("this scene is a solver's: make other ones of the scene that you gave");
    SourcedScene other = *this;
    for (const std::string& one : more) {
      const std::string key = one.substr(0, one.find('=') + 1);
      std::erase_if(other.overrides, [&](const std::string& old) { return old.starts_with(key); });
      other.overrides.push_back(one);
    }
    const py::gil_scoped_release others_run;
    other.scene = std::make_shared<const Scene>(read(other.overrides));
    return other;
  }
  CaseSpec spec() const { return {source, overrides, ""}; }
};

SourcedScene scene_from(py::handle source, const py::dict& settings, const std::string& name) {
  SourcedScene scene;
  if (!py::isinstance<py::str>(source) && !py::hasattr(source, "__fspath__"))
    throw InputError("scene: a " + type_of(source) +
                     "; must be a taut.Scene, a shipped name, a path or TOML text");
  scene.source = py::cast<std::string>(py::module_::import("os").attr("fspath")(source));
  if (scene.source.find('\n') != std::string::npos) {
    scene.text = std::exchange(scene.source, name);
    scene.file = name + ".toml";
  } else {
    const bool is_path = !py::isinstance<py::str>(source);
    scene.file =
        find_scene(is_path && scene.source.find('/') == std::string::npos ? "./" + scene.source
                                                                          : scene.source);
  }
  return scene.replaced(overrides_of(settings));
}

/// Any of what a function takes as a scene, with the time step and the duration that were said.
SourcedScene timed_scene(py::handle given, const py::object& dt, const py::object& duration) {
  py::dict times;
  if (!dt.is_none()) times["time.dt"] = dt;
  if (!duration.is_none()) times["time.duration"] = duration;
  if (!py::isinstance<SourcedScene>(given)) return scene_from(given, times, "scene");
  const auto& scene = py::cast<const SourcedScene&>(given);
  return times.empty() ? scene : scene.replaced(overrides_of(times));
}

/// What a solver has to do beyond gravity, links and fixed pins.
std::vector<std::string> effects(const Scene& scene) {
  std::vector<std::string> all;
  if (!scene.colliders.empty()) all.emplace_back("colliders");
  if (!scene.pin_motions.empty()) all.emplace_back("moving pins");
  if (scene.wind) all.emplace_back("wind");
  if (scene.bending) all.emplace_back("bending");
  if (scene.self_collision) all.emplace_back("self-collision");
  if (scene.damping > 0) all.emplace_back("damping");
  if (scene.stiffness != kRigid) all.emplace_back("elastic links");
  return all;
}

py::array pins_at(const Scene& scene, double t) {
  std::vector<Vec3> places;
  for (const int pin : scene.pins) places.push_back(pin_position(scene, pin, t));
  return array_of(places);
}

py::array_t<int> links_of(const Scene& scene) {
  py::array_t<int> pairs({static_cast<py::ssize_t>(scene.links.size()), py::ssize_t{2}});
  int* at = pairs.mutable_data();
  for (const Link& link : scene.links) {
    *at++ = link.a;
    *at++ = link.b;
  }
  return pairs;
}

/// Where each point is with respect to a collider.
py::tuple surface_at(const Scene& scene, std::size_t collider, const py::object& x, double t) {
  if (collider >= scene.colliders.size())
    throw InputError("collider: " + std::to_string(collider) + "; the scene has " +
                     std::to_string(scene.colliders.size()));
  const Doubles points(points_of(x, "x", 2, {}, "(n, 3)"));
  const Shape shape = shape_at(scene.colliders[collider], t);
  std::vector<double> distances;
  std::vector<Vec3> normals;
  for (const Vec3& point : vectors_of(points)) {
    const Surface at = surface(shape, point);
    distances.push_back(at.distance);
    normals.push_back(at.normal);
  }
  return py::make_tuple(array_of(distances), array_of(normals));
}

// ---- Runs

/// What a run left, as Python has it.
struct RunResult {
  Record record;
  double cpu_seconds = 0;
  py::array t, x;
  py::dict series;
  State last;
};

/// Keeps frames, and ends the run when a signal's handler raises, as Ctrl-C's does.
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
    const py::gil_scoped_release others_run;
    done = run(options);
  }
  return watcher.result(std::move(*done), scene.mesh.size());
}

RunResult simulate(const py::object& scene, const std::string& solver, const py::object& dt,
                   const py::object& duration, int every) {
  const SourcedScene timed = timed_scene(scene, dt, duration);
  const Case one = case_of(timed.spec(), timed.scene, parse_solver(solver));
  return watched(*one.scene, every,
                 [&](const RunOptions& options) { return run_case(one, options); });
}

/// Frames of a file, or of an array that must outlive them.
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

double above_zero(const py::object& value, const char* what) {
  const auto number = py::cast<double>(value);
  if (std::isfinite(number) && number > 0) return number;
  throw InputError(std::string(what) + ": " + shortest(number) + "; must be above 0");
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
  const auto load = [&](const std::vector<std::string>& with) { return given.read(with); };
  const Scene timed = load(fitted(load, given.overrides, frames));
  return watched(timed, every,
                 [&](const RunOptions& options) { return taut::score(timed, frames, options); });
}

// ---- Solvers of Python

/// A class of Python as an entry of solvers; lives as long as the program.
struct PythonEntry {
  std::deque<std::string> texts;  ///< what the entry's views point at
  std::vector<ParamSpec> params;
  SolverEntry entry;
};
std::deque<PythonEntry>& python_entries() {
  static auto* all = new std::deque<PythonEntry>;  // never ends: the interpreter may end before it
  return *all;
}

/// Names the solver and the method in an exception that is on its way out of it.
[[noreturn]] void rethrow_from(py::error_already_set& error, const std::string& where) {
  if (py::hasattr(error.value(), "add_note")) error.value().attr("add_note")("in " + where);
  throw;  // NOLINT: from the handlers below alone
}

class PythonSolver final : public Solver {
 public:
  /// The interpreter's lock is held.
  PythonSolver(py::object object, const Scene& scene, std::string name)
      : object_(std::move(object)), scene_(scene), name_("solver '" + std::move(name) + "'") {}
  ~PythonSolver() override {
    const py::gil_scoped_acquire own;
    object_ = py::object();
  }
  PythonSolver(const PythonSolver&) = delete;
  PythonSolver& operator=(const PythonSolver&) = delete;

  void load(const State& state) override {
    const py::gil_scoped_acquire own;
    const SourcedScene scene{scene_.name, {}, {}, {}, std::make_shared<const Scene>(scene_)};
    call("load()", [&] { object_.attr("load")(scene, array_of(state.x), array_of(state.v)); });
  }
  void step(double t, double dt) override {
    const py::gil_scoped_acquire own;
    call("step() at t = " + shortest(t) + " s", [&] { object_.attr("step")(t, dt); });
  }
  void store(State& state) const override {
    const py::gil_scoped_acquire own;
    call("store()", [&] {
      const py::object pair = object_.attr("store")();
      if (!py::isinstance<py::sequence>(pair) || py::len(pair) != 2)
        throw InputError(name_ + ": store() returned a " + type_of(pair) +
                         "; must be a pair of arrays, x and v");
      state.x = stored(pair[py::int_(0)], "x");
      state.v = stored(pair[py::int_(1)], "v");
    });
  }
  std::vector<PassCost> step_cost() const override { return {}; }

 private:
  template <class Call>
  void call(const std::string& what, const Call& of) const {
    try {
      of();
    } catch (py::error_already_set& error) {
      rethrow_from(error, what + " of " + name_);
    }
  }
  std::vector<Vec3> stored(const py::object& value, const char* what) const {
    const py::ssize_t n = scene_.mesh.size();
    return vectors_of(Doubles(points_of(value, name_ + ": store() returned as " + what, 2, n,
                                        "(" + std::to_string(n) + ", 3)")));
  }
  py::object object_;
  const Scene& scene_;
  std::string name_;
};

/// A parameter from its default: a number, a text, or a tuple of texts, the first being it.
ParamSpec param_of(const std::string& solver, std::string_view name, py::handle value,
                   std::deque<std::string>& texts) {
  const auto keep = [&](std::string text) -> std::string_view {
    return texts.emplace_back(std::move(text));
  };
  if (py::isinstance<py::int_>(value) && !py::isinstance<py::bool_>(value))
    return ParamSpec::integer(name, keep(py::cast<std::string>(py::repr(value))), -1e9, 1e9, "");
  if (py::isinstance<py::float_>(value))
    return ParamSpec::real(name, "", keep(shortest(py::cast<double>(value))), -1e300, 1e300, "");
  if (py::isinstance<py::str>(value))
    return {.name = name,
            .kind = ParamSpec::Kind::text,
            .default_value = keep(py::cast<std::string>(value))};
  if (py::isinstance<py::tuple>(value) && py::len(value) > 0) {
    std::vector<std::string> choices;
    for (const py::handle choice : value) choices.push_back(py::cast<std::string>(py::str(choice)));
    return ParamSpec::choice(name, keep(choices.front()), keep(join(choices, "|")), "");
  }
  throw InputError("solver '" + solver + "': parameter '" + std::string(name) + "' is a " +
                   type_of(value) +
                   "; must be a number, a text, or a tuple of texts to choose from");
}

py::object value_of(const Params& params, const ParamSpec& spec) {
  if (spec.kind == ParamSpec::Kind::integer) return py::int_(params.integer(spec.name));
  if (spec.kind == ParamSpec::Kind::real) return py::float_(params.real(spec.name));
  return text_of(params.value(spec.name));
}

SolverEntry entry_of(const py::object& type, const std::string& name, PythonEntry& into) {
  const auto keep = [&](std::string text) -> std::string_view {
    return into.texts.emplace_back(std::move(text));
  };
  const std::string from = py::cast<std::string>(type.attr("__module__")) + "." +
                           py::cast<std::string>(type.attr("__qualname__"));
  // A reference that is never given back: entries live as long as the program.
  const py::handle held = py::object(type).release();
  SolverEntry entry;
  entry.name = keep(name);
  entry.summary =
      keep(type.attr("__doc__").is_none() ? "A class of Python"
                                          : py::cast<std::string>(type.attr("__doc__")));
  entry.source = keep("Python class " + from);
  entry.implementation =
      keep("Python class " + from + ", " + std::to_string(python_entries().size()));
  entry.params = into.params;
  for (const ParamSpec& spec : into.params) {
    if (spec.name == "iterations") entry.accuracy.sweeps = spec.name;
    if (spec.name == "substeps") entry.accuracy.substeps = spec.name;
  }
  entry.make = [held, name](const Scene& scene, const Params& params) -> std::unique_ptr<Solver> {
    const py::gil_scoped_acquire own;
    py::object object = held();
    for (const ParamSpec& spec : params.specs())
      py::setattr(object, std::string(spec.name).c_str(), value_of(params, spec));
    return std::make_unique<PythonSolver>(std::move(object), scene, name);
  };
  entry.unsupported = [held, name](const Scene& scene, const Params&) -> std::vector<std::string> {
    const py::gil_scoped_acquire own;
    if (!py::hasattr(held, "unsupported")) return {};
    const SourcedScene given{scene.name, {}, {}, {}, std::make_shared<const Scene>(scene)};
    try {
      return py::cast<std::vector<std::string>>(held.attr("unsupported")(given));
    } catch (py::error_already_set& error) {
      rethrow_from(error, "unsupported() of solver '" + name + "'");
    } catch (const py::cast_error&) {
      throw InputError("solver '" + name + "': unsupported() must return a list of texts");
    }
  };
  entry.resolved_settings = [](const Scene&, const Params&) { return ResolvedSettings{}; };
  return entry;
}

void register_solver(const std::string& name, const py::object& type, const py::dict& parameters) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  };
  if (name.empty() || !std::ranges::all_of(name, plain))
    throw InputError("solver '" + name + "': a name has letters, digits, '-' and '_'");
  for (const SolverEntry* entry : solvers())
    if (entry->name == name)
      throw InputError("solver '" + name + "': taut has one of this name already");
  if (!PyType_Check(type.ptr()))
    throw InputError("solver '" + name + "': a " + type_of(type) + "; must be a class");
  for (const char* method : {"load", "step", "store"})
    if (!py::hasattr(type, method) || !PyCallable_Check(type.attr(method).ptr()))
      throw InputError("solver '" + name + "': class " +
                       py::cast<std::string>(type.attr("__qualname__")) + " has no method '" +
                       method + "'");
  PythonEntry made;
  for (const auto& [key, value] : parameters) {
    const std::string_view kept = made.texts.emplace_back(py::cast<std::string>(py::str(key)));
    if (!py::cast<bool>(py::str(key).attr("isidentifier")()) ||
        py::hasattr(type, made.texts.back().c_str()))
      throw InputError("solver '" + name + "': parameter '" + std::string(kept) +
                       "' cannot be an attribute of the class");
    made.params.push_back(param_of(name, kept, value, made.texts));
  }
  Params(name, made.params, "");  // defaults that no text could say are told now
  PythonEntry& entry = python_entries().emplace_back(std::move(made));
  entry.entry = entry_of(type, name, entry);
}

/// The last one of that name, so that a notebook's cell may be run again.
const SolverEntry* find_python_solver(std::string_view name, std::string_view) {
  for (auto one = python_entries().rbegin(); one != python_entries().rend(); ++one)
    if (one->entry.name == name) return &one->entry;
  return nullptr;
}

std::vector<std::string> python_solver_names() {
  std::vector<std::string> names;
  for (const PythonEntry& one : python_entries())
    if (find_python_solver(one.entry.name, "") == &one.entry) names.emplace_back(one.entry.name);
  return names;
}

// ---- What there is

py::list list_solvers() {
  py::list all;
  for (const SolverEntry* entry : all_solvers()) {
    py::list parameters;
    for (const ParamSpec& spec : entry->params) {
      py::dict one;
      one["name"] = text_of(spec.name);
      one["default"] = text_of(spec.default_value);
      one["unit"] = text_of(spec.unit);
      one["choices"] = py::cast(parts_of(spec.choices));
      one["help"] = text_of(spec.help);
      parameters.append(std::move(one));
    }
    py::dict one;
    one["name"] = text_of(entry->name);
    one["summary"] = text_of(entry->summary);
    one["source"] = text_of(entry->source);
    one["parameters"] = std::move(parameters);
    all.append(std::move(one));
  }
  return all;
}

py::list list_metrics() {
  py::list all;
  for (const MetricEntry* entry : metrics())
    for (const ValueSpec& spec : entry->values) {
      py::dict one;
      one["name"] = text_of(spec.name);
      one["unit"] = text_of(spec.unit.si);
      one["help"] = text_of(spec.help);
      one["window"] = text_of(to_string(spec.window));
      one["in_series"] = spec.in_series;
      one["metric"] = text_of(entry->name);
      all.append(std::move(one));
    }
  return all;
}

py::list list_scenes() {
  py::list all;
  for (const std::string& name : shipped("scenes")) {
    const Scene scene = load_scene(find_scene(name));
    py::dict one;
    one["name"] = text_of(name);
    one["summary"] = text_of(scene.summary);
    one["vertices"] = scene.mesh.size();
    one["links"] = scene.links.size();
    one["dt"] = scene.dt;
    one["duration"] = scene.duration();
    all.append(std::move(one));
  }
  return all;
}

// ---- The module

/// pybind11 keeps its types once for the process, and waits for itself where another interpreter
/// asks.
bool in_main_interpreter() {
  if (PyInterpreterState_Get() == PyInterpreterState_Main()) return true;
  PyErr_SetString(PyExc_ImportError,
                  "taut works in the main interpreter of a process, not in a sub-interpreter");
  return false;
}

/// Without pybind11, whose exceptions wait for themselves there, too.
PyMethodDef kPlainFunctions[] = {{"need_main_interpreter",
                                  [](PyObject*, PyObject*) -> PyObject* {
                                    if (!in_main_interpreter()) return nullptr;
                                    Py_RETURN_NONE;
                                  },
                                  METH_NOARGS, nullptr},
                                 {nullptr, nullptr, 0, nullptr}};

PyObject* g_input_error = nullptr;

void raise_input_error(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    py::object raised = py::reinterpret_borrow<py::object>(g_input_error)(text_of(error.what()));
    raised.attr("diagnostics") = py::cast(error.diagnostics());
    PyErr_SetObject(g_input_error, raised.ptr());
  }
}

template <auto member>
auto text_member() {
  return [](const Diagnostic& d) { return text_of(d.*member); };
}

template <auto member>
auto vectors_in() {
  return [](const SourcedScene& s) { return array_of((*s.scene).*member); };
}

template <auto member>
auto value_in() {
  return [](const SourcedScene& s) { return (*s.scene).*member; };
}

std::string about(const SourcedScene& s) {
  return "<taut.Scene " + s.scene->name + ": " + std::to_string(s.scene->mesh.size()) +
         " vertices, " + std::to_string(s.scene->links.size()) + " links, " +
         std::to_string(s.scene->steps) + " steps of " + shortest(s.scene->dt) + " s>";
}

std::string about(const RunResult& r) {
  return "<taut.Run " + r.record.scene + " " + r.record.spec.solver + ": " +
         describe(r.record.status) + ", " + std::to_string(r.t.size()) + " frames>";
}

void define_scene(py::module_& m) {
  py::class_<SourcedScene> scene(m, "Scene", doc::kScene);
  scene.def("__repr__", [](const SourcedScene& s) { return text_of(about(s)); })
      .def(
          "replace",
          [](const SourcedScene& s, const py::dict& settings) {
            return s.replaced(overrides_of(settings));
          },
          py::arg("settings"), doc::kReplace)
      .def(
          "pin_positions", [](const SourcedScene& s, double t) { return pins_at(*s.scene, t); },
          py::arg("t"), doc::kPinPositions)
      .def(
          "surface",
          [](const SourcedScene& s, std::size_t collider, const py::object& x, double t) {
            return surface_at(*s.scene, collider, x, t);
          },
          py::arg("collider"), py::arg("x"), py::arg("t"), doc::kSurface)
      .def_property_readonly(
          "name", [](const SourcedScene& s) { return text_of(s.scene->name); }, "File stem.")
      .def_property_readonly(
          "summary", [](const SourcedScene& s) { return text_of(s.scene->summary); },
          "One sentence.")
      .def_property_readonly(
          "x", [](const SourcedScene& s) { return array_of(s.scene->start.x); },
          "(n, 3) m: where the vertices start. A copy.")
      .def_property_readonly(
          "v", [](const SourcedScene& s) { return array_of(s.scene->start.v); },
          "(n, 3) m/s: how they start. A copy.")
      .def_property_readonly(
          "rest", [](const SourcedScene& s) { return array_of(s.scene->mesh.rest); },
          "(n, 3) m: the shape at rest. A copy.")
      .def_property_readonly(
          "mass", [](const SourcedScene& s) { return array_of(s.scene->mesh.mass); },
          "(n,) kg, pinned vertices included. A copy.")
      .def_property_readonly(
          "inverse_mass", [](const SourcedScene& s) { return array_of(inverse_masses(*s.scene)); },
          "(n,) 1/kg, 0 of pinned vertices. A copy.")
      .def_property_readonly(
          "links", [](const SourcedScene& s) { return links_of(*s.scene); },
          "(m, 2) int: the vertices of each link, in the order of Gauss-Seidel. A copy.")
      .def_property_readonly(
          "rest_lengths",
          [](const SourcedScene& s) {
            std::vector<double> lengths;
            for (const Link& link : s.scene->links) lengths.push_back(link.rest);
            return array_of(lengths);
          },
          "(m,) m: the links' lengths at rest. A copy.")
      .def_property_readonly(
          "families",
          [](const SourcedScene& s) {
            py::list all;
            for (const Link& link : s.scene->links) all.append(text_of(to_string(link.family)));
            return all;
          },
          "m texts: 'structural', 'shear' or 'bend'.")
      .def_property_readonly(
          "triangles",
          [](const SourcedScene& s) {
            const auto& all = s.scene->mesh.triangles;
            return py::array_t<int>({static_cast<py::ssize_t>(all.size()), py::ssize_t{3}},
                                    all.empty() ? nullptr : all.front().data());
          },
          "(f, 3) int: the vertices of each face. A copy.")
      .def_property_readonly(
          "pins",
          [](const SourcedScene& s) {
            return py::array_t<int>(static_cast<py::ssize_t>(s.scene->pins.size()),
                                    s.scene->pins.data());
          },
          "(p,) int: the vertices that no solver moves. A copy.")
      .def_property_readonly(
          "gravity",
          [](const SourcedScene& s) { return Doubles(py::ssize_t{3}, s.scene->gravity.data()); },
          "(3,) m/s^2. A copy.")
      .def_property_readonly(
          "colliders",
          [](const SourcedScene& s) {
            py::list all;
            for (const Collider& c : s.scene->colliders) all.append(text_of(type_name(c.shape)));
            return all;
          },
          "The type of each collider; surface() says where it is.")
      .def_property_readonly(
          "effects", [](const SourcedScene& s) { return effects(*s.scene); },
          "What it has beside gravity, rigid links and pins that stay: 'colliders', 'moving "
          "pins', 'wind', 'bending', 'self-collision', 'damping', 'elastic links'.")
      .def_property_readonly("damping", value_in<&Scene::damping>(),
                             "1/s: a free vertex's velocity decays as exp(-damping t).")
      .def_property_readonly("thickness", value_in<&Scene::thickness>(),
                             "m: cloth keeps this distance from colliders.")
      .def_property_readonly("dt", value_in<&Scene::dt>(), "s: the time step, exact in float32.")
      .def_property_readonly("steps", value_in<&Scene::steps>(), "Steps of the whole duration.")
      .def_property_readonly(
          "duration", [](const SourcedScene& s) { return s.scene->duration(); }, "s: dt * steps.")
      .def_property_readonly(
          "digest", [](const SourcedScene& s) { return digest(*s.scene); },
          "SHA-256 of its content: equal exactly when two scenes are the same simulation.");
}

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
                    "s: CPU time of this process during all steps, other threads of it included: "
                    "a first impression; `taut bench` measures. NaN of positions.")
      .def_property_readonly(
          "record",
          [](const RunResult& r) {
            return py::module_::import("json").attr("loads")(text_of(to_json(r.record)));
          },
          "What a results file keeps of it, as `taut case --json` prints it: a dict.");
}

void define_module(py::module_& m) {
  py::options options;
  options.disable_function_signatures();
  PyModule_AddFunctions(m.ptr(), kPlainFunctions);
  m.def("set_data_folder", set_data_folder);
  m.def("register_solver", register_solver);

  g_input_error =
      PyErr_NewExceptionWithDoc("taut.InputError", doc::kInputError, PyExc_ValueError, nullptr);
  if (!g_input_error) throw py::error_already_set();
  m.attr("InputError") = py::handle(g_input_error);
  py::register_exception_translator(raise_input_error);
  py::class_<Diagnostic>(m, "Diagnostic", doc::kDiagnostic)
      .def("__repr__", [](const Diagnostic& d) { return text_of(d.text()); })
      .def_property_readonly("file", text_member<&Diagnostic::file>(), "As given; '': no file.")
      .def_readonly("line", &Diagnostic::line, "From 1; 0: not known.")
      .def_readonly("column", &Diagnostic::column, "From 1; 0: not known, or the whole line.")
      .def_property_readonly("message", text_member<&Diagnostic::message>(), "Names the key.");
  define_scene(m);
  define_run(m);

  m.def(
      "scene",
      [](const py::object& source, const py::object& settings, const std::string& name) {
        const py::dict given = settings.is_none() ? py::dict() : py::dict(settings);
        return py::isinstance<SourcedScene>(source)
                   ? py::cast<const SourcedScene&>(source).replaced(overrides_of(given))
                   : scene_from(source, given, name);
      },
      py::arg("source"), py::arg("settings") = py::none(), py::kw_only(), py::arg("name") = "scene",
      doc::kSceneFunction);
  m.def("simulate", simulate, py::arg("scene"), py::arg("solver") = "jakobsen", py::kw_only(),
        py::arg("dt") = py::none(), py::arg("duration") = py::none(), py::arg("every") = 1,
        doc::kSimulate);
  m.def("score", score, py::arg("scene"), py::arg("positions"), py::kw_only(),
        py::arg("fps") = py::none(), py::arg("scale") = 1.0, py::arg("up") = "y",
        py::arg("rest") = py::none(), py::arg("every") = 1, py::arg("allow_nan") = false,
        doc::kScore);
  m.def("solvers", list_solvers, doc::kSolvers);
  m.def("metrics", list_metrics, doc::kMetrics);
  m.def("scenes", list_scenes, doc::kScenes);
  set_solver_source({.names = python_solver_names, .find = find_python_solver});
}

}  // namespace
}  // namespace taut::python

/// PYBIND11_MODULE, which has no place for the first question.
extern "C" PYBIND11_EXPORT PyObject* PyInit__taut();
extern "C" PYBIND11_EXPORT PyObject* PyInit__taut() {
  if (!taut::python::in_main_interpreter()) return nullptr;
  PYBIND11_CHECK_PYTHON_VERSION
  PYBIND11_ENSURE_INTERNALS_READY
  static PyModuleDef definition;
  auto m = py::module_::create_extension_module("_taut", nullptr, &definition);
  try {
    taut::python::define_module(m);
    return m.ptr();
  }
  PYBIND11_CATCH_INIT_EXCEPTIONS
}
