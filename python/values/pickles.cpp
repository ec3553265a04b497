// Pickles of results: multiprocessing and Dask send them from process to process. They are for the same version of
// palpa.
#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <map>
#include <string>
#include <type_traits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "bodies.hpp"
#include "exported.hpp"
#include "layout.hpp"
#include "module.hpp"
#include "session_object.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"
#include "values/archive.hpp"
#include "values/cameras.hpp"
#include "values/places.hpp"

/// What an archive reads and writes of a TYPE: all its members. It does not compile with a member more or less.
#define PALPA_FIELDS(TYPE, ...)                     \
  static void fields(python::Archive& a, TYPE& o) { \
    auto& [__VA_ARGS__] = o;                        \
    a(__VA_ARGS__);                                 \
  }

// Found by the namespaces of their arguments.
namespace palpa::touch {
PALPA_FIELDS(Focus, position, points, held)
PALPA_FIELDS(Finger, id, solid, count, contacts, section, foci, placed, point_like, depth, holds, inward)
PALPA_FIELDS(Touch, contacts, deep, fingers, finger_count, cluster_count, dropped)
PALPA_FIELDS(Placement, foci, complete, together)
}  // namespace palpa::touch

namespace palpa::array {
PALPA_FIELDS(SlotFocus, position, gain, pressure, voice, number, most)
PALPA_FIELDS(Course, from, to, first, slots, texture, begin, end, gains)
PALPA_FIELDS(Voice, id, solid, foci, velocity, order, per_slot, dwell, hz, modulation, gain, course, pressure, target,
             reached)
static void fields(python::Archive& a, Schedule& o) {
  auto& [slot, voices, count, time, advance, once, names] = o;  // a TouchObject has the names itself
  a(slot, voices, count, time, advance, once);
}
PALPA_FIELDS(Board, type, first, count, width, height, pose)
PALPA_FIELDS(Layout, name, transducers, boards, factors, level, frequency, law, radius, pose)
PALPA_FIELDS(DrivenBy, weighting, solver, solved, constraint)
}  // namespace palpa::array

namespace palpa::acoustics {
PALPA_FIELDS(EarLevel, low, high)
PALPA_FIELDS(Tuned, ring, before, after, changed, field)
PALPA_FIELDS(SolveReport, iterations, residual)
PALPA_FIELDS(RigidBody::Effort, iterates, worst)
PALPA_FIELDS(Spectrum, skin, period, lines, variance, field)
PALPA_FIELDS(FociPressure, pascals, mean, evenness)
PALPA_FIELDS(SkinPressure, langevin, squared, loudest, langevin_load, squared_load, push)
}  // namespace palpa::acoustics

namespace palpa::geometry {
PALPA_FIELDS(Mesh, positions, triangles)
}  // namespace palpa::geometry

namespace palpa::session {
PALPA_FIELDS(Event, kind, time, solid, finger, depth, centroid)
PALPA_FIELDS(UntouchedStats, solid, distance, inside, why)
PALPA_FIELDS(ReplayStats, frames, touching, untouched, drives, silent_drives, dropped, slot, duration, fingers, solids,
             driven)
PALPA_FIELDS(ScheduledFinger, placement, perimeter, tuned)
}  // namespace palpa::session

namespace palpa::setup {
PALPA_FIELDS(Draws, count, seed)
PALPA_FIELDS(Grid, plane, centre, size, columns, rows)
PALPA_FIELDS(SimulateSpread, draws, langevin, squared, force, torque)
PALPA_FIELDS(UsedBackend, backend, why)
PALPA_FIELDS(TouchValues, touch, schedule, common, fingers, solids, own, points, spectra, pressures, ear, driven,
             computed, total, times)
PALPA_FIELDS(DriveSpread, draws, pressures, evenness, nulls)
PALPA_FIELDS(NullReport, places, kept, quiet, loud)
PALPA_FIELDS(DriveResult, layout, medium, foci, aimed, drive, pressure, effort, over, unresolved, asked, by, nulls,
             spread)
PALPA_FIELDS(Places, points, grid, line, triangles)
PALPA_FIELDS(FieldSpread, draws, peak, peak_at, amplitudes)
PALPA_FIELDS(FieldResult, places, pressures, loudest, air, layout, foci, by, spread, sum, total)
PALPA_FIELDS(ScatterResult, body, faces, points, totals, load, effort, far, loudest, air, from_array, times)
PALPA_FIELDS(SimulateResult, method, penetration, top, body, tip, foci, aimed, pressure, langevin, squared, load,
             effort, far, bare, spread, by, fingers, touched, spectra, unreached, times)
PALPA_FIELDS(ExportResult, stats, stopped)
PALPA_FIELDS(Figure6Touch, object, result)
}  // namespace palpa::setup

namespace palpa::python {

static void fields(Archive& a, MeshObject& o) {
  a(o.mesh, o.source);
}
static void fields(Archive& a, CameraObject& o) {
  sensing::Camera& c = o.camera;  // those that palpa.Camera sets
  a(c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.distortion, c.depth_unit_m, c.min_range_m, c.T_world_camera);
}
static void fields(Archive& a, LayoutObject& o) {
  auto& [layout, source, unmoved, known] = o;  // a name of its own is made again
  a(layout, source, unmoved);
}
static void fields(Archive& a, DriveObject& o) {
  a(o.result, o.layout);
}
static void fields(Archive& a, FieldObject& o) {
  a(o.result);
}
static void fields(Archive& a, PlacesObject& o) {
  a(o.places);
}
PALPA_FIELDS(TouchObject, values, time, unreached)
static void fields(Archive& a, FingerObject& o) {
  a(o.whole, o.index);
}
static void fields(Archive& a, ContactsObject& o) {
  a(o.whole);
}
static void fields(Archive& a, EventObject& o) {
  a(o.event, o.solid);
}
static void fields(Archive& a, ScatterObject& o) {
  a(o.result);
}
static void fields(Archive& a, SimulateObject& o) {
  a(o.result);
}
static void fields(Archive& a, Figure6Object& o) {
  a(o.touches);
}
static void fields(Archive& a, ExportObject& o) {
  a(o.result, o.rows);
}

namespace {

/// Makes an object of a class from its bytes.
std::map<std::string, std::function<py::object(Archive&)>>& makers() {
  static auto* const all = new std::map<std::string, std::function<py::object(Archive&)>>();
  return *all;
}

/// Python always has binascii.
py::object checksum_of(const py::bytes& bytes) {
  return py::module_::import("binascii").attr("crc32")(bytes);
}

/// What restore() is given.
py::tuple of_bytes(const std::string& name, const py::bytes& bytes, const py::object& frame) {
  return py::make_tuple(name, bytes, checksum_of(bytes), frame);
}

template <typename Object>
void add_pickle(const py::module_& m, const char* name) {
  makers()[name] = [](Archive& archive) {
    Object made;
    archive(made);
    return py::cast(std::move(made));
  };
  const py::object cls = m.attr(name);
  cls.attr("__reduce__") = py::cpp_function(
      [name = std::string(name)](const Object& o) {
        Archive archive;
        std::string version = PALPA_VERSION;
        archive(version);
        archive(const_cast<Object&>(o));  // writing changes nothing
        py::object frame = py::none();
        if constexpr (std::is_same_v<Object, PlacesObject>) {
          if (o.frame) frame = o.frame;
        }
        return py::make_tuple(py::module_::import("palpa._pickle").attr("restore"),
                              of_bytes(name, py::bytes(archive.take()), frame));
      },
      py::name("__reduce__"), py::is_method(cls));
}

/// `frame`: that of a Places; None if it has none. Bytes that were changed may be indices beyond their arrays.
py::object restore(const std::string& name, const py::bytes& bytes, const py::object& checksum,
                   const py::object& frame) {
  const auto maker = makers().find(name);
  if (maker == makers().end()) throw bad_usage(fmt::format("palpa has no class {}", printable(name, 60)));
  if (!checksum_of(bytes).equal(checksum)) throw bad_usage("the pickle is damaged: its checksum does not fit");
  const std::string data = bytes;
  Archive archive(data);
  std::string version;
  archive(version);
  if (version != PALPA_VERSION) {
    throw bad_usage(
        fmt::format("the pickle is of palpa {}, but this is palpa {}", printable(version, 20), PALPA_VERSION));
  }
  py::object made = maker->second(archive);
  if (!archive.at_end()) throw bad_usage("the pickle is too long");
  if (!frame.is_none()) made.cast<PlacesObject&>().frame = frame;
  return made;
}

}  // namespace

void add_pickles(py::module_& m) {
  m.def("_restore", &restore, py::arg("name"), py::arg("bytes"), py::arg("checksum"), py::arg("frame") = py::none());
  add_pickle<MeshObject>(m, "Mesh");
  add_pickle<LayoutObject>(m, "Layout");
  add_pickle<CameraObject>(m, "Camera");
  add_pickle<PlacesObject>(m, "Places");
  add_pickle<TouchObject>(m, "Touch");
  add_pickle<FingerObject>(m, "Finger");
  add_pickle<ContactsObject>(m, "Contacts");
  add_pickle<EventObject>(m, "Event");
  add_pickle<DriveObject>(m, "Drive");
  add_pickle<FieldObject>(m, "Field");
  add_pickle<ScatterObject>(m, "Scattering");
  add_pickle<SimulateObject>(m, "Simulation");
  add_pickle<Figure6Object>(m, "Figure6");
  add_pickle<ExportObject>(m, "Export");
}

}  // namespace palpa::python
