// The command line of palpa-viewer. Groups that `palpa` also has come from engine/setup, with the same names and
// defaults.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "line/option_table.hpp"
#include "setup/options/options.hpp"
#include "setup/options/places.hpp"
#include "setup/options/study_options.hpp"
#include "setup/sessions/live_run.hpp"
#include "setup/sessions/touch_input.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/render/renderer.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// The plane in which the field is shown, as it was asked for.
struct AskedSlice {
  std::optional<setup::Plane> plane;
  std::string at;  ///< its centre "x,y,z"; empty: the middle of the touch
  double size_m = 60e-3;
};

struct ViewerOptions : setup::EyesOptions {
  setup::CommonOptions common;
  setup::TouchInputOptions input;  ///< all of it may be absent if there is a layout
  setup::TouchOptions touch;
  setup::FeltOptions felt;
  setup::FocusingOptions drive;
  setup::LiveOptions live;  ///< what only a live run has; all of its options are in `given`
  line::Given given;        ///< the whole command line
  /// Whether frames come from a source.
  bool is_live() const { return given.contains("--source"); }
  std::string sensation;                ///< a file, or one of palpa's own; empty: none
  std::vector<std::string> parameters;  ///< of it, "NAME=VALUE"
  std::string layout;                   ///< built-in name or file; empty: the rig's array if there is a rig, else none

  std::string skin;  ///< mesh of the finger or hand, as PLY
  std::string title;
  std::string shown, hidden, opacities;  ///< layers: "cameras,depth"; with opacities "solids=0.5,skin=0.2"
  double explode = 0;
  AskedSlice slice;
  std::optional<SkinColour> heat;  ///< what colours the finger; shows the layer heat, too
  bool dark = false;
  FinePictures fine = FinePictures::automatic;
  std::uint64_t slot = 0;

  std::string view = "iso";  ///< one of view_words; "camera:NAME"
  std::string eye, target;   ///< "x,y,z"
  std::optional<Extent> frame;
  bool orthographic = false;
  bool inset = false;

  bool participant = false;
  std::string monitor;  ///< name or number of the participant's monitor; empty: the last
  std::string screen;   ///< rig whose screen is used; empty: that of --rig, else the paper's
  Stereo stereo = Stereo::none;

  bool headless = false;
  std::optional<std::uint32_t> frames;
  bool at_touch = false;
  std::string size = "1280x800";
  std::optional<double> pixel_ratio;
  std::string screenshot, video, reference;
  std::optional<double> threshold;
  std::string interact;
  bool panels = false, no_panels = false;
  bool guided = false;  ///< through a task: a sheet says what to do, and no close-up shows what touches
};

/// The part of a picture that the sheet of a guided task covers, from the left.
inline constexpr double guidance_share = 0.36;

/// Puts every option on `app`.
void add_options(CLI::App& app, ViewerOptions& options);
/// All of them, in the order of --help.
const std::vector<line::OptionInfo>& viewer_table();
/// What a command line with these options means, not checked yet. Throws bad_usage for a text that is not a value of
/// its option.
ViewerOptions options_of(const line::Given& given);
/// Whether an option of a live run also applies to a single touch.
bool is_of_touch(const line::OptionInfo& option);
/// Throws bad_usage if an option is missing, options exclude each other, or a value does not parse.
void check(const ViewerOptions& options);

struct Size {
  std::uint32_t width = 0, height = 0;  ///< pixels
  bool operator==(const Size&) const = default;
};
/// The size that --size gives.
Size picture_size(const ViewerOptions& options);
/// The fineness of pictures that nobody waits for.
Fineness fineness_without_window(const ViewerOptions& options);
/// The initial state of the view: `layers`, changed as the options say. Its viewpoint is not set yet.
ViewState first_state(const ViewerOptions& options, const Layers& layers = {});
/// Places the slice where it was asked for.
void place_slice(ViewState& state, const AskedSlice& asked, const Picture& picture);
/// The first viewpoint, for a picture of that size. Throws bad_usage for a camera that does not exist.
Viewpoint first_viewpoint(const ViewerOptions& options, const Picture& picture, const ViewState& state,
                          const Size& size);
/// The views from `viewpoint`: the whole picture, and a close-up of the touch if there is one: with --inset, and in a
/// live run if the touch is small in the picture.
std::vector<View> views_from(const Viewpoint& viewpoint, const ViewerOptions& options, const Picture& picture,
                             const Size& size, double ratio);
/// The settings for --participant. Throws bad_input for a rig without a screen.
Participant participant_of(const ViewerOptions& options);
/// What the key F frames. The first viewpoint frames it, too, unless an eye is given.
Box home_of(const ViewerOptions& options, const Picture& picture, const ViewState& state);

}  // namespace palpa::viewer
