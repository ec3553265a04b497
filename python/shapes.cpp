#include "shapes.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/files/reference.hpp"
#include "base/system/parallel.hpp"
#include "base/text.hpp"
#include "base/words.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/haptics.hpp"
#include "line/values.hpp"
#include "module.hpp"
#include "running.hpp"
#include "setup/sessions/load.hpp"
#include "values/arrays.hpp"
#include "values/options.hpp"
#include "values/placed.hpp"

namespace palpa::python {

std::optional<std::string> path_of(py::handle value) {
  if (!py::isinstance<py::str>(value) && !py::hasattr(value, "__fspath__")) return std::nullopt;
  const py::object path = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  if (!path) throw py::error_already_set();
  // As bytes, a path may be anything that a file may be called.
  const py::object text = py::isinstance<py::str>(path)
                              ? path
                              : py::reinterpret_steal<py::object>(PyUnicode_DecodeFSDefaultAndSize(
                                    PyBytes_AS_STRING(path.ptr()), PyBytes_GET_SIZE(path.ptr())));
  if (!text) throw py::error_already_set();
  std::string bytes = bytes_of("path", text);
  if (bytes.empty()) throw bad_usage("a path is empty");
  return bytes;
}

std::string file_of(const char* name, py::handle value) {
  const std::optional<std::string> path = path_of(value);
  if (!path) throw bad_usage(fmt::format("{}: give the path of a file", name));
  return *path;
}

NamedMesh mesh_of(const std::string& what, py::handle value) {
  if (py::isinstance<MeshObject>(value)) {
    const auto& own = value.cast<const MeshObject&>();
    return {own.mesh, own.source.empty() ? what : own.source};
  }
  if (const std::optional<std::string> file = path_of(value)) {
    return {unlocked([&] { return geometry::load_triangles(*file); }), *file};
  }
  if (py::isinstance<py::tuple>(value) && py::len(value) == 2) {
    const auto pair = value.cast<py::tuple>();
    NamedMesh made{.mesh = {}, .name = what};
    made.mesh.positions = points_of(what + ": vertices", pair[0]);
    made.mesh.triangles = triangles_of(what + ": faces", pair[1], made.mesh.positions.size());
    return made;
  }
  throw bad_usage(
      fmt::format("{}: give a palpa.Mesh, the path of a PLY or glTF file, or a pair (vertices, faces)", what));
}

void set_scene(const SceneObject& scene, setup::FrameOptions& options) {
  options.scene = scene.name();
  options.gltf_scene = scene.gltf_scene;
  options.solids = scene.options;
  if (scene.source.empty()) {
    options.made_solids = std::make_shared<const std::vector<geometry::Solid>>(scene.solids);
    options.solids = {};
  }
}

const SceneObject* loaded_scene(const py::object& scene, const py::kwargs& kwargs,
                                std::initializer_list<const char*> keywords) {
  if (!py::isinstance<SceneObject>(scene)) return nullptr;
  for (const char* keyword : keywords) {
    if (kwargs.contains(keyword) && !kwargs[keyword].is_none())
      throw bad_usage(fmt::format("{} goes with the path of a scene; a Scene has its own", keyword));
  }
  return &scene.cast<const SceneObject&>();
}

std::size_t solid_index(const SceneObject& scene, const py::object& key) {
  if (py::isinstance<py::str>(key)) {
    const std::string name = bytes_of("solid", key);
    for (std::size_t i = 0; i < scene.solids.size(); ++i) {
      if (scene.solids[i].name == name) return i;
    }
    throw py::key_error(fmt::format("{} has no solid \"{}\"", printable(scene.name()), printable(name, 60)));
  }
  const auto count = static_cast<py::ssize_t>(scene.solids.size());
  if (!PyIndex_Check(key.ptr())) throw py::type_error("give the name or the index of a solid");
  const py::ssize_t index = PyNumber_AsSsize_t(key.ptr(), PyExc_IndexError);
  if (index == -1 && PyErr_Occurred()) throw py::error_already_set();
  if (index < -count || index >= count)
    throw py::index_error(fmt::format("the scene has {}", counted(scene.solids.size(), "solid")));
  return static_cast<std::size_t>(index < 0 ? index + count : index);
}

namespace {

struct SceneOptions {
  std::optional<std::uint32_t> gltf_scene;
  setup::SolidOptions solids;
  setup::CommonOptions common;
};
void add_scene_options(CLI::App& app, SceneOptions& o) {
  const line::Group group(app, "Scene");
  setup::add_gltf_scene(group, o.gltf_scene);
  setup::add_solid_options(app, o.solids);
  setup::add_allow_outside(group, o.common);
}

constinit DeclaredOnce<SceneOptions> scene_options("Scene", add_scene_options);

/// A mesh, or several with the names of their solids. `kept`: copies of the same.
geometry::Scene scene_of_arrays(const py::object& given, py::dict& kept) {
  geometry::Scene scene{.file = SceneObject().name(), .meshes = {}};
  const bool one = py::isinstance<MeshObject>(given) || py::isinstance<py::tuple>(given);
  if (!one && !py::isinstance<py::dict>(given)) {
    throw bad_usage(
        "Scene: give the path of a glTF file, a palpa.Mesh, a pair (vertices, faces), or a dict of these by the names "
        "of "
        "their solids");
  }
  py::dict named;
  if (one) {
    named["solid"] = given;
  } else {
    named = py::reinterpret_steal<py::dict>(PyDict_Copy(given.ptr()));
  }
  for (const auto& [name, mesh] : named) {
    if (!py::isinstance<py::str>(name)) throw bad_usage("Scene: the name of a solid is a text");
    const std::string text = bytes_of("Scene", name);
    scene.meshes.push_back({.name = text, .mesh = mesh_of(text, mesh).mesh});
    kept[name] = MeshObject{scene.meshes.back().mesh, ""};
  }
  return scene;
}

std::shared_ptr<SceneObject> load_scene(const py::object& file, const py::kwargs& kwargs) {
  const SceneOptions o = scene_options().read(kwargs);
  const std::optional<std::string> path = path_of(file);
  auto scene = std::make_shared<SceneObject>();
  scene->given = file;
  scene->keywords = kwargs;
  if (!path) {
    if (o.gltf_scene) throw bad_usage("gltf_scene goes with the path of a glTF file");
    py::dict kept;
    const geometry::Scene made = scene_of_arrays(file, kept);
    scene->given = kept;
    scene->options = o.solids;
    scene->solids = cancellable([&] { return setup::solids_of(made, o.solids); });
    return scene;
  }
  scene->source = *path;
  scene->gltf_scene = o.gltf_scene;
  scene->options = o.solids;
  allow_outside_references(o.common.allow_outside);
  scene->solids = cancellable([&] { return setup::load_solids(*path, o.gltf_scene, o.solids); });
  return scene;
}

/// A pickled scene. A forked process cannot load it, but if that were refused here, a multiprocessing.Pool would lose
/// the task and wait for ever. So it is without solids there, and refused when it is used.
std::shared_ptr<SceneObject> restored_scene(const py::object& given, const py::kwargs& keywords) {
  if (is_own_process()) return load_scene(given, keywords);
  auto scene = std::make_shared<SceneObject>();
  scene->source = path_of(given).value_or("");
  scene->given = given;
  scene->keywords = keywords;
  return scene;
}

const SceneObject& loaded(const SceneObject& scene) {
  if (scene.solids.empty()) refuse_fork();
  return scene;
}

py::dict haptics_of(const geometry::Haptics& haptics) {
  py::dict values;
  const auto add = [&](const char* key, const auto& value) {
    if (value) values[key] = *value;
  };
  add("delta", haptics.delta_m);
  add("foci", haptics.foci);
  add("stride", haptics.stride);
  add("dwell", haptics.dwell_s);
  add("intensity", haptics.intensity);
  add("pressure", haptics.pressure_pa);
  add("press_depth", haptics.press_depth_m);
  if (haptics.clicks()) values["click"] = py::make_tuple(haptics.click->burst_s, haptics.click->hz);
  if (haptics.stiffness) {
    py::list rows;
    for (const geometry::DepthForce& row : *haptics.stiffness)
      rows.append(py::make_tuple(row.depth_m, row.force));
    values["stiffness"] = rows;
  }
  if (haptics.texture) {
    const auto [steady, low, high] = *haptics.texture;
    values["texture"] = py::make_tuple(steady, low, high);
  }
  add("grain", haptics.grain_m);
  return values;
}

void add_mesh(py::module_& m) {
  py::class_<MeshObject, std::shared_ptr<MeshObject>>(m, "Mesh", R"(Triangles, in metres.

Parameters
----------
source : path, or a pair (vertices, faces)
    A PLY or glTF file, or arrays of shape (n, 3) and (m, 3). Corners run counter-clockwise seen from outside.

Raises
------
BadInput
    The file is missing or broken.
BadUsage
    The arrays have another shape, are not finite, or name a vertex that does not exist.)")
      .def(py::init([](const py::object& source) {
             NamedMesh made = mesh_of("mesh", source);
             return MeshObject{std::move(made.mesh), path_of(source).value_or("")};
           }),
           py::arg("source"))
      .def_property_readonly(
          "vertices", [](const py::object& self) { return shown(self.cast<MeshObject&>().mesh.positions, self); },
          "ndarray of float64, shape (n, 3): metres; read-only, not copied.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return shown(self.cast<MeshObject&>().mesh.triangles, self); },
          "ndarray of uint32, shape (m, 3): the corners of each triangle; read-only, not copied.")
      .def_property_readonly(
          "volume", [](const MeshObject& o) { return geometry::signed_volume(o.mesh); },
          "float: cubic metres; positive if the triangles face outwards.")
      .def_property_readonly(
          "area", [](const MeshObject& o) { return geometry::area(o.mesh); }, "float: square metres.")
      .def("__repr__", [](const MeshObject& o) {
        return shown_text(fmt::format("<palpa.Mesh{}: {}, {}>", o.source.empty() ? "" : " " + o.source,
                                      counted(o.mesh.positions.size(), "vertex"),
                                      counted(o.mesh.triangles.size(), "face")));
      });
  m.def(
      "read_ply",
      [](const py::object& file) {
        const geometry::Ply ply = unlocked([path = file_of("read_ply", file)] { return geometry::read_ply(path); });
        py::array_t<double> points({static_cast<py::ssize_t>(ply.positions.size()), py::ssize_t{3}});
        for (std::size_t i = 0; i < ply.positions.size(); ++i) {
          for (int axis = 0; axis < 3; ++axis)
            points.mutable_data()[3 * i + static_cast<std::size_t>(axis)] = ply.positions[i][axis];
        }
        return points;
      },
      py::arg("file"), R"(Read the vertices of a PLY file, such as points of skin.

Parameters
----------
file : path

Returns
-------
ndarray of float64, shape (n, 3)
    Metres, in file order. The array is yours and may be changed.

Raises
------
BadInput
    The file is missing or broken.)");
  m.def(
      "write_ply",
      [](const py::object& file, const py::object& points, const py::object& faces) {
        const std::string path = file_of("write_ply", file);
        const std::vector<Vec3> positions = points_of("points", points);
        const std::vector<glm::uvec3> triangles =
            faces.is_none() ? std::vector<glm::uvec3>() : triangles_of("faces", faces, positions.size());
        unlocked([&] { geometry::write_ply(path, positions, triangles, geometry::PlyFormat::ascii); });
      },
      py::arg("file"), py::arg("points"), py::arg("faces") = py::none(),
      R"(Write points, and triangles if there are any, as a PLY file whose numbers read back to the same values.

Parameters
----------
file : path
points : array_like, shape (n, 3)
    Metres.
faces : array_like of int, shape (m, 3), optional)");
}

void add_scene(py::module_& m) {
  py::class_<SolidObject>(m, "Solid", "A touchable object of a Scene. The scene is in world coordinates, +y is up.")
      .def_property_readonly(
          "name", [](const SolidObject& o) { return o.solid().name; }, "str: the name of its node in the model.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) { return shown(self.cast<SolidObject&>().solid().mesh.positions, self); },
          "ndarray of float64, shape (n, 3): metres, world; read-only, not copied.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return shown(self.cast<SolidObject&>().solid().mesh.triangles, self); },
          "ndarray of uint32, shape (m, 3): counter-clockwise seen from outside; read-only, not copied.")
      .def_property_readonly(
          "bounds",
          [](const SolidObject& o) {
            return copied(std::vector<Vec3>{o.solid().bounds.low, o.solid().bounds.high});
          },
          "ndarray of float64, shape (2, 3): the lowest and the highest corner of its box, metres.")
      .def_property_readonly(
          "parts", [](const SolidObject& o) { return o.solid().parts.parts.size(); },
          "int: the number of its convex parts; 0 if the mesh itself is its surface.")
      .def_property_readonly(
          "haptics", [](const SolidObject& o) { return haptics_of(o.solid().haptics); },
          "dict: how its author wants it to be felt, in SI units; only what the model says. A click is its length and "
          "frequency, a stiffness a list of depths with their forces, a texture three weights.")
      .def(
          "depth",
          [](const SolidObject& o, const py::object& points) {
            refuse_other_frame("points", points);
            const std::vector<Vec3> at = points_of("points", points);
            py::array_t<double> depths(static_cast<py::ssize_t>(at.size()));
            double* const to = depths.mutable_data();
            cancellable([&] {
              parallel_chunks(at.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                  to[i] = geometry::depth(o.solid(), at[i]);
              });
              return true;
            });
            return sealed(std::move(depths));
          },
          py::arg("points"),
          R"(Depth of points below the surface, Eq. (1) of the paper: min over faces m of (x_m - x) . n_m.

Parameters
----------
points : array_like, shape (n, 3)
    Metres, world.

Returns
-------
ndarray of float64, shape (n,)
    Metres, positive inside. Outside of a convex solid, it is minus a lower bound of the distance.)")
      .def("__repr__", [](const SolidObject& o) {
        return fmt::format("<palpa.Solid \"{}\": {}, {}>", o.solid().name,
                           counted(o.solid().mesh.positions.size(), "vertex"),
                           counted(o.solid().mesh.triangles.size(), "face"));
      });

  const std::string doc = scene_options().documented(R"(The solids of a glTF model or of arrays, ready to be touched.

Parameters
----------
file : path, Mesh, (vertices, faces), or dict
    A .gltf or .glb file; or a mesh, or meshes by the names of their solids. Meshes must be closed, and their corners run
    counter-clockwise seen from outside. Coordinates are in metres, in the world, +y is up.

Raises
------
BadInput
    The file is missing or broken, a mesh is open or passes through itself, or there is no solid.)");
  py::class_<SceneObject, std::shared_ptr<SceneObject>>(m, "Scene", doc.c_str())
      .def(py::init(&load_scene), py::arg("file"))
      .def_property_readonly(
          "source", [](const SceneObject& o) { return shown_text(o.source); },
          "str: the file; empty for a scene of arrays.")
      .def("__reduce__",
           [](const SceneObject& o) {
             return py::make_tuple(py::module_::import("palpa._pickle").attr("scene"),
                                   py::make_tuple(o.given, o.keywords));
           })
      .def("__len__", [](const SceneObject& o) { return loaded(o).solids.size(); })
      .def("__getitem__",
           [](const std::shared_ptr<SceneObject>& o, const py::object& key) {
             return SolidObject{o, solid_index(loaded(*o), key)};
           })
      .def_property_readonly(
          "solids",
          [](const std::shared_ptr<SceneObject>& o) {
            std::vector<SolidObject> all;
            for (std::size_t i = 0; i < loaded(*o).solids.size(); ++i)
              all.push_back({o, i});
            return all;
          },
          "list of Solid: in the order of the file's nodes.")
      .def("__repr__", [](const SceneObject& o) {
        std::string names;
        for (std::size_t i = 0; i < o.solids.size() && i < 5; ++i)
          names += (i ? ", " : "") + o.solids[i].name;
        return shown_text(fmt::format("<palpa.Scene {}: {}{}>", o.name(), names, o.solids.size() > 5 ? ", ..." : ""));
      });
}

}  // namespace

void add_shapes(py::module_& m) {
  add_mesh(m);
  add_scene(m);
  m.def("_restore_scene", [](const py::object& given, const py::dict& keywords) {
    return restored_scene(given, py::reinterpret_borrow<py::kwargs>(keywords));
  });
}

}  // namespace palpa::python
