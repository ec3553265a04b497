#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/nulls/nulls.hpp"
#include "base/files/outputs.hpp"
#include "base/text.hpp"
#include "layout.hpp"
#include "line/values.hpp"
#include "running.hpp"
#include "setup/files/drive_file.hpp"
#include "setup/options/options.hpp"
#include "setup/options/spread.hpp"
#include "setup/tasks/export_played.hpp"
#include "shapes.hpp"
#include "tasks_doc.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"

namespace palpa::python {
namespace {

py::object spread_of(const DriveObject& o) {
  if (!o.result.spread) return py::none();
  py::dict made;
  made["draws"] = o.result.spread->draws.count;
  made["seed"] = o.result.spread->draws.seed;
  py::list pressures;
  for (const setup::Percentiles& p : o.result.spread->pressures_pa)
    pressures.append(range_of(p));
  made["pressures"] = pressures;
  made["evenness"] = range_of(o.result.spread->evenness);
  if (!o.result.spread->nulls_pa.empty()) {
    py::list nulls;
    for (const setup::Percentiles& p : o.result.spread->nulls_pa)
      nulls.append(range_of(p));
    made["nulls"] = nulls;
  }
  return made;
}

py::object spread_of(const FieldObject& o) {
  if (!o.result.spread) return py::none();
  const setup::FieldSpread& spread = *o.result.spread;
  py::dict made;
  made["draws"] = spread.draws.count;
  made["seed"] = spread.draws.seed;
  made["peak"] = range_of(spread.peak_pa);
  made["peak_at"] = range_of(spread.peak_m);
  py::array_t<double> amplitudes({static_cast<py::ssize_t>(spread.amplitudes.size()), py::ssize_t{3}});
  double* to = amplitudes.mutable_data();
  for (const setup::Percentiles& p : spread.amplitudes) {
    *to++ = p.p05;
    *to++ = p.p50;
    *to++ = p.p95;
  }
  made["amplitudes"] = sealed(std::move(amplitudes));
  return made;
}

void add_drive_class(py::module_& m) {
  const auto vector = [](const DriveObject& o) { return of_layout(complex_of(o.result.drive), o.layout); };
  py::class_<DriveObject, std::shared_ptr<DriveObject>>(
      m, "Drive", "A drive and the sound at its foci. numpy.asarray(drive) is its complex vector.")
      .def_property_readonly("vector", vector,
                             "ndarray of complex128, shape (M,): amplitude times exp(i phase) of each transducer, in "
                             "layout order; the time factor is exp(-i w t), amplitudes are 0 to 1.")
      .def("__array__",
           [vector](const DriveObject& o, const py::args& args, const py::kwargs&) -> py::object {
             const py::object made = vector(o);
             return args.empty() || args[0].is_none() ? made : made.attr("astype")(args[0]);
           })
      .def_property_readonly(
          "layout", [](const DriveObject& o) { return o.layout; }, "Layout: the array that it is for.")
      .def("__len__", [](const DriveObject& o) { return o.result.drive.size(); })
      .def_property_readonly(
          "foci",
          [](const DriveObject& o) {
            std::vector<Vec3> foci;
            for (const array::SlotFocus& focus : o.result.foci)
              foci.push_back(focus.position);
            return of_layout(copied(foci), o.layout);
          },
          "ndarray of float64, shape (n, 3): metres, in the layout's own frame.")
      .def_property_readonly(
          "gains",
          [](const DriveObject& o) {
            std::vector<double> gains;
            for (const array::SlotFocus& focus : o.result.foci)
              gains.push_back(double{focus.gain});
            return copied(std::span<const double>(gains));
          },
          "ndarray of float64, shape (n,): the loudness asked for, above 0 to 1.")
      .def_property_readonly(
          "pressures", [](const DriveObject& o) { return copied(std::span<const double>(o.result.pressure.pascals)); },
          "ndarray of float64, shape (n,): peak pressure at each focus, pascals, without absorption.")
      .def_property_readonly(
          "evenness", [](const DriveObject& o) { return o.result.pressure.evenness; },
          "float: weakest to strongest focus, relative to what was asked.")
      .def_property_readonly(
          "unresolved",
          [](const DriveObject& o) {
            std::vector<std::pair<std::size_t, std::size_t>> pairs;
            for (const array::FocusPair& pair : o.result.unresolved)
              pairs.emplace_back(pair.first, pair.second);
            return pairs;
          },
          "list of (int, int): foci that are closer together than the array resolves.")
      .def_property_readonly(
          "nulls",
          [](const DriveObject& o) -> py::object {
            if (!o.result.nulls) return py::none();
            std::vector<Vec3> places;
            for (const setup::SilentPlace& place : o.result.nulls->places)
              places.push_back(place.null.position);
            return of_layout(copied(places), o.layout);
          },
          "ndarray of float64, shape (n, 3), or None: metres, in the layout's own frame.")
      .def_property_readonly(
          "null_depths",
          [](const DriveObject& o) -> py::object {
            if (!o.result.nulls) return py::none();
            std::vector<double> depths;
            for (const setup::SilentPlace& place : o.result.nulls->places)
              depths.push_back(place.depth_db);
            return copied(std::span<const double>(depths));
          },
          "ndarray of float64, shape (n,), or None: decibels, the loudest sound within each null relative to the "
          "weakest focus.")
      .def_property_readonly(
          "aimed",
          [](const DriveObject& o) -> py::object {
            if (o.result.aimed.empty()) return py::none();
            return of_layout(copied(o.result.aimed), o.layout);
          },
          "ndarray of float64, shape (n, 3), or None: with a finger, where each focus sounds, on the skin.")
      .def_property_readonly(
          "over_free_field",
          [](const DriveObject& o) -> py::object {
            if (o.result.over_free_field.empty()) return py::none();
            return copied(std::span<const double>(o.result.over_free_field));
          },
          "ndarray of float64, shape (n,), or None: with a finger, the pressure divided by that of the drive for free "
          "air.")
      .def_property_readonly(
          "beyond_linear", [](const DriveObject& o) { return o.result.beyond_linear(); },
          "bool: whether a focus has more pressure than linear acoustics holds for.")
      .def_property_readonly(
          "spread", [](const DriveObject& o) { return spread_of(o); },
          "dict or None: percentiles (5, 50, 95) of random arrays, if spread was given.")
      .def(
          "json", [](const DriveObject& o) { return unlocked([&] { return to_json(o.result); }); },
          "str: what `palpa drive --json` writes.")
      .def(
          "csv",
          [](const DriveObject& o) {
            return unlocked([&] { return setup::drive_csv(o.result.layout, o.result.drive); });
          },
          "str: what `palpa drive --csv` writes: index,x,y,z,nx,ny,nz,amplitude,phase of each transducer.")
      .def("__repr__", [](const DriveObject& o) {
        return fmt::format("<palpa.Drive of {}: {}, {}>", o.result.layout.name,
                           counted(o.result.drive.size(), "transducer"), counted(o.result.foci.size(), "focus"));
      });
}

py::array field_array(const py::object& self) {
  const auto& o = self.cast<FieldObject&>();
  const setup::Places& places = o.result.places;
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(o.result.pressures.size())};
  if (places.grid) shape = {places.grid->rows, places.grid->columns};
  return shown(o.result.pressures.data(), shape, self);
}

void add_field_class(py::module_& m) {
  py::class_<FieldObject, std::shared_ptr<FieldObject>>(
      m, "Field", "The sound of a drive at places. numpy.asarray(field) is its pressure.")
      .def_property_readonly("pressure", &field_array,
                             "ndarray of complex128, shape (rows, columns) of a plane, otherwise (n,): pascals, peak; "
                             "the time factor is exp(-i w t). Read-only, not copied.")
      .def("__array__",
           [](const py::object& self, const py::args& args, const py::kwargs&) -> py::object {
             const py::object made = field_array(self);
             return args.empty() || args[0].is_none() ? made : made.attr("astype")(args[0]);
           })
      .def_property_readonly(
          "points", [](const py::object& self) { return shown(self.cast<FieldObject&>().result.places.points, self); },
          "ndarray of float64, shape (n, 3): metres; of a plane row by row from the top; read-only, not copied.")
      .def_property_readonly(
          "faces",
          [](const py::object& self) { return shown(self.cast<FieldObject&>().result.places.triangles, self); },
          "ndarray of uint32, shape (m, 3): of a surface; otherwise empty.")
      .def_property_readonly(
          "peak", [](const FieldObject& o) { return o.result.peak_pa(); }, "float: the largest pressure, pascals.")
      .def_property_readonly(
          "peak_at", [](const FieldObject& o) { return copied(o.result.places.points[o.result.loudest]); },
          "ndarray of float64, shape (3,): the first point with the largest pressure, metres.")
      .def_property_readonly(
          "sound_speed", [](const FieldObject& o) { return o.result.air.medium.sound_speed; }, "float: m/s.")
      .def_property_readonly(
          "density", [](const FieldObject& o) { return o.result.air.density_kg_m3; }, "float: kg/m^3.")
      .def_property_readonly(
          "absorption", [](const FieldObject& o) { return o.result.air.absorption_np_m; }, "float: nepers per metre.")
      .def_property_readonly(
          "beyond_linear", [](const FieldObject& o) { return o.result.beyond_linear(); },
          "bool: whether a point has more pressure than linear acoustics holds for.")
      .def_property_readonly(
          "spread", [](const FieldObject& o) { return spread_of(o); },
          "dict or None: percentiles (5, 50, 95) of random arrays, if spread was given.")
      .def(
          "json", [](const FieldObject& o) { return unlocked([&] { return to_json(o.result); }); },
          "str: what `palpa field --json` writes. Only `timing_ms` differs between runs.")
      .def("__repr__", [](const FieldObject& o) {
        return fmt::format("<palpa.Field of {}: {}, at most {:.0f} Pa>", o.result.layout,
                           counted(o.result.pressures.size(), "point"), o.result.peak_pa());
      });
}

struct PlayedArguments {
  setup::ExportTask task;
};
void add_played_options(CLI::App& app, PlayedArguments& o) {
  const line::Group group(app, "What to export");
  setup::add_hold(group, o.task.hold_s, o.task.hold_auto);
  setup::add_safety(group, o.task.safety);
  setup::add_rig_options(app, o.task.rig);
  setup::add_drive_options(app, o.task.drive);
}

constexpr std::initializer_list<const char*> not_played = {"--pressure"};
constinit DeclaredOnce<PlayedArguments> played_options("export_played", add_played_options, not_played);

std::string export_played(const py::object& played, const py::object& drives, const py::kwargs& kwargs) {
  refuse_fork();
  PlayedArguments o = played_options().read(kwargs);
  o.task.played = file_of("played", played);
  o.task.drives = file_of("drives", drives);
  std::string json;
  std::atomic<bool> stop{false};
  run_beside(stop, [&] {
    const Outputs outputs({{"--drives", o.task.drives}});
    json = to_json(setup::export_played(o.task, stop));
  });
  return json;
}

}  // namespace

void add_sounds(py::module_& m) {
  add_drive_class(m);
  add_field_class(m);
  const std::string doc = played_options().documented(export_played_doc);
  m.def("export_played", &export_played, py::arg("played"), py::arg("drives"), doc.c_str());
}

}  // namespace palpa::python
