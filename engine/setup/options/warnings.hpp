// Warnings of values that are possible but probably not intended. Each function writes one line of warning.
#pragma once

#include <span>
#include <string>

#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "base/math.hpp"
#include "geometry/solid.hpp"
#include "sensing/surroundings.hpp"
#include "session/session.hpp"
#include "setup/options/options.hpp"

namespace palpa::setup {

/// A focus that lasts longer than this is felt as a jump from place to place, seconds.
inline constexpr double longest_usual_dwell_s = 50e-3;

/// For --dwell, and for solids with their own dwell.
void warn_of_dwell(const TouchOptions& options);
void warn_of_dwell(std::span<const geometry::Solid> solids);

/// For solids whose clicks and textures are not felt as intended: a click that stands out only after silence, slots
/// that are too long for their frequencies, and gains that do not change from slot to slot.
void warn_of_feel(const session::Session& session);

/// For solids in what is probably another unit than metres.
void warn_of_size(std::span<const geometry::Solid> solids);

/// For a drive frequency for which the layout's transducers are not made, or which its boards do not emit.
void warn_of_frequency(const array::Layout& layout, const array::Medium& medium);
/// The same for drives that are played: throws bad_usage for a frequency that the layout's boards do not emit.
void check_frequency(const array::Layout& layout, const array::Medium& medium);
/// Throws bad_usage if foci stand still and are modulated, and the session's slots are too long for that. For drives
/// that a link gets slot by slot.
void refuse_coarse_modulation(const session::Session& session);
/// The same for slots of that length.
void refuse_coarse_modulation(double slot_s, double hz);

/// Throws bad_usage, naming `what`, for a place at a transducer or farther than 100 m away.
void refuse_place(const array::Layout& layout, const Vec3& place, const std::string& what);

/// For solids on which every focus would be out of the array's reach. All values are in the world.
void warn_of_reach(const array::Layout& layout, std::span<const geometry::Solid> solids);

/// For the first solid that reaches into a board or into the screen, where points are no skin. All values are in the
/// world.
void warn_of_surroundings(const sensing::Surroundings& surroundings, std::span<const geometry::Solid> solids);

/// The line of a summary if a focus has more pressure than array::linear_pressure_pa.
std::string linear_line();

}  // namespace palpa::setup
