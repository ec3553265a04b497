// How much of one frame the passes' memory takes.
#pragma once

#include <cstdint>

namespace palpa::touch {

/// What there is beyond that is left out; the passes' totals tell. A StageMemory decides it (stage.hpp).
struct Room {
  std::uint32_t points = 0;    ///< skin points, at most shader::contacts_most_points
  std::uint32_t contacts = 0;  ///< at most `points`
  std::uint32_t deep = 0;      ///< deep points, at most `points`; 0 where nobody asks for them
  bool inside = false;         ///< deep points are clustered, too

  /// Points that are clustered. A point is a contact or deep, never both.
  std::uint32_t clustered() const {
    const std::uint32_t both = contacts + (inside ? deep : 0);
    return both < points ? both : points;
  }
};

}  // namespace palpa::touch
