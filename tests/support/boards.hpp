// Boards for tests that need one with a certain property, whatever its name: from the record of all types.
#pragma once

#include <algorithm>
#include <string>

#include "array/layouts/board_types.hpp"

namespace palpa::test {

/// The type whose transducers are on or off. Its name is that of its layout and its link, too.
inline const array::BoardType& on_off_type() {
  return *std::ranges::find_if(array::board_types(), [](const auto& type) { return !type.has_amplitudes(); });
}
inline std::string on_off_board() {
  return std::string(on_off_type().name);
}

/// The type that is on a serial port. It has one file for all boards.
inline std::string serial_board() {
  return std::string(std::ranges::find(array::board_types(), "a serial port", &array::BoardType::link_words)->name);
}
inline std::string serial_board_file() {
  return serial_board() + ".txt";
}

}  // namespace palpa::test
