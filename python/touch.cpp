#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "acoustics/felt/skin.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "module.hpp"
#include "own.hpp"
#include "running.hpp"
#include "sensing/rays.hpp"
#include "sensing/rig.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/touch_input.hpp"
#include "setup/tasks/touch.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"
#include "values/arrays.hpp"
#include "values/cameras.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"

namespace palpa::python {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct TouchArguments {
  setup::TouchTask task;
  setup::CommonOptions common;
  setup::TouchInputOptions input;
};
void add_touch_options_of(CLI::App& app, TouchArguments& o) {
  setup::add_task_options(app, o.task);
  setup::add_common(app, o.common);
}
constinit DeclaredOnce<TouchArguments> touch_options("Scene.touch", add_touch_options_of, outputs_of_commands);

bool is_text_or_path(py::handle value) {
  return path_of(value).has_value();
}

/// Depth images as arrays, with the cameras of files.
setup::TouchInput depth_arrays(const std::vector<py::object>& images, const setup::TouchInputOptions& o) {
  setup::TouchInput input;
  input.cameras = setup::load_cameras(o);
  for (std::size_t i = 0; i < images.size(); ++i) {
    sensing::DepthFrame frame;
    frame.depth = depths_of("depth", images[i], input.cameras[i].width, input.cameras[i].height);
    input.frames.push_back(std::move(frame));
  }
  input.point_count = sensing::count_valid(input.cameras, input.frames);
  setup::warn_of_min_range(input);
  return input;
}

setup::TouchInput skin_of(const SceneObject& scene, const py::object& skin, const py::object& depth,
                          const py::object& camera, const py::object& rig, const py::object& penetration) {
  setup::TouchInputOptions o;
  o.scene = scene.name();
  const std::vector<py::object> images = depth_images_of("depth", depth);
  take_cameras(camera, o);
  if (!rig.is_none()) o.rig = file_of("rig", rig);
  if (!penetration.is_none()) o.penetration_m = length_of("penetration", penetration);
  if (o.penetration_m && std::abs(*o.penetration_m) > 10) throw bad_usage("penetration: at most 10 m");
  const bool files = std::ranges::all_of(images, is_text_or_path);
  for (std::size_t i = 0; i < images.size(); ++i)
    o.depths.push_back(files ? file_of("depth", images[i]) : fmt::format("image {}", i));
  std::vector<Vec3> points;
  refuse_other_frame("skin", skin);
  if (!skin.is_none()) {
    o.points = path_of(skin).value_or("skin");
    if (!is_text_or_path(skin)) points = points_of("skin", skin);
  }
  check(o);
  if (!images.empty() && !files) return depth_arrays(images, o);
  if (skin.is_none() || is_text_or_path(skin)) {
    return unlocked([&] { return setup::load_touch_input(o, scene.solids); });
  }
  setup::warn_of_skin("skin:", points);
  if (o.penetration_m && !points.empty()) {
    const double dy = setup::lowering(scene.solids, points, *o.penetration_m);
    for (Vec3& point : points)
      point.y += dy;
  }
  return setup::skin_points(o.points, points);
}

std::shared_ptr<TouchObject> touch_scene(const SceneObject& scene, const py::object& skin, const py::object& depth,
                                         const py::object& camera, const py::object& rig, const py::object& penetration,
                                         const py::kwargs& kwargs) {
  refuse_fork();
  const py::kwargs rest = py::reinterpret_steal<py::kwargs>(PyDict_Copy(kwargs.ptr()));
  OwnFunctions own;
  take_method(rest, own);
  TouchArguments o = touch_options().read(rest);
  o.task.compute = o.common;
  o.task.own_method = own_method(own, scene.solids);
  o.task.kept_solids = scene.kept_solids;
  const setup::Stopwatch begin;
  const setup::TouchInput input = skin_of(scene, skin, depth, camera, rig, penetration);
  check(o.task, !input.cameras.empty());
  const auto compute = [&] {
    o.task.compute.device = setup::kept_device(o.common);
    setup::TouchResult result = setup::touch_scene(o.task, scene.name(), scene.solids, input, begin);
    if (result.unreached && !own.fault) log::warning(*result.unreached);
    return std::make_shared<TouchObject>(TouchObject{std::move(result.values), 0, result.unreached});
  };
  // Ctrl-C needs another thread, which costs more time than a small touch.
  constexpr std::size_t few_points = 100'000;
  const bool is_small = !setup::on_gpu(o.common) && !o.task.touch.tune && !o.task.felt.spectrum &&
                        input.points.size() < few_points && input.frames.empty();
  std::shared_ptr<TouchObject> made = is_small ? unlocked(compute) : cancellable(compute);
  own.throw_fault();
  return made;
}

template <typename T, typename Get>
py::array column(const std::vector<touch::Contact>& contacts, Get get) {
  py::array_t<T> array(static_cast<py::ssize_t>(contacts.size()));
  T* to = array.mutable_data();
  for (const touch::Contact& contact : contacts)
    *to++ = static_cast<T>(get(contact));
  return sealed(std::move(array));
}

/// The rows of a finger's contacts in the touch's.
py::array contacts_of(const FingerObject& o) {
  py::array_t<std::int64_t> rows(static_cast<py::ssize_t>(o.finger().contacts.size()));
  std::ranges::copy(o.finger().contacts, rows.mutable_data());
  return sealed(std::move(rows));
}

py::array foci_of(const touch::Placement& placement) {
  py::array_t<double> foci({static_cast<py::ssize_t>(placement.foci.size()), py::ssize_t{3}});
  double* to = foci.mutable_data();
  for (std::size_t i = 0; i < placement.foci.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      *to++ = placement.has(i) ? double{placement.foci[i].position[axis]} : nan;
  }
  return in_world(sealed(std::move(foci)));
}

/// The pressures at the foci, nan for a sector without its own focus.
py::object pressures_of(const FingerObject& o) {
  if (o.values().pressures.empty()) return py::none();
  const std::vector<double>& pressures = o.values().pressures[o.index];
  const touch::Placement& placement = o.scheduled().placement;
  py::array_t<double> array(static_cast<py::ssize_t>(placement.foci.size()));
  std::size_t filled = 0;
  for (std::size_t i = 0; i < placement.foci.size(); ++i)
    array.mutable_data()[i] = placement.has(i) ? pressures[placement.together ? filled++ : i] : nan;
  return sealed(std::move(array));
}

py::dict spectrum_dict(const acoustics::Spectrum& spectrum) {
  const auto lines = static_cast<py::ssize_t>(spectrum.lines.size());
  py::dict made;
  const auto add = [&](const char* key, auto get) {
    py::array_t<double> values(lines);
    for (std::size_t i = 0; i < spectrum.lines.size(); ++i)
      values.mutable_data()[i] = get(spectrum.lines[i]);
    made[key] = sealed(std::move(values));
  };
  add("frequency", [](const acoustics::Line& l) { return l.frequency_hz; });
  add("amplitude", [](const acoustics::Line& l) { return l.amplitude; });
  add("phase", [](const acoustics::Line& l) { return l.phase_rad; });
  add("around", [](const acoustics::Line& l) { return l.around; });
  add("hold", [](const acoustics::Line& l) { return l.hold; });
  add("felt", [](const acoustics::Line& l) { return acoustics::felt_as_vibration(l); });
  made["skin"] = copied(spectrum.skin);
  made["period"] = spectrum.period_s;
  made["variance"] = spectrum.variance;
  const acoustics::Felt all = acoustics::felt(spectrum);
  made["felt_share"] = all.vibration;
  made["flutter_share"] = all.flutter;
  return made;
}

py::object spectrum_of(const FingerObject& o) {
  if (o.values().spectra.empty()) return py::none();
  return spectrum_dict(o.values().spectra[o.index]);
}

py::object tuned_of(const FingerObject& o) {
  const std::optional<acoustics::Tuned>& tuned = o.scheduled().tuned;
  if (!tuned) return py::none();
  py::dict made;
  made["foci"] = tuned->ring.foci;
  made["stride"] = tuned->ring.stride;
  made["dwell"] = tuned->ring.dwell_s;
  made["changed"] = tuned->changed;
  made["felt_share_before"] = tuned->before.vibration;
  made["felt_share"] = tuned->after.vibration;
  made["flutter_share_before"] = tuned->before.flutter;
  made["flutter_share"] = tuned->after.flutter;
  return made;
}

Vec3 wide(const glm::vec3& v) {
  return Vec3(v);
}

void add_finger(py::module_& m) {
  py::class_<FingerObject>(m, "Finger", "A finger of a Touch: one cluster of contacts on one solid.")
      .def_property_readonly(
          "id", [](const FingerObject& o) { return o.finger().id; },
          "int: stays the same from frame to frame of a Session; in a single touch, the index.")
      .def_property_readonly(
          "solid", [](const FingerObject& o) { return o.values().solids[o.finger().solid]; },
          "str: the name of the touched solid.")
      .def_property_readonly("contacts", contacts_of,
                             "ndarray of int64, shape (k,): its rows in the arrays of Touch.contacts.")
      .def_property_readonly(
          "positions",
          [](const FingerObject& o) {
            std::vector<Vec3> positions;
            for (const std::uint32_t row : o.finger().contacts)
              positions.emplace_back(o.values().touch.contacts[row].position);
            return in_world(copied(positions));
          },
          "ndarray of float64, shape (k, 3): of its contacts, metres, world.")
      .def_property_readonly(
          "depths",
          [](const FingerObject& o) {
            std::vector<double> depths;
            for (const std::uint32_t row : o.finger().contacts)
              depths.push_back(double{o.values().touch.contacts[row].depth_m});
            return copied(std::span<const double>(depths));
          },
          "ndarray of float64, shape (k,): of its contacts, metres below the surface.")
      .def_property_readonly(
          "centroid", [](const FingerObject& o) { return in_world(copied(wide(o.finger().section.centroid))); },
          "ndarray of float64, shape (3,): mean of its contacts, metres, world.")
      .def_property_readonly(
          "axes",
          [](const FingerObject& o) {
            const auto& axes = o.finger().section.axes;
            return copied(std::vector<Vec3>{wide(axes[0]), wide(axes[1]), wide(axes[2])});
          },
          "ndarray of float64, shape (3, 3): rows w1, w2, w3, the eigenvectors of the contacts' covariance (Eq. 2 to "
          "4).")
      .def_property_readonly(
          "eigenvalues",
          [](const FingerObject& o) {
            const auto& values = o.finger().section.eigenvalues;
            return copied(Vec3(values[0], values[1], values[2]));
          },
          "ndarray of float64, shape (3,): square metres, in the order of the axes.")
      .def_property_readonly(
          "depth", [](const FingerObject& o) { return double{o.finger().depth_m}; },
          "float: depth of its deepest skin point, metres.")
      .def_property_readonly(
          "foci", [](const FingerObject& o) { return foci_of(o.scheduled().placement); },
          "ndarray of float64, shape (N, 3): metres, world (Eq. 6 and 7); nan for an empty sector.")
      .def_property_readonly(
          "focus_points",
          [](const FingerObject& o) {
            py::array_t<std::int64_t> counts(static_cast<py::ssize_t>(o.scheduled().placement.foci.size()));
            std::ranges::transform(o.scheduled().placement.foci, counts.mutable_data(),
                                   [](const touch::Focus& focus) { return focus.points; });
            return sealed(std::move(counts));
          },
          "ndarray of int64, shape (N,): the number of contacts in each focus' sector.")
      .def_property_readonly(
          "together", [](const FingerObject& o) { return o.scheduled().placement.together; },
          "bool: whether its foci sound at once.")
      .def_property_readonly(
          "order", [](const FingerObject& o) { return copied(std::span<const std::uint32_t>(o.voice().order)); },
          "ndarray of uint32, shape (k,): the order in which played_foci sound.")
      .def_property_readonly(
          "played_foci", [](const FingerObject& o) { return in_world(copied(o.voice().foci)); },
          "ndarray of float64, shape (k, 3): the foci as they sound; an empty sector has its neighbour's. Metres, "
          "world.")
      .def_property_readonly(
          "dwell", [](const FingerObject& o) { return o.voice().dwell_s; },
          "float: how long each focus lasts, seconds.")
      .def_property_readonly(
          "modulation_frequency", [](const FingerObject& o) { return o.voice().modulation_hz; },
          "float: hertz; 0 if its foci move.")
      .def_property_readonly(
          "gain", [](const FingerObject& o) { return o.voice().gain; }, "float: intensity, 0 to 1.")
      .def_property_readonly(
          "perimeter", [](const FingerObject& o) { return o.scheduled().perimeter_m; },
          "float: length of the path of its foci, metres; 0 without spectrum or tune, or if they stand still.")
      .def_property_readonly("pressures", pressures_of,
                             "ndarray of float64, shape (N,), or None: peak pressure at each focus in pascals, if a "
                             "layout was given; nan for an empty sector.")
      .def_property_readonly(
          "spectrum", spectrum_of,
          "dict or None: what the skin feels in time, if spectrum=True was given. One array entry "
          "per line: frequency (Hz), amplitude, phase (rad), around, hold, felt. For all lines together: "
          "felt_share and flutter_share, the shares of vibration and flutter (docs/methods.md).")
      .def_property_readonly(
          "tuned", tuned_of,
          "dict or None: what tune=True chose: foci, stride and dwell (s), whether it `changed` them, felt_share "
          "and flutter_share, and both as they were before (felt_share_before, flutter_share_before).")
      .def("__repr__", [](const FingerObject& o) {
        return fmt::format("<palpa.Finger {} on {}: {}, {}>", o.finger().id, o.values().solids[o.finger().solid],
                           counted(o.finger().contact_count, "contact"),
                           counted(o.scheduled().placement.foci.size(), "focus"));
      });
}

void add_contacts(py::module_& m) {
  py::class_<ContactsObject>(m, "Contacts", "The skin points in the shell of a solid (Eq. 1), ascending by index.")
      .def("__len__", [](const ContactsObject& o) { return o.all().size(); })
      .def_property_readonly(
          "indices",
          [](const ContactsObject& o) {
            return column<std::int64_t>(o.all(), [](const touch::Contact& c) { return c.point; });
          },
          "ndarray of int64, shape (n,): rows of the skin, or pixels v * width + u of depth images.")
      .def_property_readonly(
          "depths",
          [](const ContactsObject& o) {
            return column<double>(o.all(), [](const touch::Contact& c) { return c.depth_m; });
          },
          "ndarray of float64, shape (n,): metres below the surface, above 0 and below delta.")
      .def_property_readonly(
          "positions",
          [](const ContactsObject& o) {
            std::vector<Vec3> positions;
            positions.reserve(o.all().size());
            for (const touch::Contact& contact : o.all())
              positions.emplace_back(contact.position);
            return in_world(copied(positions));
          },
          "ndarray of float64, shape (n, 3): metres, world.")
      .def_property_readonly(
          "solids",
          [](const ContactsObject& o) {
            return column<std::int64_t>(o.all(), [](const touch::Contact& c) { return c.solid; });
          },
          "ndarray of int64, shape (n,): index of the solid.")
      .def("__repr__", [](const ContactsObject& o) { return fmt::format("<palpa.Contacts: {}>", o.all().size()); });
}

void add_touch_class(py::module_& m) {
  py::class_<TouchObject, std::shared_ptr<TouchObject>>(
      m, "Touch", "One frame of skin and the solids of a scene: contacts, fingers, foci and their schedule.")
      .def_property_readonly(
          "contacts", [](const std::shared_ptr<TouchObject>& o) { return ContactsObject{o}; }, "Contacts")
      .def_property_readonly(
          "fingers",
          [](const std::shared_ptr<TouchObject>& o) {
            std::vector<FingerObject> fingers;
            for (std::uint32_t f = 0; f < o->values.touch.finger_count; ++f)
              fingers.push_back({o, f});
            return fingers;
          },
          "list of Finger: ordered by their smallest contact.")
      .def_property_readonly(
          "points", [](const TouchObject& o) { return o.values.points; },
          "int: the number of skin points; of valid pixels with depth images.")
      .def_readonly("time", &TouchObject::time_s, "float: capture time of a Session's frame, seconds.")
      .def_property_readonly(
          "order", [](const TouchObject& o) { return copied(std::span<const std::uint32_t>(o.values.common.order)); },
          "ndarray of uint32: the order of the foci of a finger without a schedule of its own.")
      .def_property_readonly(
          "dwell", [](const TouchObject& o) { return o.values.common.dwell_s; },
          "float: how long a focus lasts, seconds.")
      .def_property_readonly(
          "slot", [](const TouchObject& o) { return o.values.schedule.slot_s; },
          "float: how long one drive lasts, seconds.")
      .def_property_readonly(
          "audible",
          [](const TouchObject& o) -> std::optional<std::pair<double, double>> {
            if (!o.values.ear) return std::nullopt;
            return std::pair(o.values.ear->low_dba, o.values.ear->high_dba);
          },
          "(float, float), or None: how loud the array is to the ear, beside its beam, from and to, dB(A), if "
          "audible=True was given. -inf where it makes no sound.")
      .def_readonly("unreached", &TouchObject::unreached,
                    "str or None: a sentence about a pressure that the array does not reach.")
      .def_property_readonly(
          "timing",
          [](const TouchObject& o) {
            py::dict times = seconds_of(o.values.times);
            times["total"] = o.values.total_ms * 1e-3;
            return times;
          },
          "dict of str to float: seconds of each step.")
      .def(
          "json", [](const TouchObject& o) { return unlocked([&] { return to_json(o.values); }); },
          "str: what `palpa touch --json` writes. Only `timing_ms` differs between runs.")
      .def(
          "csv", [](const TouchObject& o) { return unlocked([&] { return to_csv(o.values); }); },
          "str: what `palpa touch --csv` writes: index,x,y,z,depth,finger,solid of each contact.")
      .def("__repr__", [](const TouchObject& o) {
        return fmt::format("<palpa.Touch: {}, {}>", counted(o.values.touch.contacts.size(), "contact"),
                           counted(o.values.touch.finger_count, "finger"));
      });
}

}  // namespace

void add_touch(py::module_& m) {
  add_contacts(m);
  add_finger(m);
  add_touch_class(m);
  const std::string doc =
      touch_options().documented(R"(Touch the scene once: contacts, fingers, cross-sections, foci and their schedule.

The engine's equations are (1) to (7) of the paper; docs/touch.md has the rules that it leaves open.

Parameters
----------
skin : array_like, shape (n, 3), or path, optional
    Points of the skin, in metres, world; or a PLY file with them.
depth : path, ndarray of uint16, or list of these, optional
    Depth images instead of `skin`, shape (height, width), in the unit of their cameras.
camera : Camera, path or list of these, optional
    The camera of each depth image, or its TOML file.
rig : path, optional
    TOML file of all cameras, instead of `camera`. The default is the paper's rig.
penetration : float or str, optional
    Moves `skin` along y, so that its lowest point is this far below the solids' top, in metres.
method : str or callable, optional
    `method` may also be a function: it gets a Finger and returns its foci, an array_like of shape (n, 3), metres, world.

Returns
-------
Touch
    Without contacts, nothing was touched; that is no error.

Raises
------
BadUsage
    Arrays or options that cannot be used.
BadInput
    A file that is missing or broken.
NoDevice
    There is no usable GPU, but one was asked for.)");
  const py::object scene = m.attr("Scene");
  scene.attr("touch") =
      py::cpp_function(&touch_scene, py::name("touch"), py::is_method(scene), py::arg("skin") = py::none(),
                       py::kw_only(), py::arg("depth") = py::none(), py::arg("camera") = py::none(),
                       py::arg("rig") = py::none(), py::arg("penetration") = py::none(), doc.c_str());
}

}  // namespace palpa::python
