#include "values/placed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "module.hpp"
#include "values/arrays.hpp"
#include "values/places.hpp"

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

/// Where the points of an array, of Places, or of the arrays in a list belong, as far as it is known.
std::vector<py::object> places_in(py::handle points) {
  std::vector<py::object> places;
  const auto add = [&](const py::object& place) {
    const bool known = place && !place.is_none();
    if (known && std::ranges::none_of(places, [&](const py::object& other) { return other.is(place); }))
      places.push_back(place);
  };
  if (py::isinstance<PlacesObject>(points)) {
    add(points.cast<const PlacesObject&>().frame);
  } else if (py::isinstance<py::list>(points) || py::isinstance<py::tuple>(points)) {
    for (const py::handle part : points)
      add(place_of(part));
  } else {
    add(place_of(points));
  }
  return places;
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

/// The same transducers, moved or not: seen from the first one, along its axis and towards the last one.
bool are_alike(const std::vector<array::Transducer>& a, const std::vector<array::Transducer>& b) {
  const auto seen = [](const std::vector<array::Transducer>& all, const array::Transducer& one) {
    const Vec3 place = one.position - all.front().position, last = all.back().position - all.front().position;
    return Vec3(glm::length(place), glm::dot(place, all.front().axis),
                glm::dot(glm::cross(last, place), all.front().axis));
  };
  return std::ranges::equal(a, b, [&](const array::Transducer& one, const array::Transducer& other) {
    return glm::distance(seen(a, one), seen(b, other)) < 1e-6;
  });
}

std::string name_of(const LayoutObject& layout) {
  const std::string& source = layout.source;
  const std::string from = source.empty() || source == layout.layout.name ? "" : fmt::format(" ({})", source);
  return fmt::format("the {}layout {}{}", layout.unmoved ? "moved " : "", layout.layout.name, from);
}

bool are_in_one_frame(const LayoutObject& a, const LayoutObject& b) {
  return &a == &b || are_same(a.layout.transducers, b.layout.transducers) || (is_in_world(a) && is_in_world(b));
}

bool are_in_one_frame(const py::object& a, const py::object& b) {
  const bool a_of_layout = py::isinstance<LayoutObject>(a), b_of_layout = py::isinstance<LayoutObject>(b);
  if (a_of_layout && b_of_layout) return are_in_one_frame(a.cast<const LayoutObject&>(), b.cast<const LayoutObject&>());
  return (!a_of_layout || is_in_world(a.cast<const LayoutObject&>())) &&
         (!b_of_layout || is_in_world(b.cast<const LayoutObject&>()));
}

std::string name_of_frame(const py::object& place) {
  return py::isinstance<LayoutObject>(place) ? "that of " + name_of(place.cast<const LayoutObject&>()) : "the world";
}

}  // namespace

py::array in_world(const py::array& points) {
  return arrays().attr("placed")(points, "world");
}

py::array in_frame(const py::array& points, const py::object& frame) {
  return frame ? py::array(arrays().attr("placed")(points, frame)) : points;
}

py::array of_layout(const py::array& array, const LayoutPtr& layout) {
  return arrays().attr("placed")(array, layout);
}

void refuse_other_frame(const std::string& name, py::handle points, const LayoutObject& layout) {
  for (const py::object& place : places_in(points)) {
    if (!py::isinstance<LayoutObject>(place)) {
      if (is_in_world(layout)) continue;
      throw bad_usage(
          fmt::format("{}: these points are in the world, but {} takes points in its own frame: give "
                      "layout.from_world(points), or a whole Touch to layout.solve_touch",
                      name, name_of(layout)));
    }
    const auto& other = place.cast<const LayoutObject&>();
    if (are_in_one_frame(other, layout)) continue;
    throw bad_usage(fmt::format(
        "{}: these points are in the frame of {}, but {} takes points in its own: convert them, and give a plain array",
        name, name_of(other), name_of(layout)));
  }
}

void refuse_other_frame(const std::string& name, py::handle points) {
  for (const py::object& place : places_in(points)) {
    if (!py::isinstance<LayoutObject>(place) || is_in_world(place.cast<const LayoutObject&>())) continue;
    throw bad_usage(
        fmt::format("{}: these points are in the frame of {}, but points in the world are taken here: "
                    "convert them, and give a plain array",
                    name, name_of(place.cast<const LayoutObject&>())));
  }
}

py::object frame_of(const std::string& name, py::handle points) {
  py::object frame;
  for (const py::object& place : places_in(points)) {
    if (frame && !are_in_one_frame(frame, place)) {
      throw bad_usage(fmt::format("{}: these points are in different frames, {} and {}: convert some of them", name,
                                  name_of_frame(frame), name_of_frame(place)));
    }
    if (!frame) frame = place;
  }
  return frame;
}

namespace {

/// The layout of a drive; null if it is not known.
LayoutPtr layout_of(py::handle drive) {
  if (py::isinstance<DriveObject>(drive)) return drive.cast<const DriveObject&>().layout;
  const py::object place = place_of(drive);
  return py::isinstance<LayoutObject>(place) ? place.cast<LayoutPtr>() : nullptr;
}

[[noreturn]] void refuse_other_layout(const std::string& name, const LayoutObject& of, const std::string& used) {
  throw bad_usage(fmt::format("{}: this drive is for {}, but is used with {}, whose transducers stand elsewhere", name,
                              name_of(of), used));
}

}  // namespace

array::Drive drive_of_layout(const std::string& name, py::handle drive, const LayoutObject& layout) {
  const LayoutPtr of = layout_of(drive);
  if (of && of.get() != &layout && !are_same(transducers_of(*of), transducers_of(layout)))
    refuse_other_layout(name, *of, name_of(layout));
  return drive_of(name, drive, layout.layout);
}

array::Drive drive_of_layout(const std::string& name, py::handle drive, const array::Layout& layout) {
  const LayoutPtr of = layout_of(drive);
  if (of && !are_alike(of->layout.transducers, layout.transducers))
    refuse_other_layout(name, *of, fmt::format("the layout {}", layout.name));
  return drive_of(name, drive, layout);
}

}  // namespace palpa::python
