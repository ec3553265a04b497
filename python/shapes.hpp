// Meshes, solids and scenes as Python objects.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/frames.hpp"
#include "touch/contacts/prepared_solids.hpp"

namespace palpa::python {

namespace py = pybind11;

/// `palpa.Mesh`: triangles in metres, from a file or from arrays.
struct MeshObject {
  geometry::Mesh mesh;
  std::string source;  ///< its file; empty: it was made from arrays
};

/// `palpa.Scene`.
struct SceneObject {
  std::string source;                       ///< its file; empty: it was made from arrays
  std::optional<std::uint32_t> gltf_scene;  ///< how it was loaded, for those who load it again
  setup::SolidOptions options;
  std::vector<geometry::Solid> solids;
  /// What is prepared of the solids, once for every touch.
  std::shared_ptr<touch::KeptSolids> kept_solids = std::make_shared<touch::KeptSolids>();
  py::object given;  ///< what it was made of, for pickles
  py::dict keywords;
  std::string name() const { return source.empty() ? "the scene of arrays" : source; }
};

/// Lets a run load the scene's file again, or use its solids, if there is none.
void set_scene(const SceneObject& scene, setup::FrameOptions& options);

/// The Scene, or null for anything else. Its file is read again, as it was read for the Scene. Throws bad_usage if a
/// keyword says how to read it.
const SceneObject* loaded_scene(const py::object& scene, const py::kwargs& kwargs,
                                std::initializer_list<const char*> keywords);

/// `palpa.Solid`: one of a scene, which it keeps alive.
struct SolidObject {
  std::shared_ptr<const SceneObject> scene;
  std::size_t index = 0;
  const geometry::Solid& solid() const { return scene->solids[index]; }
};

/// The solid of that name or index. Throws KeyError or IndexError.
std::size_t solid_index(const SceneObject& scene, const py::object& key);

/// The mesh of a Mesh, of a path, or of a pair (vertices, faces). `name` is its name in messages: its file, or `what`.
struct NamedMesh {
  geometry::Mesh mesh;
  std::string name;
};
NamedMesh mesh_of(const std::string& what, py::handle value);

/// A text, or the path of an object with __fspath__; nullopt for everything else.
std::optional<std::string> path_of(py::handle value);
/// The same; throws bad_usage naming the argument `name` if there is no path.
std::string file_of(const char* name, py::handle value);

}  // namespace palpa::python
