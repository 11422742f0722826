#pragma once

#include <pybind11/pybind11.h>

namespace taut::python {

/// Defines taut.predict.
void define_predict(pybind11::module_&);

}  // namespace taut::python
