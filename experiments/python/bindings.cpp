// The Python module taut._taut, on which experiments/python/package is built. It uses the library's
// public headers and contains no physics and no metrics: the library reads scenes, steps solvers
// and judges motions.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <utility>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/python/conformance.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/python/predictions.hpp"
#include "experiments/python/python_solver.hpp"
#include "experiments/python/runs.hpp"
#include "experiments/python/sourced_scene.hpp"
#include "experiments/python/unlocked.hpp"
#include "experiments/python/values.hpp"
#include "experiments/system/data.hpp"

namespace taut::python {
namespace {

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

/// Whether this is the main interpreter. pybind11 registers its types once per process, and
/// deadlocks if another interpreter uses them.
bool in_main_interpreter() {
  if (PyInterpreterState_Get() == PyInterpreterState_Main()) return true;
  PyErr_SetString(PyExc_ImportError,
                  "taut works in the main interpreter of a process, not in a sub-interpreter");
  return false;
}

/// Functions made without pybind11, whose exceptions deadlock there as well.
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

void define_module(py::module_& m) {
  py::options options;
  options.disable_function_signatures();
  PyModule_AddFunctions(m.ptr(), kPlainFunctions);
  m.def("set_data_folder", set_data_folder);
  m.def("register_solver", register_solver);
  m.def("fail_in", [](const std::filesystem::path& file, const std::string& why) {
    throw InputError({{file.string(), 0, 0, why}});
  });
  wait_for_unlocked_at_exit();

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
  define_predict(m);
  define_verify(m);

  m.def(
      "scene",
      [](const py::object& source, const py::object& settings, const std::string& name) {
        const py::dict given = settings.is_none() ? py::dict() : py::dict(settings);
        return py::isinstance<SourcedScene>(source)
                   ? py::cast<const SourcedScene&>(source).replaced(settings_of(given))
                   : scene_from(source, given, name);
      },
      py::arg("source"), py::arg("settings") = py::none(), py::kw_only(), py::arg("name") = "scene",
      doc::kSceneFunction);
  m.def("solvers", list_solvers, doc::kSolvers);
  m.def("metrics", list_metrics, doc::kMetrics);
  m.def("scenes", list_scenes, doc::kScenes);
  set_solver_source({.names = python_solver_names, .find = find_python_solver});
}

}  // namespace
}  // namespace taut::python

/// PYBIND11_MODULE written out, because it leaves no room for a check before it.
extern "C" PYBIND11_EXPORT PyObject* PyInit__taut();
extern "C" PYBIND11_EXPORT PyObject* PyInit__taut() {
  if (!taut::python::in_main_interpreter()) return nullptr;
  PYBIND11_CHECK_PYTHON_VERSION
  PYBIND11_ENSURE_INTERNALS_READY
  static PyModuleDef definition;
  auto m = pybind11::module_::create_extension_module("_taut", nullptr, &definition);
  try {
    taut::python::define_module(m);
    return m.ptr();
  }
  PYBIND11_CATCH_INIT_EXCEPTIONS
}
