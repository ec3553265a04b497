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
#include "viewer/app/settings.hpp"
#include "viewer/app/show.hpp"
#include "viewer/app/viewer_options.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/hands/placing.hpp"
#include "viewer/hands/slice_hand.hpp"
#include "viewer/live/held_finger.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/live/loader.hpp"
#include "viewer/live/next_outputs.hpp"
#include "viewer/live/starter.hpp"
#include "viewer/live/transport.hpp"
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
  /// Ends a live run; see LiveSession. Set from outside, too.
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
  bool dirty() const { return dirty_ || (ui_ && ui_->restless()); }
  /// Until when nothing happens by itself; nothing: until somebody does something.
  std::optional<double> next_s() const;

  /// Brings `drawn` up to date; no frame that draws it may be in flight where stale().
  bool stale() const { return stale_surfaces_ || stale_skin_ || stale_marks_; }
  void update(DrawnPicture& drawn);
  struct Frame {
    std::vector<View> views;
    const Sheet* sheet = nullptr;
  };
  /// What is drawn, valid until the next call. `ratio`: pixels per point.
  Frame render(const Size& size, double ratio, double now_s);
  /// Another number where the picture's surfaces are others.
  std::uint64_t surfaces_version() const { return surfaces_version_; }
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
  const Picture& picture() const { return show_ ? std::as_const(*show_).picture() : live_picture_; }
  /// The next slot, whatever the time.
  void go_on() { desk_.asked.slots = 1; }
  /// Whether a live run has shown a frame since the last call; of anything else, always.
  bool showed_frame() { return !desk_.live || std::exchange(fresh_, false); }
  void say(log::Level level, const std::string& line, double now_s);
  bool loading() const { return live_ && live_->state() == LiveState::loading; }
  /// Whether something that was asked for is still to come: a file that is opened, a run that begins.
  bool beginning() const { return loading() || desk_.opening || restart_; }
  /// A live run falls silent and ends; false where it has not within `patience_s`, or is loading all the while.
  bool finish(double patience_s);
  /// Waits until work of `work_s` holds up no frame of a live run, at most `most_s`; returns how long that was.
  double let_run(double work_s, double most_s) { return live_ ? live_->let_run(work_s, most_s) : 0; }
  /// Of the live run that there was last, once it is over.
  std::optional<session::LoopStats> stats() const { return live_ ? live_->stats() : std::nullopt; }
  /// Throws what a live run failed with.
  void rethrow() const {
    if (live_) live_->rethrow();
  }

 private:
  Settings settings() const;
  void remember();
  void recall();
  void start();
  void advance_live(double now_s, const Size& size);
  void advance_slots(double now_s);
  void do_asked(double now_s, const Size& size);
  void key(const WindowEvent& event);
  void open(const std::string& path, double now_s);
  void open_scene(const std::string& path);
  void play_recording(double now_s);
  void advance_opening(double now_s);
  void cancel_opening();
  void record(double now_s);
  void tell_recording(double now_s);
  void tell_doing();
  void read_at(double x, double y, const Size& size);
  void show_slot_now();
  void touch_options(double now_s);
  void touch_told(double now_s);
  void switch_off();
  bool changing() const;
  /// What panels leave of a picture of that size.
  Size beside_panels(const Size& size) const;
  void reload(double now_s);
  void surfaces_changed() {
    stale_surfaces_ = dirty_ = true;
    ++surfaces_version_;
  }
  Sight sight(const Size& size) const;
  bool holds_finger() const;
  void place_anew();
  void begin_placing();
  void place();
  void show_placing(const Size& size);
  void take_placing();
  void do_placing(double now_s);
  void open_participant(bool open);
  bool participant_key(Key key);
  void switch_object(int by);
  Picture& shown_picture() { return show_ ? show_->picture() : live_picture_; }
  Sounding sounding();
  void place_slice_once();
  void turn_slice(setup::Plane plane);
  void listen(double now_s);

  ViewerOptions options_;
  Surroundings around_;
  Picture live_picture_;
  Desk desk_;
  Settings recalled_, began_;  ///< as remembered, and with what the command line says
  ViewState drawn_state_;      ///< as the picture was drawn last
  setup::Given running_;       ///< what the live run was started with, or is to be
  setup::Given copied_;        ///< what else the copied command says: what can be
  std::unique_ptr<Show> show_;
  Transport transport_;
  HeldFinger finger_;
  Placing placing_;
  std::vector<Transform> placed_;  ///< as the run has them
  std::string placed_scene_;
  bool same_scene_ = false;
  Starter starter_;  ///< of live runs: they do not give way when they begin anew either
  NextOutputs outputs_;
  std::unique_ptr<LiveSession> live_;
  std::shared_ptr<const LiveScene> scene_;
  bool off_ = false;   ///< somebody switched it off: only they start it again
  bool anew_ = false;  ///< the scene was written anew
  bool restart_ = false, told_ = false, written_ = false, framed_ = false, fresh_ = false;
  session::SlotScratch slot_;  ///< of a live run's
  Sounds sounds_;
  SliceHand slice_hand_;
  bool slice_placed_ = false;
  std::unique_ptr<Ui> ui_;
  log::Tail tail_;
  Controls controls_;
  double ratio_ = 1;
  double next_reload_s_ = 0;
  /// What is being loaded.
  struct Opened {
    std::string path;
    bool recording = false;                  ///< else a scene
    bool same = false;                       ///< it is the one that is shown, written anew
    std::optional<ViewerOptions> options{};  ///< of a touch, and what becomes of it
    std::shared_ptr<std::unique_ptr<Show>> show{};
  } opened_;
  std::unique_ptr<Loader> loader_;
  struct WrittenScene {
    std::string path;
    std::filesystem::file_time_type time;
  } scene_written_;  ///< as reload() saw it last
  std::uint64_t surfaces_version_ = 1;
  double next_slot_s_ = 0, last_render_s_ = 0, now_s_ = 0;
  bool dirty_ = true, stale_surfaces_ = true, stale_skin_ = false, stale_marks_ = false, quitting_ = false;
};

}  // namespace palpa::viewer
