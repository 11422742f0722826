#include "experiments/python/predictions.hpp"

#include <pybind11/stl.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/predict/prediction.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/python/sourced_scene.hpp"
#include "experiments/python/values.hpp"

namespace taut::python {

namespace {

std::optional<double> if_given(const py::object& value, const char* what) {
  if (value.is_none()) return {};
  return above_zero(value, what);
}

py::list predictions(const py::object& scene, const std::string& solver, const py::object& dt,
                     const py::object& error, const py::object& stiffness, const py::object& budget,
                     bool as_stiffness) {
  const SourcedScene timed = timed_scene(scene, dt, py::none());
  const SolverChoice choice = parse_solver(solver);
  const PredictionWanted wanted{.error = if_given(error, "error"),
                                .stiffness = if_given(stiffness, "stiffness"),
                                .budget = if_given(budget, "budget"),
                                .as_stiffness = as_stiffness};
  if (wanted.error.has_value() + wanted.stiffness.has_value() + wanted.budget.has_value() > 1)
    throw InputError("predict takes at most one of error, stiffness and budget");
  py::list all;
  for (const PredictedStrain& one : predict(*timed.scene, choice, wanted)) {
    py::list reasons;
    for (const std::string& why : one.refused) reasons.append(text_of(why));
    const auto number = [&](double value) { return one.refused.empty() ? value : std::nan(""); };
    py::dict row;
    row["solver"] = text_of(one.choice.brief());
    row["refused"] = std::move(reasons);
    row["rms"] = number(one.strain.rms);
    row["largest"] = number(one.strain.largest);
    row["sag"] = number(one.strain.sag);
    row["cpu"] = number(one.cpu);
    row["stiffness"] = number(one.stiffness);
    row["c"] = number(one.correction);
    row["s"] = number(one.strain.s);
    all.append(std::move(row));
  }
  return all;
}

}  // namespace

void define_predict(py::module_& m) {
  m.def("predict", predictions, py::arg("scene"), py::arg("solver") = "jakobsen", py::kw_only(),
        py::arg("dt") = py::none(), py::arg("error") = py::none(),
        py::arg("stiffness") = py::none(), py::arg("budget") = py::none(),
        py::arg("as_stiffness") = false, doc::kPredict);
}

}  // namespace taut::python
