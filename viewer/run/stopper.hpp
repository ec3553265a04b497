// What ends a live run: signals while there is one, and the end of the program, whatever that is: an exit() within a
// library, too, as Xlib's where its server is gone.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "base/log.hpp"
#include "setup/interrupt.hpp"
#include "viewer/app/app.hpp"

namespace palpa::viewer {

class Stopper {
 public:
  /// Of a live run: signals and exit() end it from now on, and nobody waits for whoever reads the log. `wake` is called
  /// on another thread when a signal has come.
  explicit Stopper(const ViewerOptions& options, std::function<void()> wake = {});

  /// What was none has become a live run: from now on.
  void begin();

  std::atomic<bool>& flag() { return setup::Interrupt::flag(); }

  /// Ends the run. Where it does not end (a camera, a disk or a GPU that does not answer) the program does: the array
  /// is silent by then, see session/loop/loop.hpp. What is still loading has nothing to silence and is not waited for.
  /// Throws what the run failed with, so that the program ends as `palpa run` does, and failure where nobody but
  /// --interact or --frames ended it while it was loading: they have shown nothing of it.
  void end(App& app);

 private:
  std::function<void()> wake_;
  bool scripted_, windowed_;
  std::optional<log::Relay> relay_;
  std::optional<setup::Interrupt> interrupt_;
};

/// Ends the run with its scope. Made after all that takes part in drawing, so that an error's way out silences the
/// array before it waits for a device.
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
