// What the boards of an array play of its drives: their transducers have a limited number of amplitudes
// (layouts/board_types.hpp).
//
//   ceiling c   the run's ceiling, and the loudest amplitude of the drive if that is less
//   a           a transducer's amplitude, with the ceiling
//
// It plays the step nearest to a that is not above c. With Round::down, it plays the highest step that is not above a.
// If the board's n transducers are only on or off, those whose turn in its record is below floor(c n) are on, at
// amplitude 1, unless the drive has them silent. With Round::down, they are fewer, so that their sum is less than the
// drive's. A drive whose loudest amplitude is below the first step is silence.
//
// The sound of a drive at its foci is therefore never more than at the ceiling, and with Round::down, that of a single
// focus is never more than the drive asks for. Transducers of a layout that belong to no board play what they are
// asked.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::array {

enum class Round { nearest, down };

class BoardPlay {
 public:
  explicit BoardPlay(const Layout& layout);

  /// Rounds amplitudes in place. `drive` has an entry for each transducer of the layout. Allocates nothing.
  void round(std::span<TransducerDrive> drive, double ceiling, Round how) const;

  /// The least amplitude at which some board sounds, and the type of that board. 0 and null if the layout has no board.
  double least() const { return least_; }
  /// The same for messages: rounded up, so that it sounds.
  double least_to_say() const;
  const BoardType* finest() const { return finest_; }
  /// Whether a drive with this loudest amplitude sounds, as far as that does not depend on which transducers it leaves
  /// out.
  bool sounds_at(double loudest) const;

 private:
  struct Part {
    std::uint32_t first, count;
    const BoardType* type;
    const AmplitudeSteps* steps;
  };
  std::vector<Part> parts_;
  double least_ = 0;
  const BoardType* finest_ = nullptr;
};

}  // namespace palpa::array
