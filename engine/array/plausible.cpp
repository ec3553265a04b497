#include "array/plausible.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "array/layouts/board_types.hpp"

namespace palpa::array {

std::string implausible_place(const Layout& layout, const Box& box) {
  bool before = false;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [position, axis] : layout.transducers) {
    const Vec3 ahead = glm::max(axis * (box.low - position), axis * (box.high - position));
    before = before || ahead.x + ahead.y + ahead.z > 0;
    nearest = std::min(nearest, glm::distance(position, glm::clamp(position, box.low, box.high)));
  }
  if (!before) return "lies behind the array, where no transducer points";
  if (nearest <= most_plausible_distance_m) return {};
  return fmt::format("lies {:.3g} m from the nearest transducer; beyond {} m, hardly anything is left of a focus",
                     nearest, most_plausible_distance_m);
}

std::string implausible_frequency(const Layout& layout, double hz) {
  if (!layout.boards.empty() && hz != board_frequency_hz) {
    return fmt::format(
        "the boards of {} emit {:g} kHz only; transducers that emit {:.4g} kHz stand in a layout of "
        "your own, without [[unit]]",
        layout.name, board_frequency_hz / 1e3, hz / 1e3);
  }
  if (std::abs(hz - layout.frequency_hz) <= layout.frequency_hz / 2) return {};
  return fmt::format("{:.4g} kHz is far from the {:.4g} kHz that the transducers of {} are made for", hz / 1e3,
                     layout.frequency_hz / 1e3, layout.name);
}

}  // namespace palpa::array
