// Chooses how many foci a finger gets and in what order they play, so that the vibration's energy sits where skin is
// most sensitive.
//
// With N foci, stride s and dwell d the frequency m / (N d) carries the perimeter's angular harmonic n with
// s n = m (mod N). A small perimeter is one broad spot that wanders: its first harmonic dominates, and s / (N d) is
// where it sounds; a long one is a short touch now and then, and sounds at all m / (N d) alike. So the best N and s
// depend on the perimeter. What is maximised is
//
//   share(N, s, d) = sum over lines of (w(f) A_f)^2 / sum over lines of A_f^2,
//
// felt_share of the spectrum of a ring of that perimeter, w being skin_sensitivity. N, s, d are changed only where the
// share grows by `gain` at least; of candidates equally good the one with the fewest foci, then the least stride, then
// the longest dwell is taken. Deterministic.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "acoustics/spectrum.hpp"

namespace palpa::acoustics {

struct TuneOptions {
  /// Foci tried: from the ring's own number (fewer would make the shape coarser than was asked for) to this many, or to
  /// the ring's own where that is more.
  std::uint32_t most_foci = 24;
  /// Dwells tried: the ring's own or, where the longest is not 0, whole tenths of a millisecond in this range.
  double shortest_dwell_s = 0, longest_dwell_s = 0;
  double gain = 0.05;  ///< relative growth of the share that a change must bring
  SpectrumOptions spectrum;
};

struct Tuned {
  Ring ring;  ///< as it should be; strides at most half of N, since N - s is s the other way round
  double share_before = 0, share = 0;
  bool changed = false;
};

inline constexpr std::uint32_t most_ring_foci = 64;

/// A ring with fewer than 3 foci, more than most_ring_foci or without a perimeter stays as it is.
Tuned tune(const Ring& ring, const TuneOptions& options = {});

/// Chooses the stride of fingers that are followed from frame to frame, the number of their foci and the dwell being
/// given: another number would move every focus. A finger's first frame decides; after that it changes no more often
/// than every `rest_s`, and only where the share grows by `gain`, so that it does not flip between two that are about
/// as good. Allocates nothing.
class StrideTuner {
 public:
  static constexpr double gain = 0.10, rest_s = 0.5;
  static constexpr std::size_t most_fingers = 64;  ///< at a time; of more it forgets the one seen longest ago

  /// The stride for finger `id`, whose foci lie on `ring`, in the frame captured at `time_s`.
  std::uint32_t stride_for(std::uint32_t id, const Ring& ring, double time_s);

 private:
  struct Known {
    bool used = false;
    std::uint32_t id = 0, foci = 0, stride = 0;
    double chosen_s = 0, seen_s = 0;
  };
  Known& known(std::uint32_t id);
  std::array<Known, most_fingers> known_{};
};

}  // namespace palpa::acoustics
