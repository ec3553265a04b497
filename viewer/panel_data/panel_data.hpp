// Everything that the panels show, change and ask for, as plain values. The application fills the first part before
// each picture. The panels change the second part. The application does what the third part asks for.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "setup/options/places.hpp"
#include "viewer/hands/placing.hpp"
#include "viewer/panel_data/content.hpp"
#include "viewer/panel_data/file_list.hpp"
#include "viewer/panel_data/guidance.hpp"
#include "viewer/panel_data/messages.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// A file that is offered by name.
struct NamedFile {
  std::string name, path;
};

/// How deep a finger is in a solid.
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

/// Where a part of the panels was drawn, in pixels.
struct Area {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool holds(double x, double y) const { return x >= left && x < right && y >= top && y < bottom; }
};

struct PanelData {
  // ---- shown -------------------------------------------------------------------------------------------------------
  const Picture* picture = nullptr;
  Content content;
  Messages messages;
  double picture_ms = 0;  ///< to draw the last picture
  std::optional<Reading> reading;
  std::vector<Depth> depths;                 ///< of the fingers of a live run
  std::vector<FlatMark> marks;               ///< over the picture
  std::optional<Guidance> guidance;          ///< of a task through which the user is guided
  std::vector<acoustics::Spectrum> spectra;  ///< of each finger, while wanted
  std::vector<NamedFile> objects, rigs;      ///< palpa's own
  std::vector<std::string> layouts;          ///< built-in

  // ---- changed -----------------------------------------------------------------------------------------------------
  ViewState state;
  Placing* placing = nullptr;            ///< what is moved by hand in a live run
  std::string moved_file = "moved.glb";  ///< to save it to
  /// What the participant's window shows, and where.
  struct ParticipantWindowState {
    bool open = false;                   ///< shown
    bool says_how_to_leave = false;      ///< shown
    std::vector<std::string> monitors;   ///< shown
    std::size_t monitor = 0;             ///< index into these
    bool hidden = false;                 ///< the objects; the marker tile stays
    std::optional<Participant> setting;  ///< set once the window was open
  } participant;
  bool panels = true;
  bool help = false;
  bool wants_spectrum = false;           ///< the spectrum is being looked at
  std::map<std::string, bool> headings;  ///< those that the user has folded (false) or unfolded
  std::optional<double> ceiling;         ///< while its slider is held
  /// A widget that is being dragged.
  struct Drag {
    std::string name;
    double before = 0;       ///< its value when the drag began
    bool cancelled = false;  ///< set by the application: the widget gives that value back
  };
  std::optional<Drag> drag;
  std::optional<FilePicker> picker;  ///< while a file is being chosen

  // ---- asked for ---------------------------------------------------------------------------------------------------
  struct Asked {
    bool all_off = false, start = false, frame = false, frame_touch = false;
    std::optional<StandardView> view;
    std::optional<setup::Plane> plane;   ///< for the field, through the touch
    bool copy = false;                   ///< the run, as a command line for other programs
    bool copy_picture = false;           ///< the picture, as a command line
    std::string open;                    ///< a file or folder to be opened
    std::vector<OptionText> options;     ///< to be set as their fields say
    std::optional<Playback> play;        ///< how the recording is to play; its place is ignored
    std::optional<std::uint64_t> go_to;  ///< go to this frame of the recording
    bool cancel = false;                 ///< cancel what is being opened
    bool record = false;                 ///< begin or end recording
    bool save_scene = false;             ///< save what was moved
    std::optional<bool> participant;     ///< open or close the participant's window
    int step = 0;                        ///< frames of the recording
    int slots = 0;                       ///< slots of the schedule to go on by
  } asked;

  // ---- where the panels of the last picture were -------------------------------------------------------------------
  struct Places {
    std::optional<Area> all_off, start, ceiling;  ///< on the strip at the top
    bool list = false;                            ///< a list has dropped down
    std::vector<Area> texts;                      ///< fields where text is typed
    std::map<std::string, Area> named;            ///< widgets that scripts and tests look for, by their names
  } places;
};

}  // namespace palpa::viewer
