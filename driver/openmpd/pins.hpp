// Which of a board's 256 wire slots, its pins, drives which transducer. Transducer t = 16 x + y stands in column x from
// the left and row y from the top (docs/layouts.md). Every board is wired alike, and no firmware undoes this:
//
//   pin = 64 (3 - x / 4) + 8 (7 - y / 2) + within[x mod 4][y mod 2]
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpa::driver::openmpd {

inline constexpr std::size_t transducers = 256;  ///< of one board

constexpr std::uint8_t pin_of(std::size_t transducer) {
  constexpr std::uint8_t within[4][2] = {{1, 5}, {0, 4}, {3, 6}, {2, 7}};
  const std::size_t x = transducer / 16, y = transducer % 16;
  return static_cast<std::uint8_t>(64 * (3 - x / 4) + 8 * (7 - y / 2) + within[x % 4][y % 2]);
}

}  // namespace palpa::driver::openmpd
