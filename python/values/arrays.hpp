// NumPy arrays to the engine's values and back. The shape and type of inputs are checked, and NaN is refused. Outputs
// are read-only and in C order. They keep the object alive whose memory they show.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/nulls/null.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "setup/options/spread.hpp"

namespace palpa::python {

namespace py = pybind11;

/// The most rows of an array that is passed in.
inline constexpr py::ssize_t most_rows = 1 << 24;

/// An array of shape (n, 3), or (3,) for one point, of finite numbers. Throws bad_usage naming `name`, and what is
/// wrong.
std::vector<Vec3> points_of(const std::string& name, py::handle value);
/// An array of shape (3,).
Vec3 point_of(const std::string& name, py::handle value);
/// Places and radii as texts of --null. `radii` are one number, one for each place, or None for 0.
std::vector<array::Null> nulls_of(const py::object& places, const py::object& radii);
/// An array of shape (n,) of finite numbers.
std::vector<double> numbers_of(const std::string& name, py::handle value);
/// Metres: a finite number, or a text such as "3mm".
double length_of(const std::string& name, py::handle value);
/// An array of shape (4, 4), rows as in files.
Transform transform_of(const std::string& name, py::handle value);
/// Any finite array of shape (4, 4).
Transform matrix_of(const std::string& name, py::handle value);
/// An array of shape (m, 3) of whole numbers below `points`.
std::vector<glm::uvec3> triangles_of(const std::string& name, py::handle value, std::size_t points);
/// True or False, also NumPy's.
bool is_flag(py::handle value);
/// Depth images, each a path or an array: one, or a sequence of them, such as an array of shape (n, height, width).
std::vector<py::object> depth_images_of(const char* name, const py::object& value);
/// An array of shape (height, width) or (height, width, 1) of 16-bit depths.
std::vector<std::uint16_t> depths_of(const std::string& name, py::handle value, std::uint32_t width,
                                     std::uint32_t height);
/// A complex vector with an entry for each transducer.
array::Drive drive_of(const std::string& name, py::handle value, const array::Layout& layout);

/// Makes it read-only.
py::array sealed(py::array array);
/// Shows memory of `owner` without a copy; `strides` in bytes, empty: contiguous.
template <typename T>
py::array shown(const T* data, std::vector<py::ssize_t> shape, py::handle owner,
                std::vector<py::ssize_t> strides = {}) {
  return sealed(py::array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner));
}
/// (n, 3) float64.
py::array shown(const std::vector<Vec3>& points, py::handle owner);
/// (m, 3) uint32.
py::array shown(const std::vector<glm::uvec3>& triangles, py::handle owner);

/// A copy.
template <typename T>
py::array copied(std::span<const T> values) {
  return sealed(py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data()));
}
py::array copied(const Vec3& point);
py::array copied(const std::vector<Vec3>& points);
/// Rows as in files.
py::array copied(const Transform& transform);
/// (p05, p50, p95).
py::tuple range_of(const setup::Percentiles& percentiles);
/// One for each axis.
py::tuple range_of(const std::array<setup::Percentiles, 3>& axes);
/// The times of steps, which are in milliseconds.
py::dict seconds_of(std::span<const std::pair<std::string, double>> times);
/// amplitude exp(i phase), in an array of this shape; by default, in one row.
py::array complex_of(std::span<const array::TransducerDrive> drive, std::vector<py::ssize_t> shape = {});

}  // namespace palpa::python
