#include "layout.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "array/free_field.hpp"
#include "array/resolution.hpp"
#include "array/schedule.hpp"
#include "arrays.hpp"
#include "base/error.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "layout_doc.hpp"
#include "module.hpp"
#include "options.hpp"
#include "own.hpp"
#include "places.hpp"
#include "running.hpp"
#include "setup/drive_file.hpp"
#include "setup/load.hpp"
#include "setup/options.hpp"
#include "setup/spread.hpp"
#include "setup/tasks/foci.hpp"
#include "shapes.hpp"

namespace palpa::python {

std::shared_ptr<const LayoutObject> layout_of(const char* name, const py::object& value) {
  if (py::isinstance<LayoutObject>(value)) return value.cast<std::shared_ptr<LayoutObject>>();
  const std::optional<std::string> text = path_of(value);
  if (!text) throw bad_usage(fmt::format("{}: give a palpa.Layout, the name of one, or the path of a TOML", name));
  auto made = std::make_shared<LayoutObject>();
  made->source = *text;
  made->layout = unlocked([&] { return array::load_layout(*text); });
  return made;
}

namespace {

/// level D(angle) exp(i k d) / max(d, radius), shape (n, M).
py::array transfer_matrix(const char* name, const array::Layout& layout, const std::vector<Vec3>& places,
                          const array::DriveOptions& options) {
  const std::size_t transducers = layout.transducers.size();
  constexpr std::size_t most_entries = std::size_t{1} << 28;
  if (places.size() * transducers > most_entries) {
    throw bad_usage(fmt::format("{}: {} points times {} transducers are more than {} entries; give fewer at a time",
                                name, places.size(), transducers, most_entries));
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!array::drivable({.position = places[i]}))
      throw bad_usage(fmt::format("{}: row {} is farther than 100 m from the array", name, i));
  }
  py::array_t<std::complex<double>> matrix(
      {static_cast<py::ssize_t>(places.size()), static_cast<py::ssize_t>(transducers)});
  std::complex<double>* const to = matrix.mutable_data();
  unlocked([&] {
    array::FreeField field;
    field.set(layout, options.medium, options.directivity);
    array::Columns columns;
    std::vector<array::FocusSource> sources;
    constexpr std::size_t block = 64;
    for (std::size_t begin = 0; begin < places.size(); begin += block) {
      const std::size_t count = std::min(block, places.size() - begin);
      sources.clear();
      for (std::size_t i = 0; i < count; ++i)
        sources.push_back({places[begin + i], 1, 1});
      field.fill(sources, array::Weighting::uniform, columns);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t t = 0; t < transducers; ++t)
          to[(begin + i) * transducers + t] = layout.source_level_pa_m * columns.transfer(t * count + i);
      }
    }
  });
  return sealed(std::move(matrix));
}

}  // namespace

array::Drive drive_by(const py::object& solver, const array::Layout& layout, std::span<const array::SlotFocus> foci,
                      const array::DriveOptions& options) {
  std::vector<Vec3> places;
  std::vector<double> gains;
  for (const array::SlotFocus& focus : foci) {
    places.push_back(focus.position);
    gains.push_back(double{focus.gain});
  }
  if (places.empty()) return array::Drive(layout.transducers.size(), {0, 0});
  const py::array matrix = transfer_matrix("foci", layout, places, options);
  return drive_of("solver", solver(matrix, copied(std::span<const double>(gains))), layout);
}

namespace {

using LayoutPtr = std::shared_ptr<LayoutObject>;

// ---- options --------------------------------------------------------------------------------------------------------

struct SolveArguments {
  py::object own_solver{};
  setup::DriveOptionsGroup drive;
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
  setup::add_drive_options(app, o.task.drive);
  setup::add_air_options(app, o.task.air);
  setup::add_spread_options(app, o.task.spread);
  setup::add_common(app, o.common);
}
/// A drive is given, so nothing is solved.
constexpr std::initializer_list<const char*> nothing_to_solve = {
    "--json", "--quiet", "--log-level", "--amplitude", "--solver", "--transfer", "--constraint", "--pressure"};

void add_transfer_options(CLI::App& app, setup::DriveOptionsGroup& o) {
  setup::add_drive_options(app, o);
}
constexpr std::initializer_list<const char*> only_the_air = {"--amplitude", "--solver", "--transfer", "--constraint",
                                                             "--pressure"};

Declared<SolveArguments>& solve_options() {
  static auto* const options = new Declared<SolveArguments>("Layout.solve", add_solve_options, outputs_of_commands);
  return *options;
}
Declared<SolveArguments>& drive_options_of() {
  static auto* const options = new Declared<SolveArguments>("Layout.drive", add_solve_options, outputs_of_commands);
  return *options;
}
Declared<SolveArguments>& touch_drive_options() {
  static auto* const options =
      new Declared<SolveArguments>("Layout.solve_touch", add_solve_options, outputs_of_commands);
  return *options;
}
Declared<setup::DriveOptionsGroup>& transfer_options() {
  static auto* const options =
      new Declared<setup::DriveOptionsGroup>("Layout.transfer", add_transfer_options, only_the_air);
  return *options;
}
Declared<setup::DriveOptionsGroup>& finger_options() {
  static auto* const options =
      new Declared<setup::DriveOptionsGroup>("FingerSound", add_transfer_options, only_the_air);
  return *options;
}
Declared<FieldArguments>& field_options() {
  static auto* const options = new Declared<FieldArguments>("Layout.field", add_field_options, nothing_to_solve);
  return *options;
}

// ---- drives ---------------------------------------------------------------------------------------------------------

std::vector<setup::AskedFocus> asked_foci(const py::object& foci, const py::object& gains) {
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
                                                const py::object& mesh, const setup::DriveOptionsGroup& drive,
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

/// Computes on a device, one call at a time, or on the processor.
template <typename Work>
auto on_device(const setup::ComputeOptions& options, const Work& work) {
  check(options);
  return unlocked([&] {
    const gpu::Device* const device = device_for(options);
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
      DriveObject{cancellable([&] { return setup::make_drive(self->layout, asked, o.drive, *sound->finger); })});
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
  const array::DriveOptions options = setup::drive_options(o.drive);
  array::Schedule schedule = setup::schedule_of(asked, self->layout);
  auto made = std::make_shared<DriveObject>();
  setup::DriveResult& result = made->result;
  array::foci_of_slot(schedule, 0, result.foci);
  result.layout = self->layout;
  result.medium = options.medium;
  result.drive = drive_by(o.own_solver, self->layout, result.foci, options);
  result.pressure =
      acoustics::pressure_at_foci(self->layout, result.drive, result.foci, options.medium, options.directivity);
  result.unresolved = array::unresolved_pairs(self->layout, result.foci, options);
  return made;
}

std::shared_ptr<DriveObject> solve(const LayoutPtr& self, const py::object& foci, const py::object& gains,
                                   const py::object& finger, bool force, const SolveArguments& o) {
  refuse_fork();
  const std::vector<setup::AskedFocus> asked = asked_foci(foci, gains);
  if (o.own_solver && !finger.is_none()) throw bad_usage("a function as solver works in free air: leave finger out");
  if (o.own_solver) return solve_by(self, asked, o);
  setup::check(o.spread, o.drive.medium);
  const std::string asks = setup::asks_for_finger(o.drive);
  if (!asks.empty() && finger.is_none()) throw bad_usage(asks + ": finger is missing: give the finger's closed mesh");
  if (asks.empty() && !finger.is_none()) throw bad_usage("finger goes with transfer=\"finger\"");
  if (!finger.is_none()) return drive_on_finger(self, asked, finger, o, force);
  if (force) throw bad_usage("force goes with a finger");
  return on_device(o.common, [&](const gpu::Device* device) {
    auto made = std::make_shared<DriveObject>(DriveObject{setup::make_drive(self->layout, asked, o.drive, device)});
    if (!o.spread.text.empty()) {
      made->result.spread = setup::spread_of_drive(self->layout, made->result.drive, made->result.foci, o.drive.medium,
                                                   o.drive.directivity, setup::parse_spread(o.spread.text),
                                                   setup::draws_of(o.spread, o.common.seed));
    }
    return made;
  });
}

std::shared_ptr<DriveObject> drive_of_touch(const LayoutPtr& self, const py::object& touch,
                                            const std::optional<std::uint32_t>& slot, const py::kwargs& kwargs) {
  refuse_fork();
  const SolveArguments o = touch_drive_options().read(kwargs);
  check(o.common);
  if (self->source.empty()) throw bad_usage("a Layout that was moved has no pose in a rig: load it by name or file");
  const std::optional<std::string> file = path_of(touch);
  if (!file) throw bad_usage("touch: give the path of a file that Touch.json() or palpa touch --json wrote");
  setup::DriveTask task{.layout = self->source, .touch = *file, .slot = slot, .drive = o.drive, .spread = o.spread};
  return std::make_shared<DriveObject>(DriveObject{unlocked([&] { return setup::make_drive(task, o.common); })});
}

// ---- transfer -------------------------------------------------------------------------------------------------------

py::array transfer(const LayoutPtr& self, const py::object& points, const py::kwargs& kwargs) {
  refuse_fork();
  const setup::DriveOptionsGroup o = transfer_options().read(kwargs);
  const array::DriveOptions options = setup::drive_options(o);
  const std::vector<Vec3> places = points_of("points", points);
  return transfer_matrix("points", self->layout, places, options);
}

// ---- fields ---------------------------------------------------------------------------------------------------------

std::shared_ptr<FieldObject> field(const LayoutPtr& self, const py::object& drive, const py::object& where,
                                   const py::kwargs& kwargs) {
  refuse_fork();
  const FieldArguments o = field_options().read(kwargs);
  const array::Drive driven = drive_of("drive", drive, self->layout);
  PlacesObject places = places_of("where", where);
  setup::check(o.task.spread, o.task.drive.medium);
  setup::refuse_idle_air(o.task.air);
  const acoustics::Air air = setup::air(o.task.drive.medium, o.task.air);
  return on_device(o.common, [&](const gpu::Device* device) {
    auto made = owned(FieldObject{
        setup::sum_field(self->layout, driven, std::move(places.places), air, o.task.drive.directivity, device)});
    if (!o.task.spread.text.empty()) {
      made->result.spread = setup::spread_of_field(o.task, self->layout, driven, made->result.places.points,
                                                   setup::draws_of(o.task.spread, o.common.seed), device);
    }
    return made;
  });
}

// ---- classes --------------------------------------------------------------------------------------------------------

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

py::class_<LayoutObject, LayoutPtr> add_layout_class(py::module_& m) {
  return py::class_<LayoutObject, LayoutPtr>(m, "Layout",
                                             R"(Positions and axes of the transducers of an array, in its own frame.

Parameters
----------
source : str or path
    "autd3", "paper", "openmpd", "openmpd-pair" or "sonicsurface", or a TOML file (docs/layouts.md).

Raises
------
BadInput
    There is no such layout, or the file is broken.)")
      .def(py::init([](const py::object& source) { return LayoutObject(*layout_of("Layout", source)); }),
           py::arg("source"))
      .def_static("names", &array::layout_names, "The names of the built-in layouts.\n\nReturns\n-------\nlist of str")
      .def_property_readonly(
          "source", [](const LayoutObject& o) { return shown_text(o.source); },
          "str: its name or file; empty for a moved layout.")
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
            return LayoutObject{array::transformed(o.layout, transform_of("pose", pose)), ""};
          },
          py::arg("pose"), R"(The same transducers in another frame.

Parameters
----------
pose : array_like, shape (4, 4)
    A rigid transform from the layout's own frame, such as `default_pose`.

Returns
-------
Layout)")
      .def(
          "read_drive",
          [](const LayoutObject& o, const py::object& file) {
            const std::string path = file_of("file", file);
            return complex_of(unlocked([&] { return setup::load_drive(path, o.layout); }));
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
            const array::Drive driven = drive_of("drive", drive, o.layout);
            unlocked([&] { write_file(path, setup::drive_csv(o.layout, driven)); });
          },
          py::arg("file"), py::arg("drive"),
          "Write a drive as CSV: index,x,y,z,nx,ny,nz,amplitude,phase of each transducer.\n\n"
          "Parameters\n----------\nfile : path\ndrive : Drive or array_like of complex, shape (M,)")
      .def("__repr__", [](const LayoutObject& o) {
        return fmt::format("<palpa.Layout {}: {}>", o.layout.name, counted(o.layout.transducers.size(), "transducer"));
      });
}

void add_layout_functions(py::module_& m) {
  auto made = add_layout_class(m);
  const std::string solve_text = solve_options().documented(solve_doc);
  made.def(
      "solve",
      [](const LayoutPtr& self, const py::object& foci, const py::object& gains, const py::object& finger, bool force,
         const py::kwargs& kwargs) {
        return solve(self, foci, gains, finger, force, solve_arguments(solve_options(), kwargs));
      },
      py::arg("foci"), py::arg("gains") = py::none(), py::kw_only(), py::arg("finger") = py::none(),
      py::arg("force") = false, solve_text.c_str());
  const std::string drive_text = drive_options_of().documented(drive_doc);
  made.def(
      "drive",
      [](const LayoutPtr& self, const py::object& foci, const py::object& gains, const py::object& finger, bool force,
         const py::kwargs& kwargs) {
        return complex_of(
            solve(self, foci, gains, finger, force, solve_arguments(drive_options_of(), kwargs))->result.drive);
      },
      py::arg("foci"), py::arg("gains") = py::none(), py::kw_only(), py::arg("finger") = py::none(),
      py::arg("force") = false, drive_text.c_str());
  const std::string touch_text = touch_drive_options().documented(solve_touch_doc);
  made.def("solve_touch", &drive_of_touch, py::arg("touch"), py::kw_only(), py::arg("slot") = py::none(),
           touch_text.c_str());
  const std::string transfer_text = transfer_options().documented(transfer_doc);
  made.def("transfer", &transfer, py::arg("points"), transfer_text.c_str());
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
