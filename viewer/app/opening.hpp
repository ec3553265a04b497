// Opens files in the background while the picture stays, and notices when a scene was written again.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "setup/sessions/scene_reload.hpp"
#include "viewer/app/shown_touch.hpp"
#include "viewer/live/loader.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// What was loaded, or why loading failed.
struct Opened {
  enum class Kind {
    scene,      ///< of a live run: the file was found to be a scene
    touch,      ///< a scene with a single touch, see `touch`
    recording,  ///< the folder was found to be a recording
  };
  Kind kind = Kind::scene;
  std::string path;
  bool same = false;    ///< it is the scene that was shown, written again
  std::string fault{};  ///< empty if there is none
  std::unique_ptr<ShownTouch> touch{};
  std::optional<ViewerOptions> options{};  ///< that `touch` was made from
};

/// Opens one thing at a time. A new one replaces the one under way.
class Opening {
 public:
  /// `wake` is called on another thread when something was loaded or failed to load.
  explicit Opening(std::function<void()> wake) : loader_(std::move(wake)) {}

  /// Begins to load the scene of these options. `same`: it is the scene that runs.
  void begin_scene(const setup::LiveOptions& options, bool same);
  /// The same for a touch, with everything that is shown of it.
  void begin_touch(const ViewerOptions& options, bool same);
  void begin_recording(const std::string& path);
  void cancel() { loader_.cancel(); }
  bool busy() const { return loader_.busy(); }
  /// The result of the load that began last, returned once.
  std::optional<Opened> take();

 private:
  Opened opened_;
  std::shared_ptr<std::unique_ptr<ShownTouch>> touch_;  ///< the loader's thread leaves its result here
  Loader loader_;
};

/// Notices that the files of a scene have been written again.
class SceneWatch {
 public:
  /// Looks at the files, at most once a second. Returns true if they were written again and have not changed since the
  /// look before, because editors write in several steps. Returns false for an empty name, and for another file than at
  /// the last look, whose earlier state is not known.
  bool look(const std::string& file, double now_s);
  /// When to look again, on the clock of `now_s`.
  double next_s() const { return next_s_; }

 private:
  std::string file_;
  setup::SceneState state_{};
  bool unsettled_ = false;  ///< it was written since the look before
  double next_s_ = 0;
};

}  // namespace palpa::viewer
