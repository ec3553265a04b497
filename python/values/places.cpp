#include "values/places.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "module.hpp"
#include "running.hpp"
#include "shapes.hpp"
#include "values/arrays.hpp"
#include "values/placed.hpp"

namespace palpa::python {

std::vector<py::ssize_t> PlacesObject::shape() const {
  if (places.grid) return {places.grid->rows, places.grid->columns};
  return {static_cast<py::ssize_t>(places.points.size())};
}

PlacesObject places_of(const std::string& name, py::handle value) {
  if (py::isinstance<PlacesObject>(value)) return value.cast<const PlacesObject&>();
  const bool pair = py::isinstance<py::tuple>(value) && py::len(value) == 2;
  if (py::isinstance<MeshObject>(value) || pair || path_of(value)) {
    NamedMesh mesh = mesh_of(name, value);
    return {setup::point_places(std::move(mesh.mesh.positions), std::move(mesh.mesh.triangles))};
  }
  return {setup::point_places(points_of(name, value))};
}

namespace {

setup::Plane plane_word(const std::string& word) {
  if (const auto plane = value_of(setup::plane_words, word)) return *plane;
  throw bad_usage(fmt::format("plane: '{}' is not one of xy, xz, yz", printable(word, 60)));
}

std::array<double, 2> two_numbers(const char* name, const py::object& value) {
  const std::vector<double> numbers = numbers_of(name, value);
  if (numbers.size() != 2) throw bad_usage(fmt::format("{}: give two numbers, right and up", name));
  return {numbers[0], numbers[1]};
}

std::uint32_t pixel_count(double number) {
  constexpr double most = 65536;
  if (!(number >= 1 && number <= most) || number != static_cast<double>(static_cast<std::uint32_t>(number)))
    throw bad_usage(fmt::format("pixels: {} is not a whole number from 1 to 65536", number));
  return static_cast<std::uint32_t>(number);
}

PlacesObject make_plane(const std::string& plane, const py::object& centre, const py::object& size,
                        const py::object& pixels) {
  setup::Grid grid{.plane = plane_word(plane)};
  if (!centre.is_none()) grid.centre = point_of("centre", centre);
  const auto [right, up] = two_numbers("size", size);
  grid.size_m = {right, up};
  if (!pixels.is_none()) {
    const auto [columns, rows] = two_numbers("pixels", pixels);
    grid.columns = pixel_count(columns);
    grid.rows = pixel_count(rows);
  }
  return {unlocked([&] { return setup::plane_places(grid); }), frame_of("centre", centre)};
}

}  // namespace

void add_places(py::module_& m) {
  py::class_<PlacesObject, std::shared_ptr<PlacesObject>>(m, "Places",
                                                          "Places for Layout.field, made by plane() and line().")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            const auto& o = self.cast<PlacesObject&>();
            return in_frame(shown(o.places.points, self), o.frame);
          },
          "ndarray of float64, shape (n, 3): metres; of a plane row by row from the top; read-only, not copied.")
      .def_property_readonly(
          "shape", [](const PlacesObject& o) { return py::tuple(py::cast(o.shape())); },
          "tuple of int: the shape of a field at these places, (rows, columns) or (n,).")
      .def_property_readonly(
          "extent",
          [](const PlacesObject& o) -> py::object {
            if (!o.places.grid) return py::none();
            const setup::Grid& g = *o.places.grid;
            const bool first_y = g.plane == setup::Plane::yz;
            const double right = first_y ? g.centre.y : g.centre.x;
            const double up = g.plane == setup::Plane::xy ? g.centre.y : g.centre.z;
            return py::make_tuple(right - g.size_m.x / 2, right + g.size_m.x / 2, up - g.size_m.y / 2,
                                  up + g.size_m.y / 2);
          },
          "tuple of float or None: left, right, bottom, top of a plane in metres, as matplotlib's imshow takes them.")
      .def("__len__", [](const PlacesObject& o) { return o.places.points.size(); })
      .def("__repr__", [](const PlacesObject& o) {
        return fmt::format("<palpa.Places: {}>", o.places.grid
                                                     ? counted(o.places.points.size(), "pixel") + " of a plane"
                                                     : counted(o.places.points.size(), "sample") + " of a line");
      });
  m.def("plane", &make_plane, py::arg("plane"), py::kw_only(), py::arg("centre") = py::none(), py::arg("size"),
        py::arg("pixels") = py::none(), R"(Places on a plane, at the centres of pixels.

Parameters
----------
plane : {"xy", "xz", "yz"}
    The axes that run to the right and up.
centre : array_like, shape (3,), optional
    Metres, in the layout's own frame. The default is the origin.
size : (float, float)
    Width and height, metres.
pixels : (int, int), optional
    Columns and rows. The default is square pixels, 256 on the longer side.

Returns
-------
Places
    A field there has the shape (rows, columns), rows from the top.)");
  m.def(
      "line",
      [](const py::object& start, const py::object& end, std::uint32_t samples) {
        return PlacesObject{setup::line_places(point_of("start", start), point_of("end", end), samples),
                            frame_of("start, end", py::make_tuple(start, end))};
      },
      py::arg("start"), py::arg("end"), py::kw_only(), py::arg("samples") = 201,
      R"(Places on a line, both ends included.

Parameters
----------
start, end : array_like, shape (3,)
    Metres, in the layout's own frame.
samples : int, optional
    At least 2.

Returns
-------
Places)");
}

}  // namespace palpa::python
