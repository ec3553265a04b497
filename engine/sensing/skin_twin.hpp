// Skin points of all depth frames inside a box, in plain C++.
#pragma once

#include <span>
#include <vector>

#include "sensing/rays.hpp"
#include "sensing/skin_point.hpp"

namespace palpa::sensing {

/// C++ twin of SkinPass: the same points in the same order (camera, row, column), computed in float by the same
/// operations. `crops` come from plan_crops(cameras, tables, box). Throws bad_usage unless there is one frame of the
/// right size per camera.
void find_skin(const RayTables& tables, std::span<const DepthFrame> frames, const Box& box, std::span<const Crop> crops,
               std::vector<SkinPoint>& out);
/// The same for a single call. It builds the tables and crops itself.
std::vector<SkinPoint> find_skin(std::span<const Camera> cameras, std::span<const DepthFrame> frames, const Box& box);

}  // namespace palpa::sensing
