// Points that know their frame, and drives that know their layout: arrays of the class in palpa/_placed.py. What is
// used in another frame, or with another array, is refused. Other arrays are taken as they are.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "layout.hpp"

namespace palpa::python {

namespace py = pybind11;

/// Points in the world.
py::array in_world(const py::array& points);
/// Points in the layout's own frame, or drives of its transducers.
py::array of_layout(const py::array& array, const std::shared_ptr<LayoutObject>& layout);

/// Where these points belong: "world", a Layout, or null if it is not known. Like the functions below, looks at Places,
/// and into lists and tuples of arrays. Throws bad_usage if they belong to different frames.
py::object frame_of(const std::string& name, py::handle points);
/// Points of such a frame.
py::array in_frame(const py::array& points, const py::object& frame);

/// Throws bad_usage, naming `name` and both frames, for points that are known to be in another frame than the layout's.
void refuse_other_frame(const std::string& name, py::handle points, const LayoutObject& layout);
/// The same for points that must be in the world.
void refuse_other_frame(const std::string& name, py::handle points);

/// A Drive, or a complex vector with an entry for each transducer. Throws bad_usage, naming both, if it is of another
/// layout.
array::Drive drive_of_layout(const std::string& name, py::handle drive, const LayoutObject& layout);
/// The same for a layout that no Python object has.
array::Drive drive_of_layout(const std::string& name, py::handle drive, const array::Layout& layout);

}  // namespace palpa::python
