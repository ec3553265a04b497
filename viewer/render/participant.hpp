// Pictures for the participant of an experiment: the objects and the marker tile, without sensors and array.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "setup/options/study_options.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/view/stereo.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

struct Participant {
  sensing::Screen screen;  ///< its eye is the point between the participant's eyes
  double eyes_apart_m = 63e-3;
  Stereo stereo = Stereo::none;
  /// For columns and rows. By default, those of default_barrier().
  std::optional<double> barrier_pitch_m{}, barrier_gap_m{};
  double barrier_phase = 0;
  bool operator==(const Participant&) const = default;
};

/// Somebody before the screen of the rig in this file, or of the paper's if the name is empty. Throws bad_input for a
/// rig without a screen; `advice` ends the message.
Participant participant_before(const std::string& rig, const std::string& advice, const setup::EyesOptions& eyes,
                               Stereo stereo);

/// The barrier through which the pixels of a picture of that size are seen.
Barrier barrier_of(const Participant& participant, std::uint32_t width, std::uint32_t height);

/// The same state with only solids and tile. Hidden solids stay hidden.
ViewState for_participant(const ViewState& state);

/// What one eye sees.
Viewpoint eye_view(const sensing::Screen& screen, const Vec3& eye, const Box& objects);

/// A warning if a picture of that size has another shape than the screen, so that the screen stretches it; else empty.
std::string stretched(const sensing::Screen& screen, std::uint32_t width, std::uint32_t height);

/// Writes a line of text over the top of the picture.
void write_line(drawing::Pixels& picture, std::string_view text, double ratio);

/// The screen's whole picture, of that size. `offscreen` must have the size that eye_size gives for it.
drawing::Pixels draw(const Participant& participant, const Box& objects, std::uint32_t width, std::uint32_t height,
                     Offscreen& offscreen, DrawnPicture& drawn);

}  // namespace palpa::viewer
