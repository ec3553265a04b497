#include "acoustics/field/asked_field.hpp"

namespace palpa::acoustics {

bool AskedField::felt(std::span<const Vec3> path, std::size_t every, std::vector<double>& pressures,
                      const std::atomic<bool>* give_up) const {
  if (!field_.felt(path, every, pressures, give_up)) return false;
  for (std::size_t focus = 0; focus * every < path.size(); ++focus) {
    const std::span<double> row = std::span(pressures).subspan(focus * path.size(), path.size());
    const double own = row[focus * every];
    for (double& pressure : row)
      pressure = own > 0 ? pressure / own : 0;
  }
  return true;
}

}  // namespace palpa::acoustics
