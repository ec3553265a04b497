// The capacity of the passes' memory for one frame.
#pragma once

#include <cstdint>

namespace palpa::touch {

/// Default number of contacts of one frame with cameras.
inline constexpr std::uint32_t default_contacts = 262'144;

/// Anything beyond this capacity is left out; the passes' totals report it. DevicePoints sets the capacity
/// (points/device_points.hpp).
struct Capacity {
  std::uint32_t points = 0;    ///< skin points, at most shader::contacts_most_points
  std::uint32_t contacts = 0;  ///< at most `points`
  std::uint32_t deep = 0;      ///< deep points, at most `points`; 0 if they are not requested
  bool inside = false;         ///< deep points are clustered, too

  /// The number of points that are clustered. A point is a contact or a deep point, never both.
  std::uint32_t clustered() const {
    const std::uint32_t both = contacts + (inside ? deep : 0);
    return both < points ? both : points;
  }
};

}  // namespace palpa::touch
