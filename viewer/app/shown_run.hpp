// What runs: the live session that is shown, the things that hands have moved in it, and its picture.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/loop/output.hpp"
#include "viewer/app/staleness.hpp"
#include "viewer/hands/placing.hpp"
#include "viewer/live/held_finger.hpp"
#include "viewer/live/recording_player.hpp"
#include "viewer/live/run_control.hpp"
#include "viewer/panel_data/content.hpp"
#include "viewer/panel_data/messages.hpp"
#include "viewer/sound/sounding.hpp"

namespace palpa::viewer {

class ShownRun {
 public:
  /// `kinds`, `stop`, `wake`: see RunControl. Writes to the others, which must outlive it.
  ShownRun(LiveSession::Kinds kinds, std::atomic<bool>& stop, std::function<void()> wake, RunStatus& status,
           Messages& messages, Staleness& stale);

  RunControl& control() { return control_; }
  const RunControl& control() const { return control_; }
  RecordingPlayer& player() { return player_; }
  Placing& placing() { return placing_; }
  const Placing& placing() const { return placing_; }
  Picture& picture() { return picture_; }
  const Picture& picture() const { return picture_; }

  /// Begins the session that is ready. Returns false after a signal, which lets nothing begin. Throws bad_usage if the
  /// options do not go together, and warns about unusual ones.
  bool begin();
  /// Takes what is new, and the scene. Returns whether the scene has just become available: the picture is of the scene
  /// alone until show_frame(). There must be a session.
  bool look();
  /// Shows the frame that look() took, if there was one. `depth`: with the cameras' images.
  void show_frame(std::uint64_t slot, bool depth);
  /// From now on, the picture keeps the frame that it shows, and what sounded then, also beyond the run's end.
  void hold() { held_ = true; }
  /// Sees how the session ended. Returns whether the next one is ready to begin.
  bool follow();

  void show_slot(std::uint64_t slot);
  /// What sounds. `slot`: with the drive of that slot.
  Sounding sounding(std::optional<std::uint64_t> slot);
  /// Moves things to where hands have put them, where they are felt and seen. They stay there in another run of the
  /// same scene.
  void place();
  /// Call when the moved things have been saved: a run of that file moves nothing, whatever its name.
  void forget_places() { placed_scene_.clear(); }
  /// Begins or ends a recording of the frames into a new folder.
  void record();
  /// The folder of a recording that has just ended with frames in it, returned once; else empty.
  std::string take_made() { return std::exchange(made_, {}); }
  /// Whether a frame of this session has been shown, or one has since the last call.
  bool shows_frame() const { return any_; }
  bool take_fresh() { return std::exchange(fresh_, false); }

 private:
  bool holds_finger() const { return HeldFinger::is_held(control_.options().source); }
  void see_recording();
  void follow_messages();

  RunStatus* status_;
  Messages* messages_;
  Staleness* stale_;
  Picture picture_;
  session::SlotScratch scratch_;
  RecordingPlayer player_;
  HeldFinger finger_;
  Placing placing_;
  std::vector<Transform> placed_;  ///< the solids' poses in the run
  std::string placed_scene_;       ///< the scene that they belong to; empty: none
  RunControl control_;             ///< declared after the sources that its sessions use
  std::string made_;
  bool new_frame_ = false;       ///< look() took a snapshot, or what the cameras saw
  bool held_ = false;            ///< no other frame is shown
  bool any_ = false;             ///< the session has shown a frame
  bool fresh_ = false;           ///< a frame was shown since the last take_fresh()
  bool told_of_finger_ = false;  ///< the user knows what the pointer does
};

}  // namespace palpa::viewer
