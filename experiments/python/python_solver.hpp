#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/model/solver.hpp"

/// Python classes as solvers of this process.
namespace taut::python {

/// Makes parse_solver() find the class by this name. `parameters` maps names to defaults. Throws
/// InputError if the class is no solver, taut has a solver of that name, or no text can express a
/// default.
void register_solver(const std::string& name, const pybind11::object& type,
                     const pybind11::dict& parameters);

/// Finder for set_solver_source(). The last class registered under a name counts, so that a
/// notebook cell can be run again.
const SolverEntry* find_python_solver(std::string_view name, std::string_view params);
std::vector<std::string> python_solver_names();

}  // namespace taut::python
