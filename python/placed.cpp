#include "placed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "arrays.hpp"
#include "base/error.hpp"
#include "module.hpp"

namespace palpa::python {
namespace {

using LayoutPtr = std::shared_ptr<LayoutObject>;

/// The module of the arrays. It is imported when the first of them is made, because it imports NumPy.
py::module_ arrays() {
  return py::module_::import("palpa._placed");
}

/// Where an array belongs; null or None if that is not known.
py::object place_of(py::handle array) {
  if (!py::isinstance<py::array>(array) || !py::isinstance(array, arrays().attr("Placed"))) return py::none();
  return array.attr("of");
}

/// A layout whose own frame is the world, such as `paper` and layouts that were moved.
bool is_in_world(const LayoutObject& layout) {
  return layout.layout.default_T_world_layout == Transform(1.0);
}

const std::vector<array::Transducer>& transducers_of(const LayoutObject& layout) {
  return layout.unmoved ? *layout.unmoved : layout.layout.transducers;
}

bool are_same(const std::vector<array::Transducer>& a, const std::vector<array::Transducer>& b) {
  return std::ranges::equal(a, b, [](const array::Transducer& one, const array::Transducer& other) {
    return one.position == other.position && one.axis == other.axis;
  });
}

std::string name_of(const LayoutObject& layout) {
  const std::string& source = layout.source;
  const std::string from = source.empty() || source == layout.layout.name ? "" : fmt::format(" ({})", source);
  return fmt::format("the {}layout {}{}", layout.unmoved ? "moved " : "", layout.layout.name, from);
}

}  // namespace

py::array in_world(const py::array& points) {
  return arrays().attr("placed")(points, "world");
}

py::array of_layout(const py::array& array, const LayoutPtr& layout) {
  return arrays().attr("placed")(array, layout);
}

void refuse_other_frame(const std::string& name, py::handle points, const LayoutObject& layout) {
  const py::object place = place_of(points);
  if (py::isinstance<py::str>(place) && !is_in_world(layout)) {
    throw bad_usage(
        fmt::format("{}: these points are in the world, but {} takes points in its own frame: give "
                    "layout.from_world(points), or a whole Touch to layout.solve_touch",
                    name, name_of(layout)));
  }
  if (!py::isinstance<LayoutObject>(place)) return;
  const auto& other = place.cast<const LayoutObject&>();
  if (&other == &layout || are_same(other.layout.transducers, layout.layout.transducers)) return;
  if (is_in_world(other) && is_in_world(layout)) return;
  throw bad_usage(fmt::format(
      "{}: these points are in the frame of {}, but {} takes points in its own: convert them, and give a plain array",
      name, name_of(other), name_of(layout)));
}

void refuse_other_frame(const std::string& name, py::handle points) {
  const py::object place = place_of(points);
  if (!py::isinstance<LayoutObject>(place)) return;
  const auto& other = place.cast<const LayoutObject&>();
  if (is_in_world(other)) return;
  throw bad_usage(
      fmt::format("{}: these points are in the frame of {}, but points in the world are taken here: "
                  "convert them, and give a plain array",
                  name, name_of(other)));
}

array::Drive drive_of_layout(const std::string& name, py::handle drive, const LayoutObject& layout) {
  LayoutPtr of;
  if (py::isinstance<DriveObject>(drive)) {
    of = drive.cast<const DriveObject&>().layout;
  } else if (const py::object place = place_of(drive); py::isinstance<LayoutObject>(place)) {
    of = place.cast<LayoutPtr>();
  }
  if (of && of.get() != &layout && !are_same(transducers_of(*of), transducers_of(layout))) {
    throw bad_usage(fmt::format("{}: this drive is for {}, but is used with {}, whose transducers stand elsewhere",
                                name, name_of(*of), name_of(layout)));
  }
  return drive_of(name, drive, layout.layout);
}

}  // namespace palpa::python
