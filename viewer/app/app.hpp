// The viewer without a window: events go in, a picture and what lies over it come out. A window, a script and
// tests stand on it alike.
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
#include "viewer/app/settings.hpp"
#include "viewer/app/show.hpp"
#include "viewer/app/staleness.hpp"
#include "viewer/app/viewer_options.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/hands/slice_hand.hpp"
#include "viewer/live/recording_player.hpp"
#include "viewer/live/run_control.hpp"
#include "viewer/panels/desk.hpp"
#include "viewer/panels/ui.hpp"
#include "viewer/render/drawn_picture.hpp"
#include "viewer/sound/sounds.hpp"

namespace palpa::viewer {

/// The closed mesh on which pressures are shown: --skin; of a live run without it, whose source is not empty, that of a
/// made-up finger or palpa's own. Empty: there is none.
std::string finger_mesh(const std::string& skin, const std::string& source);

/// What the application needs of whoever runs it.
struct Surroundings {
  LiveSession::Kinds kinds;
  /// Ends a live run; see LiveSession. Set from outside, too. Never null, since a touch may become a live run.
  std::atomic<bool>* stop = nullptr;
  std::function<void()> wake;                    ///< from other threads: something is new
  std::function<void(const std::string&)> copy;  ///< to other programs
  std::function<std::string()> paste;
  /// Called before what was a touch becomes a live run; empty: that cannot be.
  std::function<void()> goes_live;
  bool panels = true;
  /// Where settings are remembered; empty: nowhere.
  std::filesystem::path settings;
};

class App {
 public:
  /// Loads what is shown, but for a live run, which loads by itself. Throws as the engine does.
  App(const ViewerOptions& options, const Size& size, Surroundings around);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  void handle(const WindowEvent& event, const Size& size);
  /// Takes in what is new at `now_s`, and does what panels asked for.
  void advance(double now_s, const Size& size);
  bool quitting() const { return quitting_; }

  /// Whether the picture has changed since the last render().
  bool dirty() const { return stale_.dirty() || (ui_ && ui_->restless()); }
  /// Until when nothing happens by itself; nothing: until somebody does something.
  std::optional<double> next_s() const;

  /// Brings `drawn` up to date; no frame that draws it may be in flight where stale().
  bool stale() const { return stale_.what() != Stale::nothing; }
  void update(DrawnPicture& drawn);
  struct Frame {
    std::vector<View> views;
    const Sheet* sheet = nullptr;
  };
  /// What is drawn, valid until the next call. `ratio`: pixels per point.
  Frame render(const Size& size, double ratio, double now_s);
  /// Another number where the picture's surfaces are others.
  std::uint64_t surfaces_version() const { return stale_.surfaces_version(); }
  /// Of the participant's window: it takes keys alone.
  void handle_participant(const WindowEvent& event);
  /// Throws bad_usage for --monitor that is none of them.
  void tell_monitors(std::vector<std::string> names);
  void participant_window_failed(const std::string& fault);
  void try_participant(bool open);
  /// "save as": the objects as they stand now, and the run goes on with that file. Says what is wrong with it.
  void save_scene(const std::string& file, double now_s);
  /// How long that took, for those who want to know.
  void drew(double seconds) { desk_.picture_ms = seconds * 1e3; }

  const Desk& desk() const { return desk_; }
  const Picture& picture() const { return show_ ? std::as_const(*show_).picture() : live_.picture; }
  /// The next slot, whatever the time.
  void go_on() { desk_.asked.slots = 1; }
  /// Whether a live run has shown a frame since the last call; of anything else, always.
  bool showed_frame() { return !desk_.live || std::exchange(live_.fresh, false); }
  void say(log::Level level, const std::string& line, double now_s);
  bool loading() const { return run_.loading(); }
  /// Whether something that was asked for is still to come: a file that is opened, a run that begins.
  bool beginning() const { return loading() || desk_.opening || run_.restarts(); }
  /// A live run falls silent and ends; false where it has not within `patience_s`, or is loading all the while.
  bool finish(double patience_s);
  /// Waits until work of `work_s` holds up no frame of a live run, at most `most_s`; returns how long that was.
  double let_run(double work_s, double most_s) { return run_.session() ? run_.session()->let_run(work_s, most_s) : 0; }
  /// Of the live run that there was last, once it is over.
  std::optional<session::LoopStats> stats() const { return run_.session() ? run_.session()->stats() : std::nullopt; }
  /// Throws what a live run failed with.
  void rethrow() const {
    if (run_.session()) run_.session()->rethrow();
  }

 private:
  Settings settings() const;
  void recall();
  void handle_key(const WindowEvent& event);
  bool participant_key(Key key);
  void read_at(double x, double y, const Size& size);
  /// What panels leave of a picture of that size.
  Size beside_panels(const Size& size) const;
  Sight sight(const Size& size) const;

  void advance_log(double now_s);
  void advance_opening(double now_s);
  void advance_live(double now_s, const Size& size);
  void advance_slots(double now_s);
  void show_doing();
  void do_asked(double now_s, const Size& size);
  void copy_command(double now_s);

  // The run and its options.
  void begin_run();
  void change_run(LiveEdit edit, bool again = false);
  bool goes_together(const LiveEdit& edit);
  void start_run();
  void set_option(const OptionText& asked, double now_s);
  void switch_off();
  void show_link(double now_s);
  void show_recording(double now_s);
  void record(double now_s);

  // What is opened.
  void open(const std::string& path, double now_s);
  void open_scene(const std::string& path);
  void play_recording(const std::string& path);
  void cancel_opening();
  void switch_object(int by);

  // What is moved by hand.
  void place();
  void show_placing(const Size& size);
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
  Picture& shown_picture() { return show_ ? show_->picture() : live_.picture; }

  ViewerOptions options_;
  Surroundings around_;
  Desk desk_;
  SettingsMemory memory_;
  std::unique_ptr<Show> show_;  ///< what is touched once; none while there is a live run
  struct LivePicture {
    Picture picture;
    session::SlotScratch slot;
    bool framed = false;  ///< the viewpoint was set to its first scene
    bool fresh = false;   ///< it has shown a frame since somebody asked
  } live_;
  RecordingPlayer player_;
  MovedByHand moved_;
  RunControl run_;  ///< after the sources that its sessions use
  Opening opening_;
  SceneWatch scene_watch_;
  Staleness stale_;
  Sounds sounds_;
  struct Slice {
    SliceHand hand;
    bool placed = false;  ///< it was put somewhere
  } slice_;
  std::unique_ptr<Ui> ui_;
  log::Tail tail_;
  Controls controls_;
  double ratio_ = 1;
  double next_slot_s_ = 0, last_render_s_ = 0, now_s_ = 0;
  bool quitting_ = false;
};

}  // namespace palpa::viewer
