// Draws the two windows of a study as pictures, and says which button is where. The same values give the same pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "drawing/png.hpp"
#include "viewer/study/views.hpp"

namespace palpa::viewer {

/// Pixels, from the top left.
struct ButtonPlace {
  std::uint32_t left = 0, top = 0, right = 0, bottom = 0;
};

/// The buttons of a window of that size.
std::vector<ButtonPlace> button_places(const ParticipantView& view, std::uint32_t width, std::uint32_t height);
std::vector<ButtonPlace> button_places(const ExperimenterView& view, std::uint32_t width, std::uint32_t height);
/// The one at a place.
std::optional<std::size_t> button_at(const std::vector<ButtonPlace>& places, double x, double y);

/// Text and buttons on a dark ground; if there is one, over and under `scene`, a picture of that size.
drawing::Pixels draw(const ParticipantView& view, std::uint32_t width, std::uint32_t height,
                     const drawing::Pixels* scene = nullptr);
drawing::Pixels draw(const ExperimenterView& view, std::uint32_t width, std::uint32_t height);

}  // namespace palpa::viewer
