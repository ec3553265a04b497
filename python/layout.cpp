#include "layout.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/resolution.hpp"
#include "array/schedule.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "layout_doc.hpp"
#include "line/together.hpp"
#include "module.hpp"
#include "own.hpp"
#include "running.hpp"
#include "setup/options/options.hpp"
#include "setup/options/spread.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/foci.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"
#include "values/places.hpp"

namespace palpa::python {

namespace {

using LayoutPtr = std::shared_ptr<LayoutObject>;

// ---- options --------------------------------------------------------------------------------------------------------

struct SolveArguments {
  py::object own_solver{};
  setup::FocusingOptions drive;
  setup::SpreadOptions spread;
  setup::CommonOptions common;
};
void add_solve_options(CLI::App& app, SolveArguments& o) {
  setup::add_drive_options(app, o.drive, setup::FingerMesh::known);
  setup::add_spread_options(app, o.spread);
  setup::add_common(app, o.common);
}

struct FieldArguments {
  setup::FieldTask task;
  setup::CommonOptions common;
};
void add_field_options(CLI::App& app, FieldArguments& o) {
  setup::add_propagation_options(app, o.task.drive);
  setup::add_air_options(app, o.task.air);
  line::exclude(app, "--no-absorption", {"--air-pressure"});
  setup::add_spread_options(app, o.task.spread);
  setup::add_common(app, o.common);
}
constinit DeclaredOnce<SolveArguments> solve_options("Layout.solve", add_solve_options, outputs_of_commands);
constinit DeclaredOnce<SolveArguments> drive_options_of("Layout.drive", add_solve_options, outputs_of_commands);
constinit DeclaredOnce<SolveArguments> touch_drive_options("Layout.solve_touch", add_solve_options,
                                                           outputs_of_commands);
constinit DeclaredOnce<setup::FocusingOptions> finger_options("FingerSound", setup::add_propagation_options);
constinit DeclaredOnce<FieldArguments> field_options("Layout.field", add_field_options, outputs_of_commands);

// ---- drives ---------------------------------------------------------------------------------------------------------

std::vector<setup::AskedFocus> asked_foci(const LayoutObject& layout, const py::object& foci, const py::object& gains) {
  refuse_other_frame("foci", foci, layout);
  const std::vector<Vec3> places = points_of("foci", foci);
  std::vector<double> loud(places.size(), 1.0);
  if (!gains.is_none()) {
    loud = numbers_of("gains", gains);
    if (loud.size() == 1) loud.assign(places.size(), loud[0]);
    if (loud.size() != places.size())
      throw bad_usage(fmt::format("gains: there are {} for {}", loud.size(), counted(places.size(), "focus")));
  }
  std::vector<setup::AskedFocus> asked;
  asked.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    asked.push_back({places[i], static_cast<float>(loud[i])});
  return asked;
}

std::unique_ptr<FingerSoundObject> finger_sound(const std::shared_ptr<const LayoutObject>& layout,
                                                const py::object& mesh, const setup::FocusingOptions& drive,
                                                bool force) {
  const NamedMesh named = mesh_of("finger", mesh);
  auto made = std::make_unique<FingerSoundObject>();
  made->layout = layout;
  made->drive = drive;
  made->name = named.name;
  made->finger =
      cancellable([&] { return setup::finger_in_sound(named.name, named.mesh, layout->layout, drive, force); });
  return made;
}

/// Computes on a device, one call at a time, or on the processor. Ctrl-C ends it.
template <typename Work>
auto on_device(const setup::ComputeOptions& options, const Work& work) {
  check(options);
  return cancellable([&] {
    const gpu::Device* const device = setup::kept_device(options);
    std::unique_lock<std::mutex> turn(device_turn(), std::defer_lock);
    if (device) turn.lock();
    return work(device);
  });
}

std::shared_ptr<DriveObject> drive_on_finger(const LayoutPtr& self, std::span<const setup::AskedFocus> asked,
                                             const py::object& finger, const SolveArguments& o, bool force) {
  std::unique_ptr<FingerSoundObject> own;
  FingerSoundObject* sound = nullptr;
  if (py::isinstance<FingerSoundObject>(finger)) {
    if (force) throw bad_usage("force goes with a finger's mesh; this one was made before");
    sound = finger.cast<FingerSoundObject*>();
    if (sound->layout != self) throw bad_usage("the finger was made for another Layout object");
    if (!(sound->drive.medium == o.drive.medium) || sound->drive.directivity != o.drive.directivity)
      throw bad_usage("the finger was made for other air or another directivity: give it the same options");
  } else {
    own = finger_sound(self, finger, o.drive, force);
    sound = own.get();
  }
  if (!o.spread.text.empty())
    throw bad_usage("--spread computes in free air and --transfer finger on a finger: give one of them");
  return std::make_shared<DriveObject>(
      DriveObject{cancellable([&] { return setup::make_drive(self->layout, asked, o.drive, *sound->finger); }), self});
}

/// Nulls have a frame, as foci have.
std::vector<array::Null> asked_nulls(const LayoutObject& layout, const py::object& nulls, const py::object& radii) {
  if (!nulls.is_none()) refuse_other_frame("nulls", nulls, layout);
  return nulls_of(nulls, radii);
}

/// The options, except a solver that is a function.
SolveArguments solve_arguments(Declared<SolveArguments>& options, const py::kwargs& kwargs) {
  const py::kwargs rest = py::reinterpret_steal<py::kwargs>(PyDict_Copy(kwargs.ptr()));
  OwnFunctions own;
  take_solver(rest, own);
  SolveArguments made = options.read(rest);
  made.own_solver = own.solver;
  return made;
}

/// By the caller's solver, in free air.
std::shared_ptr<DriveObject> solve_by(const LayoutPtr& self, std::span<const setup::AskedFocus> asked,
                                      const SolveArguments& o) {
  if (asked.empty()) throw bad_usage("no focus is given");
  if (!o.drive.nulls.empty()) throw bad_usage("nulls go with solver=\"gs-pat\": a function makes its own drive");
  const array::DriveOptions options = setup::drive_options(o.drive, self->layout, setup::Solving::once);
  array::Schedule schedule = setup::schedule_of(asked, self->layout);
  auto made = std::make_shared<DriveObject>();
  made->layout = self;
  setup::DriveResult& result = made->result;
  array::foci_of_slot(schedule, 0, result.foci);
  result.layout = self->layout;
  result.medium = options.medium;
  result.drive = drive_by(o.own_solver, self->layout, result.foci, options);
  result.pressure =
      acoustics::pressure_at_foci(self->layout, result.drive, result.foci, options.medium, options.directivity);
  result.unresolved = array::unresolved_pairs(self->layout, result.foci, options);
  result.by = {.weighting = options.weighting};
  return made;
}

std::shared_ptr<DriveObject> solve(const LayoutPtr& self, const py::object& foci, const py::object& gains,
                                   const py::object& finger, bool force, const SolveArguments& o) {
  refuse_fork();
  const std::vector<setup::AskedFocus> asked = asked_foci(*self, foci, gains);
  if (o.own_solver && !finger.is_none()) throw bad_usage("a function as solver works in free air: leave finger out");
  if (o.own_solver) return solve_by(self, asked, o);
  setup::check(o.spread, o.drive.medium);
  const std::string asks = setup::asks_for_finger(o.drive);
  if (!asks.empty() && finger.is_none()) throw bad_usage(asks + ": finger is missing: give the finger's closed mesh");
  if (asks.empty() && !finger.is_none()) throw bad_usage("finger goes with transfer=\"finger\"");
  if (!finger.is_none()) return drive_on_finger(self, asked, finger, o, force);
  if (force) throw bad_usage("force goes with a finger");
  return on_device(o.common, [&](const gpu::Device* device) {
    auto made =
        std::make_shared<DriveObject>(DriveObject{setup::make_drive(self->layout, asked, o.drive, device), self});
    if (!o.spread.text.empty()) {
      made->result.spread =
          setup::spread_of_drive(made->result, o.drive.medium, o.drive.directivity, setup::parse_spread(o.spread.text),
                                 setup::draws_of(o.spread, o.common.seed));
    }
    return made;
  });
}

std::shared_ptr<DriveObject> drive_of_touch(const LayoutPtr& self, const py::object& touch,
                                            const std::optional<std::uint32_t>& slot, const py::object& nulls,
                                            const py::object& radii, const py::kwargs& kwargs) {
  refuse_fork();
  SolveArguments o = touch_drive_options().read(kwargs);
  o.drive.nulls = asked_nulls(*self, nulls, radii);
  check(o.common);
  setup::DriveTask task{.layout = self->source, .slot = slot, .drive = o.drive, .spread = o.spread};
  if (py::isinstance<TouchObject>(touch)) {
    task.touch = "touch";
    task.touch_json = to_json(touch.cast<const TouchObject&>().values);
  } else if (const std::optional<std::string> file = path_of(touch)) {
    if (file->starts_with('{')) throw bad_usage("touch: this text is no path: give the Touch, or a file with the text");
    task.touch = *file;
  } else {
    throw bad_usage("touch: give a Touch, or the path of a file that Touch.json() or palpa touch --json wrote");
  }
  task.placed = setup::PlacedLayout{self->layout, self->layout.default_T_world_layout};
  return std::make_shared<DriveObject>(DriveObject{on_device(o.common,
                                                             [&](const gpu::Device* device) {
                                                               setup::CommonOptions common = o.common;
                                                               common.device = device;
                                                               return setup::make_drive(task, common);
                                                             }),
                                                   self});
}

// ---- fields ---------------------------------------------------------------------------------------------------------

std::shared_ptr<FieldObject> field(const LayoutPtr& self, const py::object& drive, const py::object& where,
                                   const py::kwargs& kwargs) {
  refuse_fork();
  const FieldArguments o = field_options().read(kwargs);
  const array::Drive driven = drive_of_layout("drive", drive, *self);
  refuse_other_frame("where", where, *self);
  PlacesObject places = places_of("where", where);
  setup::check(o.task.spread, o.task.drive.medium);
  const acoustics::Air air = setup::air(o.task.drive.medium, o.task.air);
  std::optional<array::DrivenBy> by;
  if (py::isinstance<DriveObject>(drive)) by = drive.cast<const DriveObject&>().result.by;
  return on_device(o.common, [&](const gpu::Device* device) {
    auto made = owned(FieldObject{
        setup::sum_field(self->layout, driven, std::move(places.places), air, o.task.drive.directivity, device)});
    made->result.by = by;
    if (!o.task.spread.text.empty()) {
      made->result.spread = setup::spread_of_field(o.task, self->layout, driven, made->result.places.points,
                                                   setup::draws_of(o.task.spread, o.common.seed), device);
    }
    return made;
  });
}

/// A function that solves, and returns what `result` makes of the drive.
template <typename Class, typename Result>
void add_solver(Class& made, const char* name, DeclaredOnce<SolveArguments>& options, const char* doc,
                const Result& result) {
  made.def(
      name,
      [&options, result](const LayoutPtr& self, const py::object& foci, const py::object& gains,
                         const py::object& finger, bool force, const py::object& nulls, const py::object& radii,
                         const py::kwargs& kwargs) {
        SolveArguments o = solve_arguments(options(), kwargs);
        o.drive.nulls = asked_nulls(*self, nulls, radii);
        return result(solve(self, foci, gains, finger, force, o), self);
      },
      py::arg("foci"), py::arg("gains") = py::none(), py::kw_only(), py::arg("finger") = py::none(),
      py::arg("force") = false, py::arg("nulls") = py::none(), py::arg("null_radius") = py::none(),
      options().documented(doc).c_str());
}

void add_layout_functions(py::module_& m) {
  auto made = add_layout_class(m);
  add_solver(made, "solve", solve_options, solve_doc,
             [](const std::shared_ptr<DriveObject>& drive, const LayoutPtr&) { return drive; });
  add_solver(made, "drive", drive_options_of, drive_doc,
             [](const std::shared_ptr<DriveObject>& drive, const LayoutPtr& layout) {
               return of_layout(complex_of(drive->result.drive), layout);
             });
  const std::string touch_text = touch_drive_options().documented(solve_touch_doc);
  made.def("solve_touch", &drive_of_touch, py::arg("touch"), py::kw_only(), py::arg("slot") = py::none(),
           py::arg("nulls") = py::none(), py::arg("null_radius") = py::none(), touch_text.c_str());
  add_transfer(made);
  const std::string field_text = field_options().documented(field_doc);
  made.def("field", &field, py::arg("drive"), py::arg("where"), field_text.c_str());
}

void add_finger_sound(py::module_& m) {
  py::class_<FingerSoundObject>(m, "FingerSound",
                                R"(A rigid finger in the sound of a layout, for drives that focus on it.

Parameters
----------
layout : Layout
finger : Mesh, path or (vertices, faces)
    A closed mesh in the layout's own frame.
force : bool, optional
    Also take a mesh whose faces are too coarse for the wavelength.
**options
    The air, tone and directivity of Layout.solve.)")
      .def(py::init([](const LayoutPtr& layout, const py::object& finger, bool force, const py::kwargs& kwargs) {
             return finger_sound(layout, finger, finger_options().read(kwargs), force);
           }),
           py::arg("layout").none(false), py::arg("finger"), py::kw_only(), py::arg("force") = false)
      .def("__repr__", [](const FingerSoundObject& o) {
        return shown_text(fmt::format("<palpa.FingerSound {} in {}>", o.name, o.layout->layout.name));
      });
}

}  // namespace

void add_layout(py::module_& m) {
  add_sounds(m);
  add_layout_functions(m);
  add_finger_sound(m);
}

}  // namespace palpa::python
