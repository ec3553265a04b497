// Board files made up for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "driver/openmpd/board_file.hpp"
#include "support/files.hpp"

namespace palpa::test {

/// A calibration as of a board with random polarity: offsets in two clusters half a period apart, and one dead
/// transducer.
inline driver::openmpd::Calibration made_up_calibration(std::uint32_t seed) {
  driver::openmpd::Calibration calibration;
  for (std::size_t t = 0; t < driver::openmpd::transducers; ++t) {
    seed = seed * 1664525u + 1013904223u;
    calibration.degrees[t] = static_cast<int>((seed >> 31) * 180) - 28 + static_cast<int>((seed >> 16) % 25) - 12;
  }
  calibration.factors[77] = 0;
  calibration.factors[200] = 0.5f;
  return calibration;
}

/// The text of such a file; `pin_shift` and `position_shift` turn it into that of a different board.
inline std::string board_file_text(const std::string& serial, const driver::openmpd::Calibration& calibration,
                                   double position_shift = 0, int pin_shift = 0) {
  std::string text = serial + "\n256\n128\n";
  for (std::size_t t = 0; t < 256; ++t) {
    text += "(" + std::to_string((static_cast<double>(t / 16) - 7.5) * 0.0105 + position_shift) + ", " +
            std::to_string((7.5 - static_cast<double>(t % 16)) * 0.0105) + ", 0.000000),";
  }
  text += "\n";
  for (std::size_t t = 0; t < 256; ++t) {
    text += std::to_string((driver::openmpd::pin_of(t) + pin_shift) % 256) + ",";
    if (t % 100 == 99) text += "\n";  // some boards' lists extend over several lines
  }
  text += "\n";
  for (const int degrees : calibration.degrees)
    text += std::to_string(degrees) + ",";
  text += "\r\n";
  for (const float factor : calibration.factors)
    text += std::to_string(factor) + ",";
  return text + "\n";
}

}  // namespace palpa::test
