#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/model/solver.hpp"

/// Classes of Python as solvers of this process.
namespace taut::python {

/// From here on parse_solver() finds the class by this name. `parameters` have their defaults.
/// Throws InputError: what is no solver, a name of ours, a default that no text can say.
void register_solver(const std::string& name, const pybind11::object& type,
                     const pybind11::dict& parameters);

/// For set_solver_source(). The last one of a name, so that a notebook's cell may be run again.
const SolverEntry* find_python_solver(std::string_view name, std::string_view params);
std::vector<std::string> python_solver_names();

}  // namespace taut::python
