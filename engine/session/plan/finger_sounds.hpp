// The sound of the transducers on the fingers of a live loop: a transfer for those foci of a frame whose fingers are
// known, and the free field for all others. The planner does not know how this sound is found.
#pragma once

#include <optional>
#include <span>

#include "array/field/transfer.hpp"
#include "array/schedule.hpp"

namespace palpa::session {

class FingerSounds : public array::Transfer {
 public:
  /// Until the next call, the foci are those of this schedule. Returns whether the sound is known at any of them; if
  /// not, this transfer is the free field. Called on the thread that plans, and so is fill().
  virtual bool take(const array::Schedule& schedule) = 0;

  /// Where a focus sounds, and the phase of each transducer's sound there relative to the free field, in -pi..pi.
  struct Aimed {
    Vec3 place;
    std::span<const float> phases;
  };
  /// nullopt if the sound at this focus is not known.
  virtual std::optional<Aimed> aimed(const Vec3& focus) const = 0;
};

}  // namespace palpa::session
