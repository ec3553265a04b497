// A board of one file, for the tests of guards: it writes down what it is told, one line each.
//
//   open            play SLOT AMPLITUDE     plan FROM CYCLE      off     close
//   torn            a drive whose transducers do not belong together (see whole_drive)
//   allocated N     at the end, where anything was allocated after it was open
#pragma once

#include <algorithm>
#include <cstdint>

#include "driver/board.hpp"

namespace palpa::test {

/// `trace:FILE`. `trace:refuse` is not there; `trace:unsure:FILE` never knows whether it is silent.
driver::BoardKind trace_board();

/// A drive by whose parts one sees that they belong together.
inline void whole_drive(std::uint64_t slot, std::span<array::TransducerDrive> drive) {
  const array::TransducerDrive one{static_cast<float>(1 + slot % 16) / 16, static_cast<float>(slot % 3)};
  std::fill(drive.begin(), drive.end(), one);
}

/// Drives from this slot on make it throw.
inline constexpr std::uint64_t throws_from_slot = std::uint64_t{1} << 40;

/// How often this process has allocated memory. The program defines it.
std::uint64_t allocations();

}  // namespace palpa::test
