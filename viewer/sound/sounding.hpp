// What sounds at a moment, as values: what pictures of sound are computed from, and when two of them are alike.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "acoustics/air.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "base/math.hpp"
#include "session/links/plan.hpp"
#include "touch/types.hpp"

namespace palpa::viewer {

struct Sounding {
  std::shared_ptr<const array::Layout> layout;     ///< in the world; nothing: there is no array
  array::DriveOptions drive{};                     ///< how its drives are made
  acoustics::Air air{};                            ///< in which it sounds
  std::optional<double> spot_m{};                  ///< a spectrum's spot in the place of the array's field
  const array::Schedule* schedule = nullptr;       ///< what plays; nullptr: nothing does
  const session::Plan* plan = nullptr;             ///< the same with its drives, where somebody has made them
  std::span<const array::TransducerDrive> slot{};  ///< of the slot that is shown; none: silence
  std::optional<Transform> T_world_finger{};       ///< where the finger's mesh stands
  std::optional<Vec3> tip{};                       ///< in its place: where the finger's lowest point is, world
};

/// What a picture of time averages cannot tell apart: the same order, gains and modulation, and foci no farther away
/// than a thirtieth of the wavelength at 40 kHz.
bool alike(const array::Schedule& a, const array::Schedule& b);
inline constexpr double alike_m = 0.3e-3;

/// Where the lowest point of the first finger's skin is that was seen: above it the middle of its contacts. Nothing
/// where nobody touches.
std::optional<Vec3> tip_of(const touch::Touch& touch);

/// What changed in a picture: the skin's surface, and what is neither that nor a solid.
struct Change {
  bool skin = false, marks = false;
  Change& operator|=(const Change& other) {
    skin = skin || other.skin;
    marks = marks || other.marks;
    return *this;
  }
};

}  // namespace palpa::viewer
