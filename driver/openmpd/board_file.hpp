// A board's own file, board_NAME.pat, as the boards' makers write it: the board's USB serial number, and what its
// transducers need to sound alike.
//
// A text of tokens, with any spaces, line breaks, commas and brackets between them: the serial number, the number of
// transducers (256), the phase steps (128). Four lists follow, each in layout order: positions (x y z, metres), pins,
// phase offsets in whole degrees, and amplitude factors (0 to 1; 0: the transducer is dead).
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "driver/openmpd/pins.hpp"

namespace palpa::driver::openmpd {

/// What one board's transducers need, in layout order.
struct Calibration {
  std::array<int, transducers> degrees{};  ///< how late a transducer sounds; subtracted from its phase
  std::array<float, transducers> factors = [] {
    std::array<float, transducers> ones{};
    ones.fill(1);
    return ones;
  }();  ///< 0..1, amplitudes are multiplied by it
  bool operator==(const Calibration&) const = default;
};

struct BoardFile {
  std::filesystem::path file;
  std::string serial;
  Calibration calibration;
};

/// Throws bad_input that names file, line and what would be right: for tokens that are missing, too many or not
/// numbers, and for transducers with another place or wiring than on an OpenMPD board.
BoardFile read_board_file(const std::filesystem::path& file);

/// All *.pat files of a folder, by name. Throws bad_input if the folder cannot be read or has none, and as above.
std::vector<BoardFile> read_board_files(const std::filesystem::path& folder);

/// The calibration of the board with that serial number: zero offsets if no file has it. Throws bad_input if several
/// files have it and differ: some boards share a serial number, and it would not be clear which file is whose.
Calibration calibration_of(const std::vector<BoardFile>& files, const std::string& serial);

}  // namespace palpa::driver::openmpd
