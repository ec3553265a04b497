// Finds the sector that takes the place of a sector without contacts.
#pragma once

#include <algorithm>
#include <cstdint>

namespace palpa::touch {

/// Among a circle's `count` sectors for which `filled(index)` holds, the nearest to `sector` by angle. If two are
/// equally near, the one with the lower index. `count` if it holds for none.
template <typename Filled>
std::uint32_t nearest_filled(std::uint32_t sector, std::uint32_t count, Filled filled) {
  for (std::uint32_t apart = 0; apart <= count / 2; ++apart) {
    const auto [low, high] = std::minmax({(sector + count - apart) % count, (sector + apart) % count});
    if (filled(low)) return low;
    if (filled(high)) return high;
  }
  return count;
}

}  // namespace palpa::touch
