// What the viewer shows, and what may follow it, as plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viewer/live/live_edit.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/live/recording_player.hpp"

namespace palpa::viewer {

/// What a live run does, and what leaves for the array.
struct RunStatus {
  LiveState state = LiveState::loading;
  std::string fault;  ///< why the run has failed
  bool sounding = false, stuck = false;
  std::uint64_t drives = 0, silent_drives = 0;
  LiveNumbers numbers;
  std::string recording;       ///< the folder that frames are written to
  std::uint64_t recorded = 0;  ///< frames written to it
  std::optional<Playback> playback;
};

/// One touch, a live run, or nothing yet.
struct Content {
  bool empty = false;  ///< nothing is open
  bool live = false;
  bool can_start = false;  ///< a run could begin
  RunStatus run;
  LiveEdit edit;                    ///< the options of the run; for a touch, those that a run of it would have
  bool opening = false;             ///< a file is being loaded in the background
  std::string doing;                ///< while something is loaded
  std::optional<double> done;       ///< the progress of that, 0..1, if it is known
  std::string made;                 ///< the folder of the newest recording that is complete
  std::string before;               ///< the source before a recording was opened; empty: there was no other
  std::vector<std::string> recent;  ///< files that were opened, the newest first
};

}  // namespace palpa::viewer
