// A board's own file, board_NAME.pat, as the boards' makers write it: which USB serial number it has, and what its
// transducers need to sound alike.
//
// Text, of tokens that spaces, line breaks, commas and brackets part as they like: the serial number, the number of
// transducers (256), the phase steps (128); then, per transducer in layout order, its position (x y z, metres), its
// pin, its phase offset in whole degrees, its amplitude factor (0 to 1; 0: it is dead), all of one kind before the
// next.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "driver/openmpd/pins.hpp"

namespace palpa::driver::openmpd {

/// What one board's transducers need, in layout order.
struct Calibration {
  std::array<int, transducers> degrees{};  ///< by which a transducer sounds late: taken off its phase
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

/// Throws bad_input naming file, line and what would be right: tokens that are missing, too many or no numbers,
/// transducers that stand elsewhere or are wired otherwise than on an OpenMPD board.
BoardFile read_board_file(const std::filesystem::path& file);

/// All *.pat of a folder, by name. Throws bad_input for a folder that cannot be read or has none, and as above.
std::vector<BoardFile> read_board_files(const std::filesystem::path& folder);

/// The calibration of the board with that serial number: zero offsets where no file has it. Throws bad_input where
/// several have it and differ: some boards share a serial number, and nobody could say whose is whose.
Calibration calibration_of(const std::vector<BoardFile>& files, const std::string& serial);

}  // namespace palpa::driver::openmpd
