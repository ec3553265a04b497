// Pickles of results: multiprocessing and Dask send them from process to process. They are for the same version of
// palpa.
#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <map>
#include <string>
#include <type_traits>

#include "archive.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "bodies.hpp"
#include "cameras.hpp"
#include "exported.hpp"
#include "layout.hpp"
#include "module.hpp"
#include "places.hpp"
#include "session_object.hpp"
#include "shapes.hpp"
#include "touch_object.hpp"

// Found by the namespaces of their arguments.
namespace palpa::touch {
static void fields(python::Archive& a, Focus& o) {
  auto& [position, points, held] = o;
  a(position, points, held);
}
static void fields(python::Archive& a, Finger& o) {
  auto& [id, solid, count, contacts, section, foci, placed, point_like, depth, holds, inward] = o;
  a(id, solid, count, contacts, section, foci, placed, point_like, depth, holds, inward);
}
static void fields(python::Archive& a, Touch& o) {
  auto& [contacts, deep, fingers, finger_count, cluster_count, dropped] = o;
  a(contacts, deep, fingers, finger_count, cluster_count, dropped);
}
static void fields(python::Archive& a, Placement& o) {
  auto& [foci, complete, together] = o;
  a(foci, complete, together);
}
}  // namespace palpa::touch

namespace palpa::array {
static void fields(python::Archive& a, SlotFocus& o) {
  auto& [position, gain, pressure, voice, number, most] = o;
  a(position, gain, pressure, voice, number, most);
}
static void fields(python::Archive& a, Course& o) {
  auto& [from, to, first, slots, texture, begin, end, gains] = o;
  a(from, to, first, slots, texture, begin, end, gains);
}
static void fields(python::Archive& a, Voice& o) {
  auto& [id, solid, foci, velocity, order, per_slot, dwell, hz, modulation, gain, course, pressure, target, reached] =
      o;
  a(id, solid, foci, velocity, order, per_slot, dwell, hz, modulation, gain, course, pressure, target, reached);
}
static void fields(python::Archive& a, Schedule& o) {
  auto& [slot, voices, count, time, advance, names] = o;  // a TouchObject has the names itself
  a(slot, voices, count, time, advance);
}
static void fields(python::Archive& a, Board& o) {
  auto& [type, first, count, width, height, pose] = o;
  a(type, first, count, width, height, pose);
}
static void fields(python::Archive& a, Layout& o) {
  auto& [name, transducers, boards, level, frequency, radius, pose] = o;
  a(name, transducers, boards, level, frequency, radius, pose);
}
}  // namespace palpa::array

namespace palpa::acoustics {
static void fields(python::Archive& a, Tuned& o) {
  auto& [ring, before, after, changed, field] = o;
  a(ring, before, after, changed, field);
}
static void fields(python::Archive& a, SolveReport& o) {
  auto& [iterations, residual] = o;
  a(iterations, residual);
}
static void fields(python::Archive& a, RigidBody::Effort& o) {
  auto& [iterates, worst] = o;
  a(iterates, worst);
}
static void fields(python::Archive& a, Spectrum& o) {
  auto& [skin, period, lines, variance, field] = o;
  a(skin, period, lines, variance, field);
}
static void fields(python::Archive& a, FociPressure& o) {
  auto& [pascals, mean, evenness] = o;
  a(pascals, mean, evenness);
}
static void fields(python::Archive& a, SkinPressure& o) {
  auto& [langevin, squared, loudest, langevin_load, squared_load, push] = o;
  a(langevin, squared, loudest, langevin_load, squared_load, push);
}
}  // namespace palpa::acoustics

namespace palpa::geometry {
static void fields(python::Archive& a, Mesh& o) {
  auto& [positions, triangles] = o;
  a(positions, triangles);
}
}  // namespace palpa::geometry

namespace palpa::session {
static void fields(python::Archive& a, Event& o) {
  auto& [kind, time, solid, finger, depth, centroid] = o;
  a(kind, time, solid, finger, depth, centroid);
}
static void fields(python::Archive& a, ReplayStats& o) {
  auto& [frames, touching, drives, silent_drives, dropped, slot, duration, fingers, solids] = o;
  a(frames, touching, drives, silent_drives, dropped, slot, duration, fingers, solids);
}
static void fields(python::Archive& a, ScheduledFinger& o) {
  auto& [placement, perimeter, tuned] = o;
  a(placement, perimeter, tuned);
}
}  // namespace palpa::session

namespace palpa::setup {
static void fields(python::Archive& a, Draws& o) {
  auto& [count, seed] = o;
  a(count, seed);
}
static void fields(python::Archive& a, Grid& o) {
  auto& [plane, centre, size, columns, rows] = o;
  a(plane, centre, size, columns, rows);
}
static void fields(python::Archive& a, SimulateSpread& o) {
  auto& [draws, langevin, squared, force, torque] = o;
  a(draws, langevin, squared, force, torque);
}
static void fields(python::Archive& a, UsedBackend& o) {
  auto& [backend, why] = o;
  a(backend, why);
}
static void fields(python::Archive& a, TouchValues& o) {
  auto& [touch, schedule, common, fingers, solids, own, points, spectra, pressures, computed, total, times] = o;
  a(touch, schedule, common, fingers, solids, own, points, spectra, pressures, computed, total, times);
}
static void fields(python::Archive& a, DriveSpread& o) {
  auto& [draws, pressures, evenness, nulls] = o;
  a(draws, pressures, evenness, nulls);
}
static void fields(python::Archive& a, NullReport& o) {
  auto& [places, kept] = o;
  a(places, kept);
}
static void fields(python::Archive& a, DriveResult& o) {
  auto& [layout, medium, foci, aimed, drive, pressure, effort, over, unresolved, asked, nulls, spread] = o;
  a(layout, medium, foci, aimed, drive, pressure, effort, over, unresolved, asked, nulls, spread);
}
static void fields(python::Archive& a, Places& o) {
  auto& [points, grid, line, triangles] = o;
  a(points, grid, line, triangles);
}
static void fields(python::Archive& a, FieldSpread& o) {
  auto& [draws, peak, peak_at, amplitudes] = o;
  a(draws, peak, peak_at, amplitudes);
}
static void fields(python::Archive& a, FieldResult& o) {
  auto& [places, pressures, loudest, air, layout, foci, spread, sum, total] = o;
  a(places, pressures, loudest, air, layout, foci, spread, sum, total);
}
static void fields(python::Archive& a, ScatterResult& o) {
  auto& [body, faces, points, totals, load, effort, far, loudest, air, from_array, times] = o;
  a(body, faces, points, totals, load, effort, far, loudest, air, from_array, times);
}
static void fields(python::Archive& a, SimulateResult& o) {
  auto& [method, penetration, top, body, tip, foci, aimed, pressure, langevin, squared, load, effort, far, bare, spread,
         fingers, touched, spectra, unreached, times] = o;
  a(method, penetration, top, body, tip, foci, aimed, pressure, langevin, squared, load, effort, far, bare, spread,
    fingers, touched, spectra, unreached, times);
}
static void fields(python::Archive& a, ExportResult& o) {
  auto& [stats, stopped] = o;
  a(stats, stopped);
}
static void fields(python::Archive& a, Figure6Touch& o) {
  auto& [object, result] = o;
  a(object, result);
}
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
static void fields(Archive& a, TouchObject& o) {
  auto& [values, time, unreached] = o;
  a(values, time, unreached);
}
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
