#include "viewer/picture/flying.hpp"

#include <algorithm>

namespace palpa::viewer {

void part_flying(const touch::Sight& sight, std::vector<sensing::SkinPoint>& points,
                 std::vector<sensing::SkinPoint>& leavings) {
  std::erase_if(points, [&](const sensing::SkinPoint& point) {
    const bool flies = !touch::is_firm(sight, point.index);
    if (flies) leavings.push_back(point);
    return flies;
  });
}

}  // namespace palpa::viewer
