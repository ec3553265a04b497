#include "setup/tasks/force_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/log.hpp"

namespace palpa::setup {
namespace {

/// Parts of the force, and of the integral of the magnitude of the pressure.
constexpr double tolerance = 0.03, of_all_pushes = 0.003;

}  // namespace

void warn_of_force(const std::string& body, const acoustics::SkinPressure& pressure, const Vec3& far_force) {
  const Vec3& force = pressure.langevin_load.force;
  const double apart = glm::distance(force, far_force);
  if (apart <= std::max(tolerance * glm::length(far_force), of_all_pushes * pressure.langevin_push_n)) return;
  log::warning(
      fmt::format("{}: the force by radiation pressure, {:.3g} mN, and by momentum in the air, {:.3g} mN, are {:.1f} % "
                  "apart; a finer mesh makes both more exact",
                  body, glm::length(force) * 1e3, glm::length(far_force) * 1e3, 100 * apart / glm::length(far_force)));
}

}  // namespace palpa::setup
