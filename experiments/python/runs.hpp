#pragma once

#include <pybind11/pybind11.h>

namespace taut::python {

/// Defines taut.Run, taut.simulate and taut.score.
void define_run(pybind11::module_&);

}  // namespace taut::python
