// Why a point that a camera sees is no skin, and how many such points a frame has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpa::sensing {

/// The reasons, in the order in which they are looked for; a point is counted once, under the first that holds. The
/// numbers are those of shaders/sensing/skin.h.
enum class NoSkin : std::uint32_t {
  room,  ///< outside the room
  board,
  screen,
  background,  ///< not nearer to its camera than what the camera saw without a hand
};

/// The points of a frame that were in the touchable box, but no skin.
struct Dropped {
  std::array<std::uint64_t, 4> counts{};  ///< by NoSkin

  std::uint64_t operator[](NoSkin why) const { return counts[static_cast<std::size_t>(why)]; }
  std::uint64_t total() const { return counts[0] + counts[1] + counts[2] + counts[3]; }
  Dropped& operator+=(const Dropped& more) {
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] += more.counts[i];
    return *this;
  }
  bool operator==(const Dropped&) const = default;
};

}  // namespace palpa::sensing
