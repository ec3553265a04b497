// What sounds at a moment, as values. Pictures of sound are computed from it. Also says when two of them are alike.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "acoustics/air.hpp"
#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "session/plan/plan.hpp"
#include "touch/types.hpp"

namespace palpa::viewer {

struct Sounding {
  std::shared_ptr<const array::Layout> layout;     ///< in the world; null: there is no array
  array::DriveOptions drive{};                     ///< how its drives are made
  acoustics::Air air{};                            ///< in which it sounds
  std::optional<double> spot_m{};                  ///< a spectrum's spot in place of the array's field
  const array::Schedule* schedule = nullptr;       ///< what plays; null: nothing plays
  const session::Plan* plan = nullptr;             ///< the same with its drives, if they have been made
  std::span<const array::TransducerDrive> slot{};  ///< of the slot that is shown; empty: silence
  std::optional<Transform> T_world_finger{};       ///< where the finger's mesh stands
  std::optional<Vec3> tip{};                       ///< used in its place: the finger's lowest point, world
};

/// Whether a picture of time averages cannot tell the two apart: they have the same order, gains and modulation, and
/// foci at most a thirtieth of the wavelength at 40 kHz apart.
bool alike(const array::Schedule& a, const array::Schedule& b);
inline constexpr double alike_m = 0.3e-3;

/// The lowest point of the first finger's skin that was seen, below the middle of its contacts. nullopt if nothing
/// touches.
std::optional<Vec3> tip_of(const touch::Touch& touch);

/// What changed in a picture: the skin's surface, and anything that is neither skin surface nor solid.
struct Change {
  bool skin = false, marks = false;
  Change& operator|=(const Change& other) {
    skin = skin || other.skin;
    marks = marks || other.marks;
    return *this;
  }
};

}  // namespace palpa::viewer
