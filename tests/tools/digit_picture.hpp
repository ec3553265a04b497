// What depth cameras see of one digit of a hand of hand_rates, with the sensor's noise and without.
#pragma once

#include <filesystem>

#include "hand_classes.hpp"

namespace palpa::test {

/// Draws the digit that palpa counts wrong (by the column `fair` of hand_rates), in the middle one of the frames in
/// which it does. If it counts all right: the digit whose skin is nearest to the surface, in the last frame. The two
/// cameras with the most pixels of it are shown, one below the other. Writes a PNG.
void draw_digit(const RatedHand& hand, const char* name, const std::filesystem::path& file);

}  // namespace palpa::test
