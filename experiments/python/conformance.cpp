#include "experiments/python/conformance.hpp"

#include <cmath>
#include <string>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/python/docstrings.hpp"
#include "experiments/python/values.hpp"
#include "experiments/truths/suite.hpp"

namespace py = pybind11;

namespace taut::python {

namespace {

Finding failed(const std::string& solver, const std::string& why) {
  Finding f;
  f.subject = solver;
  f.quantity = "the test ends";
  f.unit = "1";
  f.expected = 1;
  f.verdict = TruthVerdict::broken;
  f.why = why;
  return f;
}

/// Findings of one test. What the methods of a class raise costs this test alone, except for an
/// interrupt.
std::vector<Finding> findings_of(const TruthEntry& test, const std::string& solver) {
  Findings findings({solver});
  std::string raised;
  try {
    test.check(findings);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_Exception)) throw;
    raised = error.what();
  } catch (const InputError& error) {
    raised = error.what();
  }
  std::vector<Finding> all = findings.all();
  if (!raised.empty()) all.push_back(failed(solver, raised));
  return all;
}

py::list verify(const std::string& solver) {
  parse_solver(solver);
  py::list rows;
  for (const TruthEntry* test : conformance_suite())
    for (const Finding& f : findings_of(*test, solver)) {
      py::dict row;
      row["phenomenon"] = text_of(test->phenomenon);
      row["test"] = text_of(test->name);
      row["needs"] = text_of(test->needs);
      row["verdict"] = text_of(to_string(f.verdict));
      row["quantity"] = text_of(f.quantity);
      row["unit"] = text_of(f.unit);
      row["value"] = f.measured;
      row["closed_form"] = f.expected;
      row["ratio"] = f.expected == 0 ? std::nan("") : f.measured / f.expected;
      row["tolerance"] = f.tolerance;
      row["why"] = text_of(f.why);
      rows.append(std::move(row));
    }
  return rows;
}

}  // namespace

void define_verify(py::module_& m) { m.def("verify", verify, py::arg("solver"), doc::kVerify); }

}  // namespace taut::python
