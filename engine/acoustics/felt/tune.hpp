// Chooses how many foci a finger gets and in what order they play, so that the energy of the vibration lies where skin
// is most sensitive, and little of it is felt as flutter.
//
//   balance(N, s, d) = vibration - flutter_weight flutter
//
// of N foci with stride s and dwell d, as skin feels (skin.hpp) a ring of the finger's perimeter under the array's
// focus. They are changed only if the balance grows by at least `gain` times the vibration. If candidates are equally
// good, the fewest foci win, then the smallest stride, then the longest dwell. Deterministic.
// docs/notes/vibration-and-flutter.md#what-tuning-changes has the reasons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "acoustics/felt/harmonics.hpp"
#include "acoustics/felt/spectrum.hpp"

namespace palpa::acoustics {

struct TuneOptions {
  /// Numbers of foci to try: from the ring's own number (fewer would make the shape coarser than requested) to this
  /// number, or to the ring's own number if that is larger.
  std::uint32_t most_foci = 24;
  /// Dwells to try: the ring's own or, if the longest is not 0, whole tenths of a millisecond in this range.
  double shortest_dwell_s = 0, longest_dwell_s = 0;
  double gain = 0.05;  ///< minimum growth of the balance for a change, relative to the vibration felt before
  SpectrumOptions spectrum;
};

struct Tuned {
  Ring ring;  ///< the recommended ring; strides are at most half of N, because N - s is s in reverse order
  Felt before, after;
  bool changed = false;
  FocusKind field{};  ///< how foci were modelled
};

/// A ring with fewer than 3 foci, more than most_ring_foci or without a perimeter stays unchanged. `foci` are the
/// ring's own. If the options have a field and `foci` has one for each focus of the ring, the field between them
/// counts; otherwise that of spots on a curve of the same length.
Tuned tune(const Ring& ring, const TuneOptions& options = {}, std::span<const Vec3> foci = {});

/// Chooses the stride of fingers that are followed from frame to frame. The number of foci and the dwell stay fixed,
/// because another number would move every focus. A finger's first frame decides. After that the stride changes at most
/// once every `rest_s`, and only if the balance grows by `gain`, so that it does not alternate between two similar
/// values. Allocates nothing.
class StrideTuner {
 public:
  static constexpr double gain = 0.10, rest_s = 0.5;
  static constexpr std::size_t most_fingers = 64;  ///< at a time; beyond that, the finger seen longest ago is dropped

  explicit StrideTuner(const SpectrumOptions& options = {}) : options_(options) {}

  /// The stride for finger `id`, whose foci lie on `ring`, in the frame captured at `time_s`.
  std::uint32_t stride_for(std::uint32_t id, const Ring& ring, double time_s);

  /// The harmonics of the foci that the finger had at `time_s`, in an array's field. They replace spots from the
  /// finger's next frame on, as long as it has the same number of foci. After the first learn(), that frame decides
  /// like the finger's first frame. Ignored for an unknown finger.
  void learn(std::uint32_t id, const Harmonics& harmonics, double time_s);
  /// Whether the harmonics are still to be learned, or were learned at least `rest_s` ago.
  bool wants(std::uint32_t id, double time_s) const;

 private:
  struct Known {
    bool used = false;
    std::uint32_t id = 0, foci = 0, stride = 0;
    double chosen_s = 0;
    std::uint64_t seen = 0;  ///< by the counter of calls, because a clock may stand still or be set back
    bool decides = false;    ///< its next frame decides, regardless of rest_s
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
