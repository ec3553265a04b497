// The array as built: how much its transducers and the air differ from the layout, drawn at random. The differences are
// those of a finished array in a room, so a drive that was computed for the layout plays on each of them unchanged.
//
//   amplitude = a (1 + s_a n),  phase = phi + s_p n,  position = x + s_x (n, n, n),  celsius = T + s_T n
//
// n are independent standard normal numbers. Those of amplitude, phase and position belong to a transducer. That of the
// temperature is the same for the whole draw.
#pragma once

#include <cstdint>

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::array {

/// Standard deviations; 0 leaves a value as it is.
struct Spread {
  double amplitude = 0;    ///< relative
  double phase_rad = 0;    ///< radians
  double position_m = 0;   ///< metres, along each axis
  double temperature = 0;  ///< kelvin

  bool operator==(const Spread&) const = default;
};

/// One draw.
struct AsBuilt {
  Layout layout;           ///< axes and boards stay as they are
  Drive drive;             ///< what its transducers play of the drive that was asked for
  double temperature = 0;  ///< kelvin above the nominal one
};

/// The draw of this number, counted from 0, for a drive with one entry per transducer. The same seed and number give
/// the same array on every machine, whatever other draws are made; and each standard deviation scales its own numbers
/// only, so that a draw with two of them differs from the layout by the differences of both.
AsBuilt as_built(const Layout& layout, const Drive& drive, const Spread& spread, std::uint64_t seed,
                 std::uint32_t draw);

}  // namespace palpa::array
