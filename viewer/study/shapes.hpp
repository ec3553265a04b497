// All shapes of a study as one scene. One shape at a time is within reach, so that a session changes the shape from one
// frame to the next without loading anything.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/skin_point.hpp"
#include "setup/sessions/study_plan.hpp"
#include "study/plan/plan.hpp"

namespace palpa::viewer {

/// One shape of the plan.
struct StudyShape {
  std::string model_sha256;
  Box box;  ///< around its meshes, metres, world
  setup::LeastSound least{};
};

struct StudyShapes {
  std::vector<StudyShape> shapes;           ///< as in the plan
  std::vector<geometry::SceneMesh> meshes;  ///< of all shapes; each is named after its shape
};

/// Reads the models. Throws as geometry::load_gltf does.
StudyShapes load_shapes(const study::StudyPlan& plan);
/// Takes them into the plan as setup::try_files does, and returns their boxes.
std::vector<Box> take_shapes(study::StudyPlan& plan, const StudyShapes& shapes);

/// The name of the solids of a shape in the scene: "2 pyramid" for the third shape.
std::string solid_name(const study::StudyPlan& plan, std::size_t shape);
/// The shape of a solid of the scene, by its name.
std::size_t shape_of(const std::string& solid_name);

/// The pose of each solid with which only one shape is within reach.
std::vector<Transform> only(std::size_t shape, std::span<const std::string> solid_names);

/// A depth camera sees single points between a finger and what is behind it (flying pixels). A point on skin has at
/// least this many others around it, this near.
inline constexpr std::size_t least_neighbours = 10;
inline constexpr double neighbour_m = 4e-3;

/// The lowest point of skin over or in the object: within its box seen from above, not below its bottom.
std::optional<Vec3> lowest_point(std::span<const sensing::SkinPoint> points, const Box& box);

}  // namespace palpa::viewer
