#include "experiments/python/python_solver.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/python/sourced_scene.hpp"
#include "experiments/python/values.hpp"

namespace taut::python {

namespace {

/// A Python class as an entry of solvers. It lives until the program ends.
struct PythonEntry {
  std::deque<std::string> texts;  ///< storage behind the views of the entry
  std::vector<ParamSpec> params;
  SolverEntry entry;
};
std::deque<PythonEntry>& python_entries() {
  // Never destroyed: the interpreter may end earlier.
  static auto* all = new std::deque<PythonEntry>;
  return *all;
}

/// Adds the names of the solver and the method to an exception that leaves it.
[[noreturn]] void rethrow_from(py::error_already_set& error, const std::string& where) {
  if (py::hasattr(error.value(), "add_note")) error.value().attr("add_note")("in " + where);
  throw;  // NOLINT: only called from the handlers below
}

class PythonSolver final : public Solver {
 public:
  /// The caller holds the interpreter's lock.
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

/// A parameter from its default: a number, a text, or a tuple of texts of which the first is the
/// default.
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
  // Never release the reference, since entries live until the program ends.
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
  entry.declared_step = implicit_euler_of_a_frame;
  entry.unsupported = [held, name](const Scene& scene, const Params&) -> std::vector<std::string> {
    const py::gil_scoped_acquire own;
    if (!py::hasattr(held, "unsupported")) return {};
    const SourcedScene given{
        scene.name, {}, {}, {}, std::make_shared<const Scene>(stages(scene).front())};
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

}  // namespace

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
  Params(name, made.params, "");  // reports a default that no text can express
  PythonEntry& entry = python_entries().emplace_back(std::move(made));
  entry.entry = entry_of(type, name, entry);
}

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

}  // namespace taut::python
