// Ends a live run: on signals while there is one, and however the program ends. That includes an exit() within a
// library, such as Xlib's when its server is gone.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "base/log.hpp"
#include "setup/process/interrupt.hpp"
#include "viewer/app/app.hpp"

namespace palpa::viewer {

class Stopper {
 public:
  /// For a live run, signals and exit() end it from now on, and nothing waits for the reader of the log. `wake` is
  /// called on another thread when a signal has come.
  explicit Stopper(const ViewerOptions& options, std::function<void()> wake = {});

  /// Call when a touch has become a live run: the same applies from now on.
  void begin();

  std::atomic<bool>& flag() { return setup::Interrupt::flag(); }

  /// Ends the run. If it does not end (a camera, a disk or a GPU does not answer), the program ends all the same. Its
  /// last line says what is known of the array's sound. A run that is still loading has nothing to silence and is not
  /// waited for. Throws what the run failed with, so that the program ends as `palpa run` does. Throws failure if only
  /// --interact or --frames ended the run while it was loading, because they have shown nothing of it.
  void end(App& app);

 private:
  std::function<void()> wake_;
  bool scripted_, windowed_;
  std::optional<log::Relay> relay_;
  std::optional<setup::Interrupt> interrupt_;
};

/// From now on, exit() within a library silences the runs under way before the program ends.
void silence_at_exits();

/// Ends the run with its scope. It must be made after everything that takes part in drawing, so that after an error the
/// array is silenced before anything waits for a device.
class SilentEnd {
 public:
  explicit SilentEnd(std::atomic<bool>& stop) : stop_(&stop) {}
  ~SilentEnd() { *stop_ = true; }
  SilentEnd(const SilentEnd&) = delete;
  SilentEnd& operator=(const SilentEnd&) = delete;

 private:
  std::atomic<bool>* stop_;
};

}  // namespace palpa::viewer
