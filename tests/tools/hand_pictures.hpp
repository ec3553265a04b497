// A picture of a hand of hand_rates, to see that it is what its class says.
#pragma once

#include <filesystem>

#include "hand_classes.hpp"

namespace palpa::test {

/// Draws what the cameras see in the middle of the film, around the origin, side by side: nearer skin is lighter, skin
/// inside a solid is blue, and true contacts have a colour for each part. A second row shows the first camera's view at
/// four other times. Writes a PNG.
void draw_hand(const RatedHand& hand, const std::filesystem::path& file);

}  // namespace palpa::test
