// Which content is shown, and what follows it: files that are opened, options that are set, and Start.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "viewer/app/opening.hpp"
#include "viewer/app/shown_run.hpp"
#include "viewer/sound/sounds.hpp"

namespace palpa::viewer {

/// The closed mesh on which pressures are shown: `skin`, which is --skin. If that is empty, a live run (`source` is not
/// empty) uses the mesh of its made-up finger, else palpa's own. Empty: there is no mesh.
std::string finger_mesh(const std::string& skin, const std::string& source);

class ContentControl {
 public:
  /// Calls `goes_live` before a touch becomes a live run. Without it, a touch cannot become one.
  ContentControl(const ViewerOptions& options, LiveSession::Kinds kinds, std::atomic<bool>& stop,
                 const std::function<void()>& wake, std::function<void()> goes_live, Content& content,
                 Messages& messages, Staleness& stale);
  /// Loads a touch, or begins the live run that the options say. Throws as the engine does.
  void begin();

  /// The viewer's own options. What runs has those of Content::edit.
  const ViewerOptions& options() const { return options_; }
  ShownRun& run() { return run_; }
  const ShownRun& run() const { return run_; }
  const ShownTouch* touch() const { return touch_.get(); }
  Picture& picture() { return touch_ ? touch_->picture() : run_.picture(); }
  const Picture& picture() const { return touch_ ? std::as_const(*touch_).picture() : run_.picture(); }
  Sounds& sounds() { return sounds_; }
  const Sounds& sounds() const { return sounds_; }
  void show_slot(std::uint64_t slot);
  /// `slot`: as ShownRun::sounding has it.
  Sounding sounding(std::optional<std::uint64_t> slot);
  /// "cube.glb, live (mouse)": what is shown, and how.
  std::string title() const;

  /// Takes what was opened. Returns whether it is another touch.
  bool take_opened();
  /// Opens the scene again if its file was written again.
  void watch_scene(double now_s);
  double next_watch_s() const { return watch_.next_s(); }
  /// ShownRun::look(), and what it means for the rest.
  bool look_at_run();
  /// What follows the run: the next session begins if it is ready. With `quitting`, none does.
  void follow_run(bool quitting);
  /// Updates what is being loaded and what is possible.
  void update_status();

  /// Opens a glTF, a PLY or a recording in the background, in place of what is being opened.
  void open(const std::string& path);
  /// The next or previous scene of the folder, by name.
  void open_neighbour(int by);
  /// Whether something is being opened. Content::opening shows it from the next round on.
  bool is_opening() const { return opening_.busy(); }
  void cancel_opening();
  /// Begins again, whether switched off or not. A touch becomes a live run with a finger that the pointer holds, unless
  /// another source is given.
  void start();
  /// Sets an option to the text of its field. If that is not a value of the option, everything stays as it is.
  void set_option(const OptionText& asked);
  /// Writes the objects as they stand now, and continues the run with that file. Shows the error if it fails.
  void save_scene(const std::string& file);
  /// A signal came before a session could begin.
  bool ended() const { return ended_; }

 private:
  bool shows_example();
  void begin_run();
  void change_run(LiveEdit edit, bool again = false);
  bool goes_together(const LiveEdit& edit);
  void go_live(LiveEdit edit);
  void find_touch_again(const OptionText& asked, const LiveEdit& edit);
  void open_scene(const std::string& path);
  void open_points(const std::string& path);
  void play_recording(const std::string& path);
  void remember(const std::string& path);

  ViewerOptions options_;
  std::function<void()> goes_live_;
  Content* content_;
  Messages* messages_;
  Staleness* stale_;
  std::unique_ptr<ShownTouch> touch_;  ///< null while there is a live run
  ShownRun run_;
  Opening opening_;
  SceneWatch watch_;
  Sounds sounds_;
  bool example_ = false;  ///< the touch is what an empty window shows
  bool ended_ = false;
};

}  // namespace palpa::viewer
