// What a drive consists of.
#pragma once

#include <vector>

namespace palpa::array {

/// Amplitude 0..1 and phase in (-pi, pi] of one transducer, e^{-iwt}: the phase is the delay, -k d for a single focus.
struct TransducerDrive {
  float amplitude;
  float phase;
};
using Drive = std::vector<TransducerDrive>;  ///< in layout order

}  // namespace palpa::array
