// The viewer without a window. It takes events, and produces a picture and what is drawn over it. The window, scripts
// and tests all use it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "session/loop/output.hpp"
#include "viewer/app/moved_by_hand.hpp"
#include "viewer/app/opening.hpp"
#include "viewer/app/scene_watch.hpp"
#include "viewer/app/show.hpp"
#include "viewer/app/staleness.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/hands/slice_hand.hpp"
#include "viewer/live/recording_player.hpp"
#include "viewer/live/run_control.hpp"
#include "viewer/options/settings.hpp"
#include "viewer/options/viewer_options.hpp"
#include "viewer/panel_data/panel_data.hpp"
#include "viewer/panels/ui.hpp"
#include "viewer/render/drawn_picture.hpp"
#include "viewer/sound/sounds.hpp"

namespace palpa::viewer {

/// The closed mesh on which pressures are shown: `skin`, which is --skin. If that is empty, a live run (`source` is not
/// empty) uses the mesh of its made-up finger, else palpa's own. Empty: there is no mesh.
std::string finger_mesh(const std::string& skin, const std::string& source);

/// What the application needs from its caller.
struct Surroundings {
  LiveSession::Kinds kinds;
  /// Ends a live run, see LiveSession. It may also be set from outside. Never null, because a touch may become a live
  /// run.
  std::atomic<bool>* stop = nullptr;
  std::function<void()> wake;                    ///< called from other threads when something is new
  std::function<void(const std::string&)> copy;  ///< passes text to other programs
  std::function<std::string()> paste;
  /// Called before a touch becomes a live run. Empty: a touch cannot become one.
  std::function<void()> goes_live;
  bool panels = true;
  double ratio = 1;  ///< pixels per point at first
  /// The file that remembers the settings. Empty: they are not remembered.
  std::filesystem::path settings;
};

class App {
 public:
  /// Loads what is shown, except for a live run, which loads on its own threads. Throws as the engine does.
  App(const ViewerOptions& options, const Size& size, Surroundings around);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  void handle(const WindowEvent& event, const Size& size);
  /// Processes what is new at `now_s`, and does what the panels asked for.
  void advance(double now_s, const Size& size);
  bool quitting() const { return quitting_; }
  /// "cube.glb, live (mouse)": what is shown, and how.
  std::string title() const;

  /// Whether the picture has changed since the last render().
  bool dirty() const { return stale_.dirty() || (ui_ && ui_->restless()); }
  /// The time until which nothing changes by itself. nullopt: nothing changes until there is input.
  std::optional<double> next_s() const;

  /// Brings `drawn` up to date. If stale(), no frame that draws it may be in flight.
  bool stale() const { return stale_.what() != Stale::nothing; }
  void update(DrawnPicture& drawn);
  struct Frame {
    std::vector<View> views;
    const Sheet* sheet = nullptr;
  };
  /// What is drawn, valid until the next call. `ratio`: pixels per point.
  Frame render(const Size& size, double ratio, double now_s);
  /// Changes whenever the picture's surfaces change.
  std::uint64_t surfaces_version() const { return stale_.surfaces_version(); }
  /// Handles an event of the participant's window, which takes only keys.
  void handle_participant(const WindowEvent& event);
  /// Throws bad_usage if --monitor is not one of them.
  void tell_monitors(std::vector<std::string> names);
  void participant_window_failed(const std::string& fault);
  /// Warns once if the window's shape is not that of the rig's screen.
  void participant_fills(const Size& size);
  void try_participant(bool open);
  /// "save as": writes the objects as they stand now, and continues the run with that file. Shows the error if it
  /// fails.
  void save_scene(const std::string& file, double now_s);
  /// Records how long the last picture took.
  void drew(double seconds) { data_.picture_ms = seconds * 1e3; }

  /// The font of the panels; see Ui::use_font.
  void use_font(std::string ttf) {
    if (ui_) ui_->use_font(std::move(ttf));
  }
  /// The window's place is remembered for the next one.
  void window_is_at(const WindowPlace& place) { window_ = place; }

  const PanelData& data() const { return data_; }
  const Picture& picture() const { return show_ ? std::as_const(*show_).picture() : live_.picture; }
  /// Goes to the next slot, whatever the time.
  void go_on() { data_.asked.slots = 1; }
  /// Whether a live run has shown a frame since the last call. Without a live run, always true.
  bool showed_frame() { return !data_.live || std::exchange(live_.fresh, false); }
  /// Shows a line for a while. `about`: what it is about; see settled().
  void say(log::Level level, const std::string& line, double now_s, const std::string& about = {});
  bool loading() const { return run_.loading(); }
  /// Whether a live run is under way of which no frame has been shown yet.
  bool awaits_frame() const { return run_.under_way() && !live_.any; }
  /// Whether something requested is not done yet: a file is being opened, or a run is about to begin.
  bool beginning() const { return loading() || data_.opening || run_.restarts(); }
  /// Silences and ends a live run. Returns false if it has not ended within `patience_s`, or is loading all that time.
  bool finish(double patience_s);
  /// Waits, at most `most_s`, until work of `work_s` delays no frame of a live run. Returns how long it waited.
  double let_run(double work_s, double most_s) { return run_.session() ? run_.session()->let_run(work_s, most_s) : 0; }
  /// The statistics of the last live run, once it is over.
  std::optional<session::LoopStats> stats() const { return run_.session() ? run_.session()->stats() : std::nullopt; }
  /// Throws the error with which a live run failed.
  void rethrow() const {
    if (run_.session()) run_.session()->rethrow();
  }

 private:
  Settings settings() const;
  void recall();
  void handle_in_picture(const WindowEvent& event, const Size& size);
  void handle_key(const WindowEvent& event);
  void character_key(const WindowEvent& event);
  void play_or_pause();
  void close_innermost();
  void ask_to_quit();
  bool participant_key(Key key);
  void read_at(double x, double y, const Size& size);
  /// What was about this is in order again, so its lines go.
  void settled(const std::string& about);
  /// The part of a window of that size that panels and strip leave free, and its size.
  Area picture_area(const Size& size) const;
  Size beside_panels(const Size& size) const;
  Sight sight(const Size& size) const;

  void advance_log(double now_s);
  void advance_opening(double now_s);
  void advance_live(double now_s, const Size& size);
  void advance_slots(double now_s);
  void show_doing();
  void do_asked(double now_s, const Size& size);
  void do_views(const PanelData::Asked& asked, const Size& size);
  void copy_command(double now_s);
  void copy_picture(double now_s, const Size& size);

  // The run and its options.
  void begin_run();
  void change_run(LiveEdit edit, bool again = false);
  bool goes_together(const LiveEdit& edit);
  void start_run();
  void go_live(LiveEdit edit);
  void set_option(const OptionText& asked, double now_s);
  void set_touch_option(const LiveEdit& edit, const OptionText& asked);
  void frame_object(const Size& size);
  void switch_off();
  void show_link(double now_s);
  void show_recording(double now_s);
  void record(double now_s);

  // What is opened.
  void open(const std::string& path, double now_s);
  void open_again(const std::string& scene, double now_s);
  void open_scene(const std::string& path);
  void open_skin(const std::string& path, double now_s);
  void play_recording(const std::string& path);
  void remember_file(const std::string& path);
  void cancel_opening();
  void switch_object(int by);

  // What is moved by hand.
  void place();
  void show_marks(const Size& size);
  void show_placing(const Size& size);
  void show_depths(const Size& size);
  void show_reading(const Size& size);
  void take_placing();
  void do_placing(double now_s);

  // Slots and sound.
  bool changing() const;
  void show_slot_now();
  Sounding sounding();
  void place_slice_once();
  void turn_slice(setup::Plane plane);
  void listen(double now_s);

  void open_participant(bool open);
  void advance_participant(double now_s);
  Picture& shown_picture() { return show_ ? show_->picture() : live_.picture; }

  ViewerOptions options_;
  Surroundings around_;
  PanelData data_;
  SettingsMemory memory_;
  std::optional<WindowPlace> window_;
  std::unique_ptr<Show> show_;  ///< the single touch; null while there is a live run
  struct LivePicture {
    Picture picture;
    session::SlotScratch slot;
    std::string framed;  ///< the scene that the viewpoint was set to
    bool any = false;    ///< the run has shown a frame
    bool fresh = false;  ///< it has shown a frame since the last showed_frame()
  } live_;
  RecordingPlayer player_;
  MovedByHand moved_;
  RunControl run_;  ///< declared after the sources that its sessions use
  Opening opening_;
  SceneWatch scene_watch_;
  Staleness stale_;
  Sounds sounds_;
  struct Slice {
    AskedSlice asked;  ///< at first by the options; later by the user, whatever options change
    SliceHand hand;
    bool placed = false;  ///< it was given a place
  } slice_;
  std::unique_ptr<Ui> ui_;
  log::Tail tail_;
  Controls controls_;
  double ratio_ = 1;
  double next_slot_s_ = 0, last_render_s_ = 0, now_s_ = 0;
  double leave_line_until_s_ = 0;  ///< the participant's window says how to leave it
  std::string stretched_;          ///< the warning about that window's shape that was given
  double quit_asked_s_ = -1e9;     ///< when somebody wanted to quit while the array sounded
  bool held_ = false;              ///< a button was pressed in the picture and is still held down
  bool told_of_finger_ = false;    ///< the user knows what the pointer does
  bool quitting_ = false;
};

}  // namespace palpa::viewer
