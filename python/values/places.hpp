// Where a field is wanted: planes, lines, points and surfaces.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "setup/options/places.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Places`, as plane() and line() make them.
struct PlacesObject {
  setup::Places places;
  py::object frame{};  ///< that of the points they were made from; see placed.hpp
  /// The shape of an array with one entry per place: (rows, columns) of a plane, otherwise (n,).
  std::vector<py::ssize_t> shape() const;
};

/// The places of a Places, of points (n, 3), of a Mesh, or of a pair (vertices, faces). Throws bad_usage.
PlacesObject places_of(const std::string& name, py::handle value);

}  // namespace palpa::python
