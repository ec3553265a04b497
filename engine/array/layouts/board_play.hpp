// What the boards of an array play of its drives: their transducers have a limited number of amplitudes
// (layouts/board_types.hpp).
//
//   c   the run's ceiling, and the loudest amplitude of the drive if that is less
//   a   a transducer's amplitude, with the ceiling
//   f   its factor, from its board's own file (Layout::factors)
//
// It plays the step nearest to a f that is not above c f. If the board's n transducers are only on or off, those whose
// turn in its record is below floor(c n) are on, at amplitude 1, unless the drive has them silent. A drive whose
// loudest amplitude is below the first step is silence.
//
// No transducer is above its ceiling. Because the nearest step may be the higher one, the sound at a focus may be
// louder than that of the exact drive: by up to 26 % if an OpenMPD board plays only its first step. Drives whose
// fingers request a pressure are therefore rounded by RequestedPlay (requested_play.hpp). Transducers of a layout that
// belong to no board play what they are asked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::array {

class BoardPlay {
 public:
  explicit BoardPlay(const Layout& layout);

  /// Rounds amplitudes in place, to those on the wire. `drive` has an entry for each transducer of the layout.
  /// Allocates nothing.
  void round(std::span<TransducerDrive> drive, double ceiling) const;
  /// Fills `amplitudes` with what is played of the drive times `factor`, if c is the ceiling, however loud the drive.
  void play(std::span<const TransducerDrive> drive, float factor, double ceiling, std::span<float> amplitudes) const;

  /// The least amplitude at which some board sounds, and the type of that board. 0 and null if the layout has no board;
  /// infinite if the factors of all transducers are 0.
  double least() const { return least_; }
  /// The same for messages: rounded up, so that it sounds.
  double least_to_say() const;
  const BoardType* finest() const { return finest_; }
  /// Whether the transducers have factors.
  bool has_factors() const { return !factors_.empty(); }
  /// Whether a drive with this loudest amplitude sounds, as far as that does not depend on which transducers it leaves
  /// out.
  bool sounds_at(double loudest) const;

 private:
  struct Part {
    std::uint32_t first, count;
    const BoardType* type;
    const AmplitudeSteps* steps;
  };
  template <typename Amplitude, typename Set>
  void play_part(const Part& part, float loudest, float most, const Amplitude& amplitude, const Set& set) const;

  std::vector<Part> parts_;
  std::vector<float> factors_;
  double least_ = 0;
  const BoardType* finest_ = nullptr;
};

}  // namespace palpa::array
