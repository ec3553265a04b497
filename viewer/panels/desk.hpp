// What lies on the viewer's desk: all that its panels show, change and ask for, as plain values. The application fills
// the first part before a picture, panels change the second, and the application does what the third asks for.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "base/log.hpp"
#include "setup/places.hpp"
#include "viewer/hands/gizmo.hpp"
#include "viewer/live/live_edit.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/live/recording_player.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// A line that is shown for a while, whatever else is open.
struct Toast {
  std::string text;
  log::Level level = log::Level::info;
  double until_s = 0;  ///< on the application's clock
};

/// How far a finger is in.
struct Depth {
  std::string solid;
  double depth_m = 0;  ///< of its deepest skin point
};

/// What was found under the pointer.
struct Reading {
  std::string what;
  Vec3 at{};
  std::optional<double> depth_m;  ///< inside a solid, positive inside; of a contact
};

/// Where something of the panels was drawn, pixels.
struct Area {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool holds(double x, double y) const { return x >= left && x < right && y >= top && y < bottom; }
};

/// What the field of an option says, see LiveEdit::set.
struct OptionText {
  std::string option;
  std::optional<std::string> text;  ///< nothing: as usual
};

struct Desk {
  // ---- shown -------------------------------------------------------------------------------------------------------
  const Picture* picture = nullptr;
  bool live = false;
  LiveState live_state = LiveState::loading;
  bool sounding = false, link_open = false;
  std::uint64_t drives = 0, silent_drives = 0;
  std::string doing;           ///< while something is loaded
  std::optional<double> done;  ///< of that, 0..1, where somebody counts
  bool opening = false;        ///< a scene is loaded beside what is shown
  std::string recording;       ///< the folder that frames are written to
  std::uint64_t recorded = 0;  ///< of them
  LiveNumbers numbers;
  std::optional<Playback> playback;
  double picture_ms = 0;  ///< to draw the last picture
  std::deque<log::Line> log;
  std::deque<Toast> toasts;
  std::optional<Reading> reading;
  std::vector<Depth> depths;                 ///< of the fingers of a live run
  std::vector<FlatMark> marks;               ///< over the picture
  std::vector<acoustics::Spectrum> spectra;  ///< of each finger, while wanted
  LiveEdit edit;                             ///< the options of the run; of a touch those that a run of it would have

  // ---- changed -----------------------------------------------------------------------------------------------------
  ViewState state;
  /// What is moved by hand.
  struct Placed {
    std::vector<std::string> things;                   ///< shown: solids, then the finger that is held
    std::optional<Vec3> tip;                           ///< shown: of the finger that is held, world
    bool moved = false;                                ///< shown: a solid is elsewhere than in its scene
    std::optional<std::size_t> chosen;                 ///< of the things: has handles
    bool follows = true;                               ///< the finger goes where the pointer goes
    std::string file = "moved.glb";                    ///< to save to
    bool undo = false, restore = false, save = false;  ///< asked for
  } placed;
  /// What the participant's window shows, and where.
  struct ParticipantWindowState {
    bool open = false;                   ///< shown
    std::vector<std::string> monitors;   ///< shown
    std::size_t monitor = 0;             ///< of these
    bool hidden = false;                 ///< the objects; the marker tile stays
    std::optional<Participant> setting;  ///< once it was open
  } participant;
  bool panels = true;
  bool help = false;
  bool wants_spectrum = false;  ///< somebody looks at it

  // ---- asked for ---------------------------------------------------------------------------------------------------
  struct Asked {
    bool all_off = false, start = false, frame = false;
    std::optional<StandardView> view;
    std::optional<setup::Plane> plane;   ///< the field's, through the touch
    bool copy = false;                   ///< the run, as a command line for other programs
    std::vector<OptionText> options;     ///< to be as their fields say
    std::optional<Playback> play;        ///< the recording is to play like that; its place is of no account
    std::optional<std::uint64_t> go_to;  ///< a frame of it
    bool cancel = false;                 ///< what is opening
    bool record = false;                 ///< to begin, or to end
    std::optional<bool> participant;     ///< whose window is to open, or to close
    int step = 0;                        ///< frames of it
    int slots = 0;                       ///< slots of the schedule
  } asked;

  // ---- where the panels of the last picture were -------------------------------------------------------------------
  struct Places {
    std::optional<Area> all_off;  ///< the button
    std::vector<Area> texts;      ///< fields where text is typed
  } places;
};

}  // namespace palpa::viewer
