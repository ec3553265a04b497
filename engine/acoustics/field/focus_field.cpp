#include "acoustics/field/focus_field.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::acoustics {

std::vector<Vec3> path_through(std::span<const Vec3> foci, std::size_t per_side) {
  std::vector<Vec3> path;
  path.reserve(foci.size() * per_side);
  for (std::size_t i = 0; i < foci.size(); ++i) {
    const Vec3 &from = foci[i], &to = foci[(i + 1) % foci.size()];
    for (std::size_t step = 0; step < per_side; ++step)
      path.push_back(from + (to - from) * (static_cast<double>(step) / static_cast<double>(per_side)));
  }
  return path;
}

std::size_t steps_per_side(std::span<const Vec3> foci, double step_m) {
  double longest = 0;
  for (std::size_t i = 0; i < foci.size(); ++i)
    longest = std::max(longest, glm::distance(foci[i], foci[(i + 1) % foci.size()]));
  const std::size_t most = std::max<std::size_t>(1, most_path_places / std::max<std::size_t>(1, foci.size()));
  return std::clamp<std::size_t>(static_cast<std::size_t>(std::min(std::ceil(longest / step_m), 1e6)), 1, most);
}

}  // namespace palpa::acoustics
