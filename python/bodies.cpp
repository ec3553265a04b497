#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <complex>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "bodies.hpp"
#include "bodies_doc.hpp"
#include "layout.hpp"
#include "module.hpp"
#include "running.hpp"
#include "setup/options/options.hpp"
#include "setup/tasks/figure6.hpp"
#include "setup/tasks/scatter.hpp"
#include "setup/tasks/simulate.hpp"
#include "shapes.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"
#include "values/places.hpp"

namespace palpa::python {
namespace {

py::object vector_or_none(const std::optional<Vec3>& vector) {
  if (!vector) return py::none();
  return copied(*vector);
}

// ---- scatter --------------------------------------------------------------------------------------------------------

struct ScatterArguments {
  setup::FocusingOptions drive;
  setup::AirOptions air{.absorption = false};
};
void add_scatter_options(CLI::App& app, ScatterArguments& o) {
  setup::add_propagation_options(app, o.drive);
  setup::add_air_options(app, o.air);
}

constinit DeclaredOnce<ScatterArguments> scatter_options("scatter", add_scatter_options);

setup::IncidentSound sound_of(const py::object& plane_wave, const py::object& point_source, const py::object& layout,
                              const py::object& drive, array::Directivity directivity, bool directivity_given) {
  const int waves = int{!plane_wave.is_none()} + int{!point_source.is_none()} + int{!drive.is_none()};
  if (waves != 1) {
    throw bad_usage(waves == 0 ? "nothing sounds: give plane_wave, point_source, or layout and drive"
                               : "plane_wave, point_source and drive exclude each other: give one of them");
  }
  if (drive.is_none() != layout.is_none()) throw bad_usage("layout and drive go together: give both");
  if (!drive.is_none()) {
    const std::shared_ptr<LayoutObject> array = layout_of("layout", layout);
    return setup::ArraySound{array->layout, drive_of_layout("drive", drive, *array), directivity};
  }
  if (directivity_given) throw bad_usage("directivity goes with drive: it belongs to an array's transducers");
  if (!plane_wave.is_none()) return setup::PlaneWave{point_of("plane_wave", plane_wave)};
  return setup::PointSource{point_of("point_source", point_source)};
}

std::shared_ptr<ScatterObject> scatter(const py::object& mesh, const py::object& plane_wave,
                                       const py::object& point_source, const py::object& layout,
                                       const py::object& drive, const py::object& where, bool force,
                                       const py::kwargs& kwargs) {
  refuse_fork();
  const ScatterArguments o = scatter_options().read(kwargs);
  const setup::IncidentSound sound = sound_of(plane_wave, point_source, layout, drive, o.drive.directivity,
                                              kwargs.contains("directivity") && !kwargs["directivity"].is_none());
  const NamedMesh body = mesh_of("mesh", mesh);
  std::vector<Vec3> points;
  if (!where.is_none()) points = places_of("where", where).places.points;
  if (!layout.is_none()) refuse_other_frame("where", where, *layout_of("layout", layout));
  const acoustics::Air air = setup::air(o.drive.medium, o.air);
  return owned(cancellable(
      [&] { return ScatterObject{setup::scatter(body.name, body.mesh, sound, air, std::move(points), force)}; }));
}

py::array face_places(const geometry::Mesh& mesh) {
  std::vector<Vec3> centroids;
  centroids.reserve(mesh.triangles.size());
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
    centroids.push_back(acoustics::face_centroid(mesh, face));
  return copied(centroids);
}

py::array face_areas(const geometry::Mesh& mesh) {
  std::vector<double> areas;
  areas.reserve(mesh.triangles.size());
  for (std::size_t face = 0; face < mesh.triangles.size(); ++face)
    areas.push_back(acoustics::face_area(mesh, face));
  return copied(std::span<const double>(areas));
}

/// A finger that was simulated is in the world. A body that scatters may be anywhere.
py::array of_body(const py::object& self, const py::array& points) {
  return py::isinstance<SimulateObject>(self) ? in_world(points) : points;
}

/// Members that a ScatterObject and a SimulateObject have in common: their results have the same names.
template <typename Object>
void add_body(py::class_<Object, std::shared_ptr<Object>>& made) {
  made.def_property_readonly(
          "vertices",
          [](const py::object& self) { return of_body(self, shown(self.cast<Object&>().result.body.positions, self)); },
          "ndarray of float64, shape (n, 3): of the body, welded, metres; read-only, not copied.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return shown(self.cast<Object&>().result.body.triangles, self); },
          "ndarray of uint32, shape (m, 3): in the order given; read-only, not copied.")
      .def_property_readonly(
          "centroids",
          [](const py::object& self) { return of_body(self, face_places(self.cast<Object&>().result.body)); },
          "ndarray of float64, shape (m, 3): of the faces, metres.")
      .def_property_readonly(
          "areas", [](const Object& o) { return face_areas(o.result.body); },
          "ndarray of float64, shape (m,): of the faces, square metres.")
      .def_property_readonly(
          "force", [](const Object& o) { return copied(o.result.load.force); },
          "ndarray of float64, shape (3,): the force of the radiation pressure, newtons.")
      .def_property_readonly(
          "torque", [](const Object& o) { return copied(o.result.load.torque); },
          "ndarray of float64, shape (3,): newton metres; about the frame's origin, or about the simulated finger's "
          "tip.")
      .def_property_readonly(
          "far_force", [](const Object& o) { return vector_or_none(o.result.far_force); },
          "ndarray of float64, shape (3,), or None: the same force by the momentum in the air, newtons.")
      .def_property_readonly(
          "beyond_linear", [](const Object& o) { return o.result.beyond_linear(); },
          "bool: whether there is more pressure than linear acoustics holds for.")
      .def_property_readonly(
          "timing", [](const Object& o) { return seconds_of(o.result.times); },
          "dict of str to float: seconds of each step.");
}

void add_scatter(py::module_& m) {
  py::class_<ScatterObject, std::shared_ptr<ScatterObject>> made(m, "Scattering",
                                                                 "The sound of a wave around a rigid body.");
  add_body(made);
  made.def_property_readonly(
          "pressure",
          [](const ScatterObject& o) {
            py::array_t<std::complex<double>> pressures(static_cast<py::ssize_t>(o.result.faces.size()));
            for (std::size_t face = 0; face < o.result.faces.size(); ++face)
              pressures.mutable_data()[face] = o.result.faces[face].pressure;
            return sealed(std::move(pressures));
          },
          "ndarray of complex128, shape (m,): total pressure at the centroid of each face, pascals, peak.")
      .def_property_readonly(
          "around",
          [](const py::object& self) {
            const auto& totals = self.cast<ScatterObject&>().result.totals;
            return shown(totals.data(), {static_cast<py::ssize_t>(totals.size())}, self);
          },
          "ndarray of complex128, shape (n,): total pressure at the places `where`; nan inside the body.")
      .def_property_readonly(
          "points", [](const py::object& self) { return shown(self.cast<ScatterObject&>().result.points, self); },
          "ndarray of float64, shape (n, 3): these places, metres.")
      .def_property_readonly(
          "density", [](const ScatterObject& o) { return o.result.air.density_kg_m3; }, "float: kg/m^3.")
      .def(
          "json", [](const ScatterObject& o) { return to_json(o.result); },
          "str: what `palpa scatter --json` writes. Only `timing_ms` differs between runs.")
      .def("__repr__", [](const ScatterObject& o) {
        return fmt::format("<palpa.Scattering: {}, at most {:.4g} Pa>", counted(o.result.faces.size(), "face"),
                           o.result.loudest_pa);
      });

  const std::string doc =
      scatter_options().documented(R"(The sound of a wave around a rigid body, on its skin, and its force on the body.

Boundary elements: the total pressure p on the skin solves the Helmholtz equation with no motion along the normal. The
force is the integral of the radiation pressure (|p|^2 - |grad_S p|^2 / k^2) / (4 rho c^2).

Parameters
----------
mesh : Mesh, path or (vertices, faces)
    A closed mesh; with an array, in the layout's own frame. Metres.
plane_wave : array_like, shape (3,), optional
    Its direction of travel: 1 Pa, phase 0 at the origin.
point_source : array_like, shape (3,), optional
    Its position: exp(i k r) / r Pa.
layout : Layout, str or path, optional
    An array,
drive : Drive or array_like of complex, shape (M,), optional
    and its drive.
where : Places, array_like of shape (n, 3), Mesh, optional
    Further places for the total pressure.
force : bool, optional
    Also take a mesh whose faces are too coarse for the wavelength.

Returns
-------
Scattering

Raises
------
BadInput
    The mesh is open, too coarse, or meets the array.
BadUsage
    Not exactly one sound is given, or options do not go together.)");
  m.def("scatter", &scatter, py::arg("mesh"), py::kw_only(), py::arg("plane_wave") = py::none(),
        py::arg("point_source") = py::none(), py::arg("layout") = py::none(), py::arg("drive") = py::none(),
        py::arg("where") = py::none(), py::arg("force") = false, doc.c_str());
}

// ---- simulate -------------------------------------------------------------------------------------------------------

/// `palpa.FingerBody`: keeps the finger's equations while it stays in one place.
struct FingerBodyObject {
  FingerBodyObject(NamedMesh mesh, const setup::MediumOptions& tone, const setup::AirOptions& weather, bool force)
      : medium(tone), air(weather), body(mesh.name, std::move(mesh.mesh), setup::air(tone, weather), force) {}

  setup::MediumOptions medium;
  setup::AirOptions air;
  std::mutex turn;
  setup::FingerBody body;
};

struct SimulateArguments {
  setup::SimulateTask task;
  setup::CommonOptions common;
};
void add_simulate_options(CLI::App& app, SimulateArguments& o) {
  setup::add_task_options(app, o.task);
  setup::add_common(app, o.common);
}
constinit DeclaredOnce<SimulateArguments> simulate_options("simulate", add_simulate_options, outputs_of_commands);
constexpr std::initializer_list<const char*> not_of_figure6 = {"--json",   "--quiet",  "--log-level",
                                                               "--method", "--spread", "--draws"};
constinit DeclaredOnce<SimulateArguments> figure6_options("figure6", add_simulate_options, not_of_figure6);

struct FingerAir {
  setup::MediumOptions medium;
  setup::AirOptions air;
};
void add_finger_air(CLI::App& app, FingerAir& o) {
  setup::add_medium_options(app, o.medium);
  setup::add_air_options(app, o.air);
}
constinit DeclaredOnce<FingerAir> finger_air("FingerBody", add_finger_air);

setup::Skin skin_word(const std::string& word) {
  if (const auto skin = value_of(setup::skin_words, word)) return *skin;
  throw bad_usage(fmt::format("skin: '{}' is neither vertices nor cameras", printable(word, 60)));
}

SimulateArguments simulate_arguments(Declared<SimulateArguments>& options, const py::object& penetration,
                                     const std::string& skin, bool noise_free, bool bare_elongation,
                                     const py::kwargs& kwargs) {
  SimulateArguments o = options.read(kwargs);
  o.task.penetration_m = length_of("penetration", penetration);
  o.task.skin = skin_word(skin);
  o.task.noise_free = noise_free;
  o.task.bare_elongation = bare_elongation;
  o.task.compute = o.common;
  check(o.task);
  o.task.compute.device = unlocked([&] { return setup::kept_device(o.common); });
  return o;
}

/// Calls `work` with the body of a FingerBody, or of a mesh.
template <typename Work>
auto with_finger(const py::object& finger, const setup::SimulateTask& task, bool force, const Work& work) {
  if (!py::isinstance<FingerBodyObject>(finger)) {
    NamedMesh mesh = mesh_of("finger", finger);
    return cancellable([&] {
      setup::FingerBody body(mesh.name, std::move(mesh.mesh), setup::air(task.drive.medium, task.air), force);
      return work(body);
    });
  }
  if (force) throw bad_usage("force goes with a finger's mesh; this FingerBody was made before");
  auto& kept = finger.cast<FingerBodyObject&>();
  if (setup::air(kept.medium, kept.air).wave_number() != setup::air(task.drive.medium, task.air).wave_number())
    throw bad_usage("the FingerBody was made for other air or another tone: give it the same options");
  return cancellable([&] {
    const std::lock_guard turn(kept.turn);
    return work(kept.body);
  });
}

std::shared_ptr<SimulateObject> simulate(const SceneObject& scene, const py::object& finger,
                                         const py::object& penetration, const std::string& skin, bool noise_free,
                                         bool bare_elongation, bool force, const py::kwargs& kwargs) {
  refuse_fork();
  const SimulateArguments o =
      simulate_arguments(simulate_options(), penetration, skin, noise_free, bare_elongation, kwargs);
  return owned(with_finger(finger, o.task, force, [&](setup::FingerBody& body) {
    SimulateObject made{setup::simulate(o.task, body, scene.name(), scene.solids)};
    if (made.result.unreached) log::warning(*made.result.unreached);
    return made;
  }));
}

std::shared_ptr<Figure6Object> figure6(const py::object& finger, const py::object& penetration, const std::string& skin,
                                       bool noise_free, bool force, const py::kwargs& kwargs) {
  refuse_fork();
  const SimulateArguments o = simulate_arguments(figure6_options(), penetration, skin, noise_free, false, kwargs);
  return owned(with_finger(finger, o.task, force,
                           [&](setup::FingerBody& body) { return Figure6Object{setup::figure6(o.task, body)}; }));
}

py::dict spot_dict(const acoustics::Spot& spot) {
  py::dict made;
  made["peak"] = spot.peak_pa;
  made["peak_at"] = copied(spot.peak_at);
  made["half_area"] = spot.half_area_m2;
  made["half_radius"] = spot.half_radius_m;
  made["elongation"] = spot.elongation;
  return made;
}

py::dict spot_spread(const setup::SpotSpread& spot) {
  py::dict made;
  made["peak"] = range_of(spot.peak_pa);
  made["peak_at"] = range_of(spot.peak_m);
  made["half_area"] = range_of(spot.half_area_m2);
  made["half_radius"] = range_of(spot.half_radius_m);
  made["elongation"] = range_of(spot.elongation);
  return made;
}

py::object spread_of(const SimulateObject& o) {
  if (!o.result.spread) return py::none();
  const setup::SimulateSpread& spread = *o.result.spread;
  py::dict made;
  made["draws"] = spread.draws.count;
  made["seed"] = spread.draws.seed;
  made["langevin_spot"] = spot_spread(spread.langevin);
  made["squared_spot"] = spot_spread(spread.squared);
  made["force"] = range_of(spread.force);
  made["torque"] = range_of(spread.torque);
  return made;
}

py::array simulated_foci(const SimulateObject& o) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec3> foci;
  for (const std::optional<Vec3>& focus : o.result.foci)
    foci.push_back(focus.value_or(Vec3(nan)));
  return in_world(copied(foci));
}

void add_simulation_class(py::module_& m) {
  py::class_<SimulateObject, std::shared_ptr<SimulateObject>> made(
      m, "Simulation", "The radiation pressure on a finger that is pressed into a scene; averages over the schedule.");
  add_body(made);
  const auto column = [](std::vector<double> acoustics::SkinPressure::*member) {
    return [member](const py::object& self) {
      const std::vector<double>& values = self.cast<SimulateObject&>().result.pressure.*member;
      return shown(values.data(), {static_cast<py::ssize_t>(values.size())}, self);
    };
  };
  made.def_property_readonly("langevin", column(&acoustics::SkinPressure::langevin),
                             "ndarray of float64, shape (m,): (|p|^2 - |grad_S p|^2 / k^2) / (4 rho c^2) at the "
                             "centroid of each face, pascals. Read-only, not copied.")
      .def_property_readonly("squared", column(&acoustics::SkinPressure::squared),
                             "ndarray of float64, shape (m,): |p|^2 / (4 rho c^2), pascals. Read-only, not copied.")
      .def_property_readonly(
          "langevin_spot", [](const SimulateObject& o) { return spot_dict(o.result.langevin); },
          "dict: peak (Pa), peak_at (m), half_area (m^2), half_radius (m), elongation of `langevin`.")
      .def_property_readonly(
          "squared_spot", [](const SimulateObject& o) { return spot_dict(o.result.squared); },
          "dict: the same of `squared`.")
      .def_property_readonly("foci", &simulated_foci,
                             "ndarray of float64, shape (N, 3): metres, world; nan for an empty sector.")
      .def_property_readonly(
          "tip", [](const SimulateObject& o) { return copied(o.result.tip); },
          "ndarray of float64, shape (3,): the origin of the finger's file in its place, metres, world.")
      .def_property_readonly(
          "method", [](const SimulateObject& o) { return std::string(word_of(touch::method_words, o.result.method)); },
          "str: the method that placed the foci.")
      .def_property_readonly(
          "penetration", [](const SimulateObject& o) { return o.result.penetration_m; }, "float: metres.")
      .def_property_readonly(
          "unreached", [](const SimulateObject& o) { return o.result.unreached; },
          "str or None: a sentence about a pressure that the array does not reach.")
      .def_property_readonly(
          "spread", [](const SimulateObject& o) { return spread_of(o); },
          "dict or None: percentiles (5, 50, 95) of random arrays, if spread was given.")
      .def_property_readonly(
          "bare_elongation", [](const SimulateObject& o) { return o.result.bare_elongation; },
          "float or None: elongation of the sound's spot without the finger, if it was asked for.")
      .def(
          "json", [](const SimulateObject& o) { return to_json(o.result); },
          "str: what `palpa simulate --json` writes. Only `timing_ms` differs between runs.")
      .def(
          "csv", [](const SimulateObject& o) { return unlocked([&] { return to_csv(o.result); }); },
          "str: what `palpa simulate --csv` writes: face,x,y,z,area,langevin,squared.")
      .def(
          "write_vtu",
          [](const SimulateObject& o, const py::object& file) {
            unlocked([&, path = file_of("file", file)] { setup::write_vtu(path, o.result); });
          },
          py::arg("file"), "Write the body and both pressures for ParaView.")
      .def("__repr__", [](const SimulateObject& o) {
        return fmt::format("<palpa.Simulation: {}, at most {:.4g} Pa>", counted(o.result.body.triangles.size(), "face"),
                           o.result.langevin.peak_pa);
      });
  py::class_<Figure6Object, std::shared_ptr<Figure6Object>>(m, "Figure6", "The paper's Fig. 6.")
      .def("__len__", [](const Figure6Object& o) { return o.touches.size(); })
      .def(
          "__getitem__",
          [](const Figure6Object& o, std::size_t i) {
            if (i >= o.touches.size()) throw py::index_error("there are fewer touches");
            return std::make_pair(o.touches[i].object,
                                  std::make_shared<SimulateObject>(SimulateObject{o.touches[i].result}));
          },
          "(str, Simulation): the object, and the finger on it.")
      .def(
          "json", [](const Figure6Object& o) { return to_json(std::span(o.touches)); },
          "str: what `palpa simulate --figure6 --json` writes.")
      .def("__repr__", [](const Figure6Object& o) {
        return fmt::format("<palpa.Figure6: {}>", counted(o.touches.size(), "touch"));
      });
}

void add_simulate(py::module_& m) {
  add_simulation_class(m);
  py::class_<FingerBodyObject>(m, "FingerBody", R"(A finger for simulate(), which keeps its equations.

Parameters
----------
finger : Mesh, path or (vertices, faces)
    A closed mesh, tip at the origin, body along +y, metres.
force : bool, optional
    Also take a mesh whose faces are too coarse for the wavelength.
**options
    The air and tone of simulate().)")
      .def(py::init([](const py::object& finger, bool force, const py::kwargs& kwargs) {
             const FingerAir o = finger_air().read(kwargs);
             NamedMesh mesh = mesh_of("finger", finger);
             return cancellable(
                 [&] { return std::make_unique<FingerBodyObject>(std::move(mesh), o.medium, o.air, force); });
           }),
           py::arg("finger"), py::kw_only(), py::arg("force") = false)
      .def("__repr__", [](const FingerBodyObject& o) {
        return shown_text(
            fmt::format("<palpa.FingerBody {}: {}>", o.body.name(), counted(o.body.body().triangles.size(), "face")));
      });
  const setup::SimulateTask defaults;
  const std::string doc = simulate_options().documented(simulate_doc);
  m.def("simulate", &simulate, py::arg("scene"), py::arg("finger"), py::kw_only(),
        py::arg("penetration") = defaults.penetration_m, py::arg("skin") = "vertices", py::arg("noise_free") = false,
        py::arg("bare_elongation") = false, py::arg("force") = false, doc.c_str());
  const std::string figure6_text = figure6_options().documented(figure6_doc);
  m.def("figure6", &figure6, py::arg("finger"), py::kw_only(), py::arg("penetration") = defaults.penetration_m,
        py::arg("skin") = "vertices", py::arg("noise_free") = false, py::arg("force") = false, figure6_text.c_str());
}

}  // namespace

void add_bodies(py::module_& m) {
  add_scatter(m);
  add_simulate(m);
}

}  // namespace palpa::python
