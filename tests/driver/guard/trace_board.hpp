// A board that is one file, for the tests of guards. It records its commands, one line each.
//
//   open            play SLOT AMPLITUDE     plan FROM CYCLE      off     close
//   torn            a drive whose transducers are not of one drive (see whole_drive)
//   allocated N     at the end, if anything was allocated after it was open
#pragma once

#include <algorithm>
#include <cstdint>

#include "driver/board.hpp"

namespace palpa::test {

/// `trace:FILE`. `trace:refuse` does not exist; `trace:unsure:FILE` never knows whether it is silent, and
/// is out of reach if there is a FILE-lost.
driver::BoardKind trace_board();

/// A drive whose parts show that they belong together.
inline void whole_drive(std::uint64_t slot, std::span<array::TransducerDrive> drive) {
  const array::TransducerDrive one{static_cast<float>(1 + slot % 16) / 16, static_cast<float>(slot % 3)};
  std::fill(drive.begin(), drive.end(), one);
}

/// Drives from this slot on make the board throw.
inline constexpr std::uint64_t throws_from_slot = std::uint64_t{1} << 40;

/// The number of memory allocations of this process. The program defines it.
std::uint64_t allocations();

}  // namespace palpa::test
