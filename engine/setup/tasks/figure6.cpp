#include "setup/tasks/figure6.hpp"

#include "geometry/gltf/gltf.hpp"
#include "setup/files/assets.hpp"

namespace palpa::setup {
namespace {

/// `turned`: by a quarter turn about y, so that the prism's ridge runs along x.
struct Object {
  const char* name;
  const char* asset;
  bool turned = false;
};
constexpr Object objects[]{{"cube", "cube.glb"},
                           {"semi-sphere", "semi-sphere.glb"},
                           {"pyramid", "pyramid.glb"},
                           {"prism", "prism.glb"},
                           {"prism-along-x", "prism.glb", true}};

std::vector<geometry::Solid> solids_of(const Object& object) {
  geometry::Scene scene = geometry::load_gltf(find_asset(object.asset));
  for (geometry::SceneMesh& part : scene.meshes) {
    if (!object.turned) continue;
    part.copy.reset();
    for (Vec3& p : part.mesh.positions)
      p = Vec3(p.z, p.y, -p.x);
  }
  return geometry::make_solids(scene);
}

}  // namespace

std::vector<Figure6Touch> figure6(const SimulateTask& options, FingerBody& finger) {
  SimulateTask o = options;
  o.bare_elongation = true;
  std::vector<Figure6Touch> touches;
  for (const auto& [word, method] : touch::method_words) {
    o.touch.method.method = method;
    for (const Object& object : objects)
      touches.push_back({object.name, simulate(o, finger, object.asset, solids_of(object))});
  }
  return touches;
}

std::string to_json(std::span<const Figure6Touch> touches) {
  JsonWriter json;
  json.begin_array(JsonWriter::Style::block);
  for (const auto& [object, result] : touches) {
    json.begin_object().member("object", object);
    simulate_rows().write_members(json, result);
    json.end_object();
  }
  json.end_array();
  return json.take();
}

}  // namespace palpa::setup
