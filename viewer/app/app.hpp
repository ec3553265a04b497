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

#include "viewer/app/content_control.hpp"
#include "viewer/app/participant_control.hpp"
#include "viewer/app/slice_placer.hpp"
#include "viewer/app/touch_guide.hpp"
#include "viewer/hands/controls.hpp"
#include "viewer/options/preferences.hpp"
#include "viewer/panels/ui.hpp"
#include "viewer/render/drawn_picture.hpp"

namespace palpa::viewer {

/// What the application needs from its caller.
struct AppHost {
  LiveSession::Kinds kinds;
  TouchGuide* guide = nullptr;  ///< of a person who is guided through the run; it takes keys, and ends the run
  /// Ends a live run, see LiveSession. It may also be set from outside. Never null, because a touch may become a live
  /// run.
  std::atomic<bool>* stop = nullptr;
  std::function<void()> wake;                    ///< called from other threads when something is new
  std::function<void(const std::string&)> copy;  ///< passes text to other programs
  std::function<std::string()> paste;
  /// Called before a touch becomes a live run. Empty: a touch cannot become one.
  std::function<void()> goes_live;
  bool panels = true;
  bool hands = true;  ///< somebody, or a script, moves the mouse
  double ratio = 1;   ///< pixels per point at first
  /// The file that remembers the settings. Empty: they are not remembered.
  std::filesystem::path settings;
};

class App {
 public:
  /// Loads what is shown, except for a live run, which loads on its own threads. Throws as the engine does.
  App(const ViewerOptions& options, const Size& size, AppHost host);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  void handle(const WindowEvent& event, const Size& size);
  /// Processes what is new at `now_s`, and does what the panels asked for.
  void advance(double now_s, const Size& size);
  bool quitting() const { return quitting_ || content_.ended(); }
  /// "cube.glb, live (mouse)": what is shown, and how.
  std::string title() const { return content_.title(); }

  /// Whether the picture has changed since the last render().
  bool dirty() const { return stale_.dirty() || data_.messages.changed() || (ui_ && ui_->restless()); }
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
  /// Opens or closes that window; shows the error if it cannot be opened.
  void try_participant(bool open);
  ParticipantControl& participant() { return participant_; }
  /// Throws bad_usage if --monitor is not one of them.
  void tell_monitors(std::vector<std::string> names) {
    participant_.tell_monitors(std::move(names), content_.options().monitor);
  }
  /// "save as", see ContentControl.
  void save_scene(const std::string& file) { content_.save_scene(file); }
  /// Records how long the last picture took.
  void drew(double seconds) { data_.picture_ms = seconds * 1e3; }

  /// The font of the panels; see Ui::use_font.
  void use_font(std::string ttf) {
    if (ui_) ui_->use_font(std::move(ttf));
  }
  /// The window's place is remembered for the next one.
  void window_is_at(const WindowPlace& place) { window_ = place; }

  const PanelData& data() const { return data_; }
  const Picture& picture() const { return content_.picture(); }
  /// Goes to the next slot, whatever the time.
  void go_on() { data_.asked.slots = 1; }
  /// Whether a live run has shown a frame since the last call. Without a live run, always true.
  bool showed_frame() { return !data_.content.live || content_.run().take_fresh(); }
  /// From now on, the picture keeps a live run's frame that it shows; its sound may still be computed, see computes().
  void hold();
  /// If the picture has a close-up, moves the view beside it, as long as no option has set the view: for a picture of
  /// its own.
  void leave_room_for_close_up(const Size& size);
  /// Whether sound that the picture shows is being computed.
  bool computes() const { return content_.sounds().busy(); }
  bool loading() const { return content_.run().control().loading(); }
  /// Whether a live run is under way and no frame of it has been shown yet.
  bool awaits_frame() const { return content_.run().control().under_way() && !content_.run().shows_frame(); }
  /// Whether something requested is not done yet: a file is being opened, or a run is about to begin.
  bool beginning() const { return loading() || data_.content.opening || content_.run().control().restarts(); }
  /// Silences and ends a live run. Returns false if it has not ended within `patience_s`, or is loading all that time.
  bool finish(double patience_s);
  /// The session of the live run, or of the last one; null if there was none.
  LiveSession* session() { return content_.run().control().session(); }

 private:
  Preferences settings() const;
  void recall();
  void handle_in_picture(const WindowEvent& event, const Size& size);
  void handle_key(const WindowEvent& event);
  void close_innermost();
  void ask_to_quit();
  bool participant_key(Key key);
  void read_at(double x, double y, const Size& size);
  /// The part of a window of that size that panels and strip leave free, and its size.
  Area picture_area(const Size& size) const;
  Size free_size(const Size& size) const;
  Sight sight(const Size& size) const;

  void advance_run(const Size& size);
  void advance_slots();
  void advance_sound();
  void leave_room_for_bars(const Size& size);
  void do_asked(const Size& size);
  void do_views(const PanelData::Asked& asked, const Size& size);
  void step_slots(int by);
  void see_framed();
  void frame_object(const Size& size);
  void switch_off();
  void open_participant();
  void copy_run();
  void copy_picture(const Size& size);
  void copy(const std::string& command);
  void show_marks(const Size& size);

  AppHost host_;
  PanelData data_;
  Staleness stale_;
  log::Tail tail_;
  PreferencesMemory memory_;
  std::optional<WindowPlace> window_;
  ContentControl content_;
  SlicePlacer slice_;
  ParticipantControl participant_;
  Controls controls_;
  std::unique_ptr<Ui> ui_;
  std::string framed_;  ///< the scene that the viewpoint was set to
  double ratio_ = 1;
  double next_slot_s_ = 0, last_render_s_ = 0, now_s_ = 0;
  double quit_asked_s_ = -1e9;  ///< when somebody wanted to quit while the array sounded
  bool held_ = false;           ///< a button was pressed in the picture and is still held down
  bool quitting_ = false;
};

}  // namespace palpa::viewer
