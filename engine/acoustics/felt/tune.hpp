// Chooses how many foci a finger gets and in what order they play, so that the vibration's energy sits where skin is
// most sensitive to it and little of it is felt as flutter.
//
// With N foci, stride s and dwell d the frequency m / (N d) carries the perimeter's angular harmonic n with
// s n = m (mod N). A small perimeter is one broad spot that wanders: its first harmonic dominates, and s / (N d) is
// where it sounds; a long one is a short touch now and then, and sounds at all m / (N d) alike. So the best N and s
// depend on the perimeter, and on how sharp the array's focus is there. What is maximised is
//
//   balance(N, s, d) = vibration - flutter_weight flutter
//
// of what is felt (skin.hpp) of a ring of that perimeter: without the second term a ring of 50 mm would get 23 foci,
// and beside its lines at 203 and 232 Hz one as strong at 29 Hz. N, s, d are changed only where the balance grows by
// `gain` of the vibration at least; of candidates equally good the one with the fewest foci, then the least stride,
// then the longest dwell is taken. Deterministic.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "acoustics/felt/harmonics.hpp"
#include "acoustics/felt/spectrum.hpp"

namespace palpa::acoustics {

struct TuneOptions {
  /// Foci tried: from the ring's own number (fewer would make the shape coarser than was asked for) to this many, or to
  /// the ring's own where that is more.
  std::uint32_t most_foci = 24;
  /// Dwells tried: the ring's own or, where the longest is not 0, whole tenths of a millisecond in this range.
  double shortest_dwell_s = 0, longest_dwell_s = 0;
  double gain = 0.05;  ///< growth of the balance that a change must bring, by the vibration that is felt before
  SpectrumOptions spectrum;
};

struct Tuned {
  Ring ring;  ///< as it should be; strides at most half of N, since N - s is s the other way round
  Felt before, after;
  bool changed = false;
  FocusKind field{};  ///< what foci were
};

/// A ring with fewer than 3 foci, more than most_ring_foci or without a perimeter stays as it is. `foci` are the ring's
/// own: where the options have a field and there is one for each focus of the ring, it is that between them
/// that counts, else that of spots on a curve as long.
Tuned tune(const Ring& ring, const TuneOptions& options = {}, std::span<const Vec3> foci = {});

/// Chooses the stride of fingers that are followed from frame to frame, the number of their foci and the dwell being
/// given: another number would move every focus. A finger's first frame decides; after that it changes no more often
/// than every `rest_s`, and only where the balance grows by `gain`, so that it does not flip between two that are about
/// as good. Allocates nothing.
class StrideTuner {
 public:
  static constexpr double gain = 0.10, rest_s = 0.5;
  static constexpr std::size_t most_fingers = 64;  ///< at a time; of more it forgets the one seen longest ago

  explicit StrideTuner(const SpectrumOptions& options = {}) : options_(options) {}

  /// The stride for finger `id`, whose foci lie on `ring`, in the frame captured at `time_s`.
  std::uint32_t stride_for(std::uint32_t id, const Ring& ring, double time_s);

  /// What an array makes of the foci that the finger had at `time_s`: it takes the place of spots from the finger's
  /// next frame on, for as long as it has so many foci. The first time that frame decides as the finger's first did. Of
  /// a finger that is not known nothing is kept.
  void learn(std::uint32_t id, const Harmonics& harmonics, double time_s);
  /// Whether that is still to be learned, or was `rest_s` ago.
  bool wants(std::uint32_t id, double time_s) const;

 private:
  struct Known {
    bool used = false;
    std::uint32_t id = 0, foci = 0, stride = 0;
    double chosen_s = 0;
    std::uint64_t seen = 0;  ///< by the counter of calls: a clock may stand still or be set back
    bool decides = false;    ///< its next frame, without resting
    Harmonics learned;
    double learned_s = 0;
  };
  const Known* find(std::uint32_t id) const;
  Known* find(std::uint32_t id);
  Known& known(std::uint32_t id);
  SpectrumOptions options_;
  std::array<Known, most_fingers> known_{};
  std::uint64_t calls_ = 0;
};

}  // namespace palpa::acoustics
