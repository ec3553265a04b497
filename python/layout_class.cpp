#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <glm/matrix.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "array/amplitudes.hpp"
#include "array/layouts/builtin_layouts.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "layout.hpp"
#include "layout_doc.hpp"
#include "module.hpp"
#include "running.hpp"
#include "setup/files/drive_file.hpp"
#include "shapes.hpp"
#include "values/arrays.hpp"
#include "values/placed.hpp"

namespace palpa::python {

using LayoutPtr = std::shared_ptr<LayoutObject>;

std::string LayoutObject::option() const {
  if (!source.empty()) return source;
  if (!known) known = std::make_shared<array::KnownLayout>(layout);
  return known->name();
}

std::shared_ptr<LayoutObject> layout_of(const char* name, const py::object& value) {
  if (py::isinstance<LayoutObject>(value)) return value.cast<std::shared_ptr<LayoutObject>>();
  const std::optional<std::string> text = path_of(value);
  if (!text) throw bad_usage(fmt::format("{}: give a palpa.Layout, the name of one, or the path of a TOML", name));
  auto made = std::make_shared<LayoutObject>();
  made->source = *text;
  made->layout = unlocked([&] { return array::load_layout(*text); });
  return made;
}

namespace {

py::array positions_of(const std::vector<array::Transducer>& transducers, Vec3 array::Transducer::*member) {
  std::vector<Vec3> values;
  values.reserve(transducers.size());
  for (const array::Transducer& transducer : transducers)
    values.push_back(transducer.*member);
  return copied(values);
}

py::list boards_of(const LayoutPtr& o) {
  py::list boards;
  for (const array::Board& board : o->layout.boards) {
    py::dict one;
    one["type"] = board.type;
    one["first"] = board.first;
    one["count"] = board.count;
    one["size"] = py::make_tuple(board.width_m, board.height_m);
    one["pose"] = copied(board.T_layout_board);
    boards.append(one);
  }
  return boards;
}

LayoutObject make_layout(const py::object& source, const py::object& name, const py::object& source_level,
                         const py::object& frequency, const py::object& radius, const py::object& law,
                         const py::object& pose) {
  if (!py::isinstance<py::tuple>(source) || py::len(source) != 2) {
    for (const py::object& given : {name, source_level, frequency, radius, law, pose}) {
      if (!given.is_none())
        throw bad_usage(
            "name, source_level, frequency, transducer_radius, amplitude_law and pose go with arrays (positions, "
            "axes)");
    }
    return LayoutObject(*layout_of("Layout", source));
  }
  const auto pair = source.cast<py::tuple>();
  const std::vector<Vec3> positions = points_of("positions", pair[0]), axes = points_of("axes", pair[1]);
  if (positions.size() != axes.size())
    throw bad_usage(fmt::format("axes: there are {} for {} positions", axes.size(), positions.size()));
  array::Layout made;
  if (!name.is_none() && !py::isinstance<py::str>(name)) throw bad_usage("name: give a text");
  made.name = name.is_none() ? "arrays" : bytes_of("name", name);
  made.default_T_world_layout = pose.is_none() ? array::below_facing_up() : transform_of("pose", pose);
  const auto read = [](const char* what, const py::object& given, double& value) {
    if (given.is_none()) return;
    const std::vector<double> numbers = numbers_of(what, given);
    if (numbers.size() != 1) throw bad_usage(fmt::format("{}: give one number", what));
    value = numbers[0];
  };
  read("source_level", source_level, made.source_level_pa_m);
  read("frequency", frequency, made.frequency_hz);
  read("transducer_radius", radius, made.transducer_radius_m);
  if (!law.is_none()) {
    const std::string word = bytes_of("amplitude_law", law);
    const std::optional<array::Weighting> known = value_of(array::weighting_words, word);
    if (!known) throw bad_usage(fmt::format("amplitude_law: give {}", one_of(array::weighting_words)));
    made.amplitude_law = *known;
  }
  for (std::size_t i = 0; i < positions.size(); ++i)
    made.transducers.push_back({positions[i], axes[i]});
  return {array::checked(std::move(made)), ""};
}

py::array from_world(const LayoutPtr& o, const py::object& points, const py::object& pose) {
  refuse_other_frame("points", points);
  std::vector<Vec3> places = points_of("points", points);
  const Transform T_layout_world =
      glm::inverse(pose.is_none() ? o->layout.default_T_world_layout : transform_of("pose", pose));
  for (Vec3& place : places)
    place = transform_point(T_layout_world, place);
  return of_layout(copied(places), o);
}

}  // namespace

py::class_<LayoutObject, LayoutPtr> add_layout_class(py::module_& m) {
  return py::class_<LayoutObject, LayoutPtr>(m, "Layout",
                                             R"(Positions and axes of the transducers of an array, in its own frame.

Parameters
----------
source : str, path, or (positions, axes)
    The name of a built-in layout such as "paper" or "openmpd", or a TOML file (docs/layouts.md), or arrays of shape
    (M, 3): metres, and unit vectors, the directions of the sound. For arrays, there are the options below.
name : str, optional
    For messages.
source_level : float, optional
    Peak pressure at 1 m on the axis at full amplitude, times 1 m; pascal metres. The default is 4.386.
frequency : float, optional
    Hertz, for which the transducers are made. The default is 40 kHz.
transducer_radius : float, optional
    Metres, of the sounding part. The default is 4.5 mm.
amplitude_law : str, optional
    The amplitudes of a focus that sounds alone: "distance", proportional to it as in the paper, or "uniform", all 1,
    which is the default.
pose : array_like, shape (4, 4), optional
    From its own frame to the world, if no rig says otherwise. The default is 150 mm below the origin, facing up.

Raises
------
BadInput
    There is no such layout, or the file is broken.
BadUsage
    The arrays have another shape, or a value is out of range.)")
      .def(py::init(&make_layout), py::arg("source"), py::kw_only(), py::arg("name") = py::none(),
           py::arg("source_level") = py::none(), py::arg("frequency") = py::none(),
           py::arg("transducer_radius") = py::none(), py::arg("amplitude_law") = py::none(),
           py::arg("pose") = py::none())
      .def_static("names", &array::layout_names, "The names of the built-in layouts.\n\nReturns\n-------\nlist of str")
      .def_property_readonly(
          "source", [](const LayoutObject& o) { return shown_text(o.source); },
          "str: its name or file; empty for a moved layout and for one of arrays.")
      .def_property_readonly(
          "name", [](const LayoutObject& o) { return o.layout.name; }, "str")
      .def("__len__", [](const LayoutObject& o) { return o.layout.transducers.size(); })
      .def_property_readonly(
          "positions",
          [](const LayoutObject& o) { return positions_of(o.layout.transducers, &array::Transducer::position); },
          "ndarray of float64, shape (M, 3): metres, in drive order.")
      .def_property_readonly(
          "axes", [](const LayoutObject& o) { return positions_of(o.layout.transducers, &array::Transducer::axis); },
          "ndarray of float64, shape (M, 3): unit vectors, the directions of their sound.")
      .def_property_readonly("boards", &boards_of,
                             "list of dict: type, first, count, size (m) and pose (4 x 4) of each board.")
      .def_property_readonly(
          "source_level", [](const LayoutObject& o) { return o.layout.source_level_pa_m; },
          "float: peak pressure at 1 m on the axis at full amplitude, times 1 m; pascal metres.")
      .def_property_readonly(
          "frequency", [](const LayoutObject& o) { return o.layout.frequency_hz; },
          "float: hertz, for which its transducers are made.")
      .def_property_readonly(
          "transducer_radius", [](const LayoutObject& o) { return o.layout.transducer_radius_m; }, "float: metres.")
      .def_property_readonly(
          "default_pose", [](const LayoutObject& o) { return copied(o.layout.default_T_world_layout); },
          "ndarray of float64, shape (4, 4): from its own frame to the world, if no rig says otherwise.")
      .def(
          "moved",
          [](const LayoutObject& o, const py::object& pose) {
            auto unmoved =
                o.unmoved ? o.unmoved : std::make_shared<const std::vector<array::Transducer>>(o.layout.transducers);
            return LayoutObject{array::transformed(o.layout, transform_of("pose", pose)), "", std::move(unmoved)};
          },
          py::arg("pose"), R"(The same transducers in another frame.

Parameters
----------
pose : array_like, shape (4, 4)
    A rigid transform from the layout's own frame, such as `default_pose`.

Returns
-------
Layout)")
      .def("from_world", &from_world, py::arg("points"), py::arg("pose") = py::none(), from_world_doc)
      .def(
          "read_drive",
          [](const LayoutPtr& o, const py::object& file) {
            const std::string path = file_of("file", file);
            return of_layout(complex_of(unlocked([&] { return setup::load_drive(path, o->layout); })), o);
          },
          py::arg("file"), R"(Read a drive that `palpa drive --csv` or Layout.write_drive wrote.

Returns
-------
ndarray of complex128, shape (M,)

Raises
------
BadInput
    The file is broken, or is of another layout.)")
      .def(
          "write_drive",
          [](const LayoutObject& o, const py::object& file, const py::object& drive) {
            const std::string path = file_of("file", file);
            const array::Drive driven = drive_of_layout("drive", drive, o);
            unlocked([&] { write_file(path, setup::drive_csv(o.layout, driven)); });
          },
          py::arg("file"), py::arg("drive"),
          "Write a drive as CSV: index,x,y,z,nx,ny,nz,amplitude,phase of each transducer.\n\n"
          "Parameters\n----------\nfile : path\ndrive : Drive or array_like of complex, shape (M,)")
      .def("__repr__", [](const LayoutObject& o) {
        return fmt::format("<palpa.Layout {}: {}>", o.layout.name, counted(o.layout.transducers.size(), "transducer"));
      });
}

}  // namespace palpa::python
