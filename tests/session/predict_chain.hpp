// Rendered fingers through the whole chain: cameras, skin, contacts, foci, prediction. The truth is known, so the error
// of each slot's focus is, too.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "base/math.hpp"
#include "geometry/solid.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::test {

/// Skin in front of the paper's cameras: the finger of assets/finger.ply, unless there is another one.
struct ChainFilm {
  std::string scene;       ///< an asset's name, or "plate": a large box whose top is at y = 0
  sensing::Motion motion;  ///< of the finger, whose tip is at its origin and whose body is along +y
  double length_s = 0.4;
  double rate_hz = 90;
  sensing::Noise noise = sensing::Noise::d415;
  std::uint64_t seed = 1;
  sensing::Motion second{};  ///< of another such finger, if there is one
  const geometry::Mesh* skin = nullptr;
  /// The truth is what the same session sees in images without noise, not in the images of the film.
  bool exact_truth = false;
};

/// The pose of a finger whose tip is there.
Transform tip_at(const Vec3& tip);
/// 3 mm deep in a plate, at a steady speed.
ChainFilm sliding_film(double speed, bool along_z, double length_s);
/// A hand whose index finger points, leaning by 45 degrees, 3 mm deep in a plate, at a steady speed. The truth is
/// exact.
ChainFilm hand_film(double speed, bool along_z, double length_s);
/// Over the semi-sphere's top, 3 mm deep all the time.
ChainFilm crossing_film(double speed);
/// Rests in a plate, then leaves it at this speed upwards; downwards if that is negative.
ChainFilm lifting_film(double speed);

/// The errors of the foci of all slots.
struct ChainError {
  double mean_m = 0, p95_m = 0;
  std::size_t slots = 0;
  double late_s = 0;      ///< how long a slot sounds after the finger has left, at most
  std::size_t begun = 0;  ///< frames with more fingers that sound than are seen
  double p95_step_m = 0;  ///< how far the focus moves that moves farthest, from frame to frame
};
struct ChainErrors {
  ChainError seen, predicted;  ///< foci stay where they were seen, or not
};

/// The sound comes `late_s` after its frame: from the capture to the middle of the first slot that plays the frame.
/// Each slot's focus is compared with the place where the same session without prediction sees it at the slot's time,
/// so both count the foci from the same axis. The first `begin_s` of each touch are left out.
ChainErrors chain_errors(const ChainFilm& film, double late_s, bool on_device, double begin_s = 0.06);

/// The schedules that a session makes of a film's frames, predicted `late_s` ahead, if frame k claims to have been
/// captured at time_of(k). Without `knows_slots`, the session does not know which slot plays a frame first.
/// `distances_m` gets the distance that the session reports of each frame.
std::vector<array::Schedule> schedules_of(const ChainFilm& film, double late_s,
                                          const std::function<double(std::uint64_t)>& time_of, bool knows_slots = true,
                                          std::vector<double>* distances_m = nullptr);

}  // namespace palpa::test
