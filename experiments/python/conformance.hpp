#pragma once

#include <pybind11/pybind11.h>

namespace taut::python {

/// Defines taut.verify.
void define_verify(pybind11::module_&);

}  // namespace taut::python
