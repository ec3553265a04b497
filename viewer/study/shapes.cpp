#include "viewer/study/shapes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "base/files/sha256.hpp"
#include "touch/contacts/prepared_solids.hpp"

namespace palpa::viewer {

StudyShapes load_shapes(const study::StudyPlan& plan) {
  StudyShapes all;
  std::uint32_t group = 0;
  for (std::size_t shape = 0; shape < plan.shapes.size(); ++shape) {
    StudyShape& own = all.shapes.emplace_back();
    own.model_sha256 = sha256_of_file(plan.shapes[shape].model);
    std::uint32_t groups = 0;
    geometry::Scene scene = geometry::load_gltf(plan.shapes[shape].model);
    own.box = geometry::box_of(scene);
    own.least = setup::least_sound(scene, plan.run.deep_m);
    for (geometry::SceneMesh& mesh : scene.meshes) {
      mesh.name = solid_name(plan, shape);
      mesh.copy.reset();
      if (mesh.part) {
        groups = std::max(groups, mesh.part->group + 1);
        mesh.part->solid = mesh.name;
        mesh.part->group += group;
      }
      all.meshes.push_back(std::move(mesh));
    }
    group += groups;
  }
  return all;
}

std::vector<Box> take_shapes(study::StudyPlan& plan, const StudyShapes& shapes) {
  std::vector<Box> boxes;
  for (std::size_t shape = 0; shape < shapes.shapes.size(); ++shape) {
    setup::set_least(plan.shapes[shape], shapes.shapes[shape].least);
    boxes.push_back(shapes.shapes[shape].box);
  }
  return boxes;
}

std::string solid_name(const study::StudyPlan& plan, std::size_t shape) {
  return fmt::format("{} {}", shape, plan.shapes[shape].name);
}

std::size_t shape_of(const std::string& solid_name) {
  return static_cast<std::size_t>(std::strtoul(solid_name.c_str(), nullptr, 10));
}

std::vector<Transform> only(std::size_t shape, std::span<const std::string> solid_names) {
  const Transform away = glm::translate(Transform(1.0), Vec3(0, 10 * touch::out_of_reach_m, 0));
  std::vector<Transform> poses;
  for (const std::string& name : solid_names)
    poses.push_back(shape_of(name) == shape ? Transform(1.0) : away);
  return poses;
}

std::optional<Vec3> lowest_point(std::span<const sensing::SkinPoint> points, const Box& box) {
  std::vector<Vec3> inside;
  for (const sensing::SkinPoint& point : points) {
    const Vec3 p(point.position);
    if (p.x < box.low.x || p.x > box.high.x || p.z < box.low.z || p.z > box.high.z || p.y < box.low.y) continue;
    inside.push_back(p);
  }
  std::ranges::sort(inside, {}, &Vec3::y);
  // The points around the lowest one come next to it in this order.
  for (std::size_t i = 0; i < inside.size(); ++i) {
    std::size_t around = 0;
    for (std::size_t k = i + 1; k < inside.size() && inside[k].y - inside[i].y <= neighbour_m; ++k) {
      const Vec3 way = inside[k] - inside[i];
      around += glm::dot(way, way) <= neighbour_m * neighbour_m ? 1 : 0;
      if (around >= least_neighbours) return inside[i];
    }
  }
  return std::nullopt;
}

}  // namespace palpa::viewer
