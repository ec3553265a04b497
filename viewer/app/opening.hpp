// What is opened beside what is shown: files that are dropped, scenes that are written again, recordings that are made.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "viewer/app/show.hpp"
#include "viewer/app/viewer_options.hpp"
#include "viewer/live/loader.hpp"

namespace palpa::viewer {

/// What has been loaded, or why it was not.
struct Opened {
  enum class Kind {
    scene,      ///< of a live run: it was found to be one
    touch,      ///< a scene that is touched once: `show`
    recording,  ///< it was found to be one
  };
  Kind kind = Kind::scene;
  std::string path;
  bool same = false;                     ///< it is the one that was shown, written again
  std::string fault{};                   ///< empty where there is none
  std::unique_ptr<Show> show{};          ///< of a touch
  std::optional<ViewerOptions> touch{};  ///< what it was made of
};

/// One thing at a time; what begins takes the place of what is under way.
class Opening {
 public:
  /// `wake` is called on another thread when something is loaded, or failed to be.
  explicit Opening(std::function<void()> wake) : loader_(std::move(wake)) {}

  /// The scene of these options; `same`: the one that runs.
  void begin_scene(const setup::LiveOptions& options, bool same);
  /// The same of a touch, with all that is shown of it.
  void begin_touch(const ViewerOptions& options, bool same);
  void begin_recording(const std::string& path);
  void cancel() { loader_.cancel(); }
  bool busy() const { return loader_.busy(); }
  /// Of what began last, once.
  std::optional<Opened> take();

 private:
  Opened opened_;
  std::shared_ptr<std::unique_ptr<Show>> show_;  ///< where the loader's thread leaves it
  Loader loader_;
};

}  // namespace palpa::viewer
