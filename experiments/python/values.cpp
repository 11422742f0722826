#include "experiments/python/values.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"

namespace taut::python {

namespace {

/// "(121, 256, 3)".
std::string shape_of(const py::array& array) {
  return py::cast<std::string>(py::repr(array.attr("shape")));
}

/// Whether it is a masked array or a list of such. As an array it would lose the mask, and what the
/// mask hides would count.
bool has_mask(py::handle value, py::handle masked) {
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value))
    return py::isinstance(value, masked);
  for (const py::handle part : value)
    if (has_mask(part, masked)) return true;
  return false;
}

/// The value as TOML. Throws InputError that names `key`.
std::string toml_of(py::handle value, const std::string& key) {
  const auto all = [&](py::handle list) {
    std::vector<std::string> parts;
    for (const py::handle part : list) parts.push_back(toml_of(part, key));
    return join(parts, ", ");
  };
  if (py::isinstance<py::bool_>(value)) return py::cast<bool>(value) ? "true" : "false";
  if (py::isinstance<py::str>(value))
    return py::cast<std::string>(
        py::module_::import("json").attr("dumps")(value, py::arg("ensure_ascii") = false));
  if (py::isinstance<py::int_>(value)) return py::cast<std::string>(py::str(value));
  if (py::isinstance<py::float_>(value)) return shortest(py::cast<double>(value));
  if (py::hasattr(value, "tolist")) return toml_of(value.attr("tolist")(), key);
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value))
    return "[" + all(value) + "]";
  if (py::isinstance<py::dict>(value)) {
    std::vector<std::string> parts;
    for (const auto& [name, part] : py::reinterpret_borrow<py::dict>(value))
      parts.push_back(toml_of(py::str(name), key) + " = " + toml_of(part, key));
    return "{ " + join(parts, ", ") + " }";
  }
  throw InputError("settings: '" + key + "' is a " + type_of(value) +
                   "; must be a number, a text, a bool, a list or a dict of them");
}

}  // namespace

py::str text_of(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

std::string type_of(py::handle value) {
  return py::cast<std::string>(py::type::of(value).attr("__name__"));
}

py::array points_of(py::handle value, const std::string& what, py::ssize_t dimensions,
                    std::optional<py::ssize_t> count, const std::string& wanted, bool floats) {
  if (has_mask(value, py::module_::import("numpy.ma").attr("MaskedArray")))
    throw InputError(what + ": a masked array; give its values without a mask: filled() or a part");
  const py::array array = py::array::ensure(value);
  if (!array) {
    PyErr_Clear();
    throw InputError(what + ": a " + type_of(value) + "; must be an array " + wanted);
  }
  const char kind = array.dtype().kind();
  if (kind == 'O' && !py::isinstance<py::array>(value))
    throw InputError(what + ": a " + type_of(value) + "; must be an array " + wanted);
  const std::string dtype = py::cast<std::string>(py::str(array.dtype()));
  if (floats ? kind != 'f' || (array.itemsize() != 4 && array.itemsize() != 8)
             : kind != 'f' && kind != 'i' && kind != 'u')
    throw InputError(what + ": an array of " + dtype + "; must be of float64" +
                     (floats ? " or float32" : "") + ", " + wanted);
  if (array.ndim() != dimensions || array.shape(dimensions - 1) != 3 ||
      (count && array.shape(dimensions - 2) != *count))
    throw InputError(what + ": an array of shape " + shape_of(array) + "; must be " + wanted);
  return array;
}

py::array array_of(const std::vector<Vec3>& vectors) {
  return Doubles({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}},
                 reinterpret_cast<const double*>(vectors.data()));
}

py::array array_of(const std::vector<double>& values) {
  return Doubles(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array owned(std::vector<double>&& values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<double>>(std::move(values));
  const double* first = kept->data();
  const py::capsule owner(kept.get(),
                          [](void* all) { delete static_cast<std::vector<double>*>(all); });
  kept.release();
  return Doubles(std::move(shape), first, owner);
}

std::vector<Vec3> vectors_of(const Doubles& array) {
  const auto* first = reinterpret_cast<const Vec3*>(array.data());
  return {first, first + array.shape(0)};
}

SceneSettings settings_of(const py::dict& settings) {
  SceneSettings all;
  for (const auto& [name, value] : settings) {
    const auto key = py::cast<std::string>(py::str(name));
    all.emplace_back(key, toml_of(value, key));
  }
  return all;
}

double above_zero(const py::object& value, const char* what) {
  const std::string wrong = std::string(what) + ": " + py::cast<std::string>(py::repr(value));
  try {
    const auto number = py::cast<double>(value);
    if (std::isfinite(number) && number > 0) return number;
  } catch (const py::cast_error&) {
    throw InputError(wrong + " is a " + type_of(value) + "; must be a number above 0");
  }
  throw InputError(wrong + "; must be above 0");
}

}  // namespace taut::python
