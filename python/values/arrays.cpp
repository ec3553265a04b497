#include "values/arrays.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "module.hpp"
#include "running.hpp"
#include "setup/files/drive_file.hpp"
#include "shapes.hpp"
#include "values/options.hpp"

namespace palpa::python {
namespace {

std::string shape_text(const py::array& array) {
  std::vector<std::string> sizes;
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
    sizes.push_back(std::to_string(array.shape(axis)));
  return fmt::format("({}{})", fmt::join(sizes, ", "), sizes.size() == 1 ? "," : "");
}

/// ascii(value), shortened; the name of its type if there is none.
std::string repr_of(py::handle value) {
  const py::object text = py::reinterpret_steal<py::object>(PyObject_ASCII(value.ptr()));
  if (text) return shortened(one_line(text.cast<std::string>()), 80);
  PyErr_Clear();
  return Py_TYPE(value.ptr())->tp_name;
}

std::string text_of_error(const py::error_already_set& error) {
  const py::object text = py::reinterpret_steal<py::object>(PyObject_Str(error.value().ptr()));
  if (text) return text.cast<std::string>();
  PyErr_Clear();
  return "NumPy makes no array of it";
}

/// NumPy would give the values below the mask, also of the arrays in a list.
void refuse_masked(const std::string& name, py::handle value) {
  const py::module_ masked = py::module_::import("numpy.ma");
  const py::object kind = masked.attr("MaskedArray");
  const auto look = [&](py::handle one) {
    if (py::isinstance(one, kind) && masked.attr("is_masked")(one).cast<bool>())
      throw bad_usage(fmt::format("{}: has masked entries: leave them out, or fill them", name));
  };
  look(value);
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value)) return;
  for (const py::handle part : value)
    look(part);
}

/// numpy.asarray(value). What the value's own __array__ raises is thrown on; if NumPy cannot make an array of it, the
/// message says why.
py::array any_array(const std::string& name, py::handle value, const char* wanted) {
  using Numpy = py::detail::npy_api;
  refuse_masked(name, value);
  const py::object array = py::reinterpret_steal<py::object>(
      Numpy::get().PyArray_FromAny_(value.ptr(), nullptr, 0, 0, Numpy::NPY_ARRAY_ENSUREARRAY_, nullptr));
  if (array) return py::array(array);
  py::error_already_set fault;
  const bool of_numpy = fault.matches(PyExc_ValueError) || fault.matches(PyExc_TypeError);
  if (!of_numpy || py::hasattr(value, "__array__")) throw fault;
  throw bad_usage(fmt::format("{}: give {}, not {}: {}", name, wanted, Py_TYPE(value.ptr())->tp_name,
                              shortened(one_line(text_of_error(fault)), 200)));
}

bool is_real(const py::array& array) {
  const char kind = array.dtype().kind();
  return kind == 'f' || kind == 'i' || kind == 'u';
}

void refuse_type(const std::string& name, const py::array& array, const char* wanted) {
  throw bad_usage(fmt::format("{}: give {}; the array has the type {}", name, wanted,
                              py::str(static_cast<py::object>(array.dtype())).cast<std::string>()));
}

void refuse_shape(const std::string& name, const py::array& array, const char* wanted) {
  throw bad_usage(fmt::format("{}: give {}; the array has the shape {}", name, wanted, shape_text(array)));
}

void refuse_huge(const std::string& name, const py::array& array) {
  if (array.ndim() == 0 || array.shape(0) <= most_rows) return;
  throw bad_usage(
      fmt::format("{}: the array has {} rows; palpa takes at most {}", name, array.shape(0), py::ssize_t{most_rows}));
}

/// In C order and as float64; a copy if it is not.
py::array_t<double> real_array(const std::string& name, const py::array& array, const char* wanted) {
  if (!is_real(array)) refuse_type(name, array, wanted);
  refuse_huge(name, array);
  auto made = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!made) throw py::error_already_set();
  return made;
}

}  // namespace

std::vector<Vec3> points_of(const std::string& name, py::handle value) {
  constexpr const char* wanted = "an array of shape (n, 3) of real numbers, in metres";
  const py::array given = any_array(name, value, wanted);
  const bool one = given.ndim() == 1 && given.shape(0) == 3;
  if (!one && (given.ndim() != 2 || given.shape(1) != 3)) refuse_shape(name, given, wanted);
  const py::array_t<double> array = real_array(name, given, wanted);
  const double* const from = array.data();
  const auto count = static_cast<std::size_t>(array.size() / 3);
  return unlocked([&] {
    std::vector<Vec3> points(count);
    for (std::size_t i = 0; i < count; ++i) {
      points[i] = {from[3 * i], from[3 * i + 1], from[3 * i + 2]};
      if (!std::isfinite(points[i].x + points[i].y + points[i].z)) {
        throw bad_usage(fmt::format("{}: row {} is not finite: ({}, {}, {})", name, i, from[3 * i], from[3 * i + 1],
                                    from[3 * i + 2]));
      }
    }
    return points;
  });
}

Vec3 point_of(const std::string& name, py::handle value) {
  const std::vector<Vec3> points = points_of(name, value);
  if (points.size() != 1) throw bad_usage(fmt::format("{}: give one point (x, y, z), not {}", name, points.size()));
  return points.front();
}

std::vector<double> numbers_of(const std::string& name, py::handle value) {
  constexpr const char* wanted = "an array of shape (n,) of real numbers";
  const py::array given = any_array(name, value, wanted);
  if (given.ndim() > 1) refuse_shape(name, given, wanted);
  const py::array_t<double> array = real_array(name, given, wanted);
  std::vector<double> numbers(array.data(), array.data() + array.size());
  const auto bad = std::ranges::find_if(numbers, [](double number) { return !std::isfinite(number); });
  if (bad != numbers.end())
    throw bad_usage(fmt::format("{}: entry {} is not finite: {}", name, bad - numbers.begin(), *bad));
  return numbers;
}

std::vector<array::Null> nulls_of(const py::object& places, const py::object& radii) {
  std::vector<array::Null> nulls;
  if (places.is_none()) {
    if (!radii.is_none()) throw bad_usage("null_radius goes with nulls");
    return nulls;
  }
  for (const Vec3& place : points_of("nulls", places))
    nulls.push_back({place, 0});
  std::vector<double> wide{0};
  if (!radii.is_none()) wide = numbers_of("null_radius", radii);
  if (wide.size() != 1 && wide.size() != nulls.size())
    throw bad_usage(fmt::format("null_radius: there are {} for {}", wide.size(), counted(nulls.size(), "null")));
  for (std::size_t i = 0; i < nulls.size(); ++i)
    nulls[i].radius_m = wide[wide.size() == 1 ? 0 : i];
  return nulls;
}

double length_of(const std::string& name, py::handle value) {
  const auto refused = [&] {
    return bad_usage(fmt::format("{}: give {}; palpa got {}", name, quantity_hint(Quantity::length), repr_of(value)));
  };
  if (is_flag(value)) throw refused();
  if (py::isinstance<py::str>(value)) {
    if (const auto metres = parse_quantity(bytes_of(name, value), Quantity::length)) return *metres;
    throw refused();
  }
  const double metres = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred()) {
    forgive_wrong_value();
    throw refused();
  }
  if (!std::isfinite(metres)) throw refused();
  return metres;
}

Transform matrix_of(const std::string& name, py::handle value) {
  constexpr const char* wanted = "a transform, an array of shape (4, 4)";
  const py::array given = any_array(name, value, wanted);
  if (given.ndim() != 2 || given.shape(0) != 4 || given.shape(1) != 4) refuse_shape(name, given, wanted);
  const py::array_t<double> array = real_array(name, given, wanted);
  Transform transform{1.0};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double number = array.data()[4 * row + column];
      if (!std::isfinite(number)) throw bad_usage(fmt::format("{}: not all of its numbers are finite", name));
      transform[column][row] = number;
    }
  }
  return transform;
}

Transform transform_of(const std::string& name, py::handle value) {
  const Transform transform = matrix_of(name, value);
  double worst = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const double dot = glm::dot(Vec3(transform[a]), Vec3(transform[b]));
      worst = std::max(worst, std::abs(dot - (a == b ? 1.0 : 0.0)));
    }
  }
  const bool bottom = glm::row(transform, 3) == Vec4(0, 0, 0, 1);
  if (!(worst < 1e-4) || glm::determinant(transform) < 0 || !bottom) {
    throw bad_usage(fmt::format("{}: is no rigid transform: it needs a rotation, and the last row (0, 0, 0, 1)", name));
  }
  return transform;
}

std::vector<glm::uvec3> triangles_of(const std::string& name, py::handle value, std::size_t points) {
  constexpr const char* wanted = "an array of shape (m, 3) of whole numbers, the corners of each triangle";
  const py::array given = any_array(name, value, wanted);
  if (given.ndim() != 2 || given.shape(1) != 3) refuse_shape(name, given, wanted);
  if (given.dtype().kind() != 'i' && given.dtype().kind() != 'u') refuse_type(name, given, wanted);
  refuse_huge(name, given);
  const auto array = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array) throw py::error_already_set();
  std::vector<glm::uvec3> triangles(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::int64_t index = array.data()[3 * i + static_cast<std::size_t>(corner)];
      if (index < 0 || static_cast<std::uint64_t>(index) >= points)
        throw bad_usage(fmt::format("{}: row {} names vertex {}, but there are {}", name, i, index, points));
      triangles[i][corner] = static_cast<std::uint32_t>(index);
    }
  }
  return triangles;
}

bool is_flag(py::handle value) {
  return PyBool_Check(value.ptr()) || py::isinstance(value, py::module_::import("numpy").attr("bool_"));
}

std::vector<py::object> depth_images_of(const char* name, const py::object& value) {
  if (value.is_none()) return {};
  if (path_of(value)) return {value};
  if (py::isinstance<py::array>(value)) {
    const py::array array(value);
    constexpr py::ssize_t most_channels = 4;  // the image of a colour camera is one that is refused
    const bool stack = array.ndim() == 3 && array.shape(0) > 0 && array.shape(1) > 1 && array.shape(2) > most_channels;
    const bool numbers = is_real(array) || array.dtype().kind() == 'b' || array.dtype().kind() == 'c';
    if (numbers && !stack) return {value};
  }
  if (!is_list(value)) throw bad_usage(fmt::format("{}: give a path, or a list of these", name));
  std::vector<py::object> several;
  // A sequence may make its parts when they are asked for, as arrays do: only py::object keeps them.
  for (const py::object part : value.cast<py::sequence>())
    several.push_back(part);
  return several;
}

std::vector<std::uint16_t> depths_of(const std::string& name, py::handle value, std::uint32_t width,
                                     std::uint32_t height) {
  const std::string wanted =
      fmt::format("a depth image, an array of shape ({}, {}) of the type uint16, as its camera says", height, width);
  const py::array given = any_array(name, value, wanted.c_str());
  const bool image = given.ndim() == 2 || (given.ndim() == 3 && given.shape(2) == 1);
  if (!image || given.shape(0) != height || given.shape(1) != width) refuse_shape(name, given, wanted.c_str());
  if (given.dtype().kind() != 'u' || given.itemsize() != 2) refuse_type(name, given, wanted.c_str());
  const auto array = py::array_t<std::uint16_t, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array) throw py::error_already_set();
  return {array.data(), array.data() + array.size()};
}

array::Drive drive_of(const std::string& name, py::handle value, const array::Layout& layout) {
  const std::string wanted =
      fmt::format("a drive, a complex array of shape ({},), one entry per transducer of the layout {}",
                  layout.transducers.size(), layout.name);
  const py::array given = any_array(name, value, wanted.c_str());
  if (given.ndim() != 1 || given.shape(0) != static_cast<py::ssize_t>(layout.transducers.size()))
    refuse_shape(name, given, wanted.c_str());
  if (!is_real(given) && given.dtype().kind() != 'c') refuse_type(name, given, wanted.c_str());
  const auto array = py::array_t<std::complex<double>, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array) throw py::error_already_set();
  array::Drive drive;
  drive.reserve(layout.transducers.size());
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    const std::complex<double> entry = array.data()[i];
    const std::optional<float> amplitude = setup::as_given_amplitude(std::abs(entry));
    if (!amplitude) {
      throw bad_usage(
          fmt::format("{}: entry {} has the amplitude {}; amplitudes are 0 to 1", name, i, std::abs(entry)));
    }
    drive.push_back({*amplitude, static_cast<float>(std::arg(entry))});
  }
  return drive;
}

py::array sealed(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array shown(const std::vector<Vec3>& points, py::handle owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  if (points.empty()) return sealed(py::array_t<double>(std::vector<py::ssize_t>{0, 3}));
  return shown(&points.front().x, {static_cast<py::ssize_t>(points.size()), 3}, owner);
}

py::array shown(const std::vector<glm::uvec3>& triangles, py::handle owner) {
  static_assert(sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));
  if (triangles.empty()) return sealed(py::array_t<std::uint32_t>(std::vector<py::ssize_t>{0, 3}));
  return shown(&triangles.front().x, {static_cast<py::ssize_t>(triangles.size()), 3}, owner);
}

py::array copied(const Vec3& point) {
  return sealed(py::array_t<double>(3, &point.x));
}

py::array copied(const std::vector<Vec3>& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Vec3& point : points) {
    *to++ = point.x;
    *to++ = point.y;
    *to++ = point.z;
  }
  return sealed(std::move(array));
}

py::array copied(const Transform& transform) {
  py::array_t<double> array({py::ssize_t{4}, py::ssize_t{4}});
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      array.mutable_data()[4 * row + column] = transform[column][row];
  }
  return sealed(std::move(array));
}

py::tuple range_of(const setup::Percentiles& percentiles) {
  return py::make_tuple(percentiles.p05, percentiles.p50, percentiles.p95);
}

py::tuple range_of(const std::array<setup::Percentiles, 3>& axes) {
  return py::make_tuple(range_of(axes[0]), range_of(axes[1]), range_of(axes[2]));
}

py::dict seconds_of(std::span<const std::pair<std::string, double>> times) {
  py::dict made;
  for (const auto& [step, ms] : times)
    made[step.c_str()] = ms * 1e-3;
  return made;
}

py::array complex_of(std::span<const array::TransducerDrive> drive, std::vector<py::ssize_t> shape) {
  if (shape.empty()) shape = {static_cast<py::ssize_t>(drive.size())};
  py::array_t<std::complex<double>> array(std::move(shape));
  std::complex<double>* to = array.mutable_data();
  for (const auto [amplitude, phase] : drive)
    *to++ = std::polar(double{amplitude}, double{phase});
  return sealed(std::move(array));
}

}  // namespace palpa::python
