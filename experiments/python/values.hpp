#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/scene_setting.hpp"
#include "core/model/vec3.hpp"

/// Conversion of texts, arrays and settings between Python and the library.
namespace taut::python {

namespace py = pybind11;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Converts a text from outside. Bytes that are not UTF-8 become what Python makes of them in file
/// names.
py::str text_of(std::string_view);

/// Name of the value's type.
std::string type_of(py::handle value);

/// The value as an array of numbers with this many dimensions, the last two being [count][3].
/// Throws InputError that names `what`, its type and its shape. A masked array is refused. `floats`
/// refuses integers too.
py::array points_of(py::handle value, const std::string& what, py::ssize_t dimensions,
                    std::optional<py::ssize_t> count, const std::string& wanted,
                    bool floats = false);

/// Conversions by copy.
py::array array_of(const std::vector<Vec3>&);
py::array array_of(const std::vector<double>&);
std::vector<Vec3> vectors_of(const Doubles&);

/// An array of this shape that takes over the numbers without a copy.
py::array owned(std::vector<double>&&, std::vector<py::ssize_t> shape);

/// The number. Throws InputError that names `what` if it is not above 0.
double above_zero(const py::object& value, const char* what);

/// Converts {"cloth.grid": [16, 16]} to settings for load_scene(). Throws InputError that names the
/// key.
SceneSettings settings_of(const py::dict& settings);

}  // namespace taut::python
