#include "geometry/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace palpa::geometry {
namespace {

constexpr double smallest = 1e-3, largest = 5;  // metres

std::string readable(double metres) {
  return metres < 1 ? fmt::format("{:.3g} mm", metres * 1e3) : fmt::format("{:.3g} m", metres);
}

}  // namespace

std::string implausible_size(const Box& box) {
  const Vec3 extent = box.high - box.low;
  const double size = std::max({extent.x, extent.y, extent.z});
  if (!(size > largest || size < smallest)) return {};
  std::string so_far = fmt::format("measures {} (coordinates are metres)", readable(size));
  for (const auto& [unit, metres] :
       {std::pair("millimetres", 1e-3), std::pair("micrometres", 1e-6), std::pair("kilometres", 1e3)}) {
    if (size * metres < smallest || size * metres > largest) continue;
    return fmt::format("{}; if they are {}, it measures {}: multiply them by {:g}", so_far, unit,
                       readable(size * metres), metres);
  }
  return so_far;
}

}  // namespace palpa::geometry
