#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/vec3.hpp"

/// Texts, arrays and settings on their way between Python and the library.
namespace taut::python {

namespace py = pybind11;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Text from outside may be anything; what is no UTF-8 comes as Python has it in file names.
py::str text_of(std::string_view);

/// The name of its type.
std::string type_of(py::handle value);

/// The value as an array of numbers of this many dimensions that ends with [count][3]. Throws
/// InputError that names `what`, its type and shape; `floats` refuses integers, too.
py::array points_of(py::handle value, const std::string& what, py::ssize_t dimensions,
                    std::optional<py::ssize_t> count, const std::string& wanted,
                    bool floats = false);

/// Copies.
py::array array_of(const std::vector<Vec3>&);
py::array array_of(const std::vector<double>&);
std::vector<Vec3> vectors_of(const Doubles&);

/// An array of this shape that owns the numbers: no copy.
py::array owned(std::vector<double>&&, std::vector<py::ssize_t> shape);

/// {"cloth.grid": [16, 16]} as load_scene() has it. Throws InputError that names the key.
SceneSettings settings_of(const py::dict& settings);

}  // namespace taut::python
