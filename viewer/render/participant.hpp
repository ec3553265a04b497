// Pictures for the participant of an experiment: the objects and the marker tile, nothing of what senses and sounds.
#pragma once

#include <optional>

#include "viewer/render/offscreen.hpp"
#include "viewer/view/stereo.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

struct Participant {
  sensing::Screen screen;  ///< its eye is between the participant's
  double eyes_apart_m = 63e-3;
  Stereo stereo = Stereo::none;
  /// Of columns and rows; without them those of usual_barrier().
  std::optional<double> barrier_pitch_m{}, barrier_gap_m{};
  double barrier_phase = 0;
  bool operator==(const Participant&) const = default;
};

/// What the pixels of a picture so large are seen through.
Barrier barrier_of(const Participant& participant, std::uint32_t width, std::uint32_t height);

/// The same look with solids and tile alone; solids that are hidden stay so.
ViewState for_participant(const ViewState& state);

/// What one eye sees.
Viewpoint eye_view(const sensing::Screen& screen, const Vec3& eye, const Box& objects);

/// The screen's whole picture, of that size. `offscreen` has the one that eye_size says of it.
drawing::Pixels draw(const Participant& participant, const Box& objects, std::uint32_t width, std::uint32_t height,
                     Offscreen& offscreen, DrawnPicture& drawn);

}  // namespace palpa::viewer
