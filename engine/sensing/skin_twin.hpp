// Skin points of all depth frames inside a box, in plain C++.
#pragma once

#include <span>
#include <vector>

#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"
#include "sensing/surroundings.hpp"

namespace palpa::sensing {

/// C++ twin of SkinPass: the same points in the same order (camera, row, column), computed in float by the same
/// operations. `crops` come from plan_crops(cameras, tables, box). Throws bad_usage unless there is one frame of the
/// right size per camera.
void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::vector<SkinPoint>& out);
/// What a frame has of skin, and of other things. The vectors keep their storage.
struct SkinOfFrame {
  std::vector<SkinPoint> points;
  Dropped dropped;                  ///< points that are no skin
  std::vector<SkinPoint> leavings;  ///< these points, if they are wanted
  bool wants_leavings = false;
};
/// The same in surroundings: `volumes` come from plan_drops for the same box.
void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::span<const shader::SkinVolume> volumes, SkinOfFrame& out);
/// A pixel that has data, and the place in the world that it shows.
struct PixelPoint {
  std::size_t camera = 0;
  std::uint32_t u = 0, v = 0;
  std::uint16_t raw = 0;
  glm::vec3 position{};
};
/// Whether find_skin() with these volumes takes the point for skin, if it is inside the box.
bool is_skin(const RayTables& tables, std::span<const shader::SkinVolume> volumes, const PixelPoint& point);
/// find_skin() for a single call, without surroundings. It builds the tables and crops itself.
std::vector<SkinPoint> find_skin(std::span<const Camera> cameras, std::span<const DepthFrame> frames, const Box& box);

}  // namespace palpa::sensing
