#include "viewer/run/stopper.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "setup/process/ending.hpp"

namespace palpa::viewer {
namespace {

using namespace std::chrono_literals;

/// Called within exit(): the threads of a run under way must not sound on, and must not use what exit() destroys.
void silence_at_exit() {
  if (!LiveSession::under_way()) return;
  setup::Interrupt::flag() = true;
  const auto until = std::chrono::steady_clock::now() + 1s;
  while (LiveSession::under_way() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(5ms);
  if (setup::decide_ending(Exit::failed)) setup::tell_ending("a library has ended palpa");
  ::_exit(static_cast<int>(Exit::failed));
}

}  // namespace

void silence_at_exits() {
  [[maybe_unused]] static const int registered = std::atexit(silence_at_exit);
}

Stopper::Stopper(const ViewerOptions& options, std::function<void()> wake)
    : wake_(std::move(wake)), scripted_(!options.interact.empty() || options.frames), windowed_(!options.headless) {
  if (options.is_live()) begin();
}

void Stopper::begin() {
  if (interrupt_) return;
  relay_.emplace();  // first, so that what the log needs is still there within exit()
  silence_at_exits();
  interrupt_.emplace("ended without finishing, one second after the signal: a link, device or file did not answer",
                     wake_);
}

void Stopper::end(App& app) {
  constexpr const char* too_early = "ended while the run was loading, before anything was shown; give it more time";
  constexpr double patience_s = 3;
  const bool loading = app.loading();
  const bool cut = loading && scripted_ && !setup::Interrupt::signalled();
  const bool over = app.finish(patience_s);
  const auto rethrow = [&] {
    if (app.session()) app.session()->rethrow();
  };
  if (over && cut) throw failure(too_early);
  // After a signal, there is one second for everything, but releasing a window's device may take longer.
  const bool at_once = over && windowed_ && setup::Interrupt::signalled();
  if (over && !at_once) return rethrow();
  // The watch for signals may have decided first; then it has printed its line.
  const auto fails = [](Exit code, const char* line) {
    if (setup::decide_ending(code)) setup::tell_ending(line);
  };
  if (cut) {
    fails(Exit::failed, too_early);
  } else if (!loading && !over) {
    fails(Exit::failed, "ended without finishing: a link, device or file did not answer");
  } else if (at_once) {
    try {
      rethrow();
    } catch (const Error& error) {
      fails(error.code(), error.what());
    }
  }
  setup::decide_good_ending();
  relay_.reset();
  ::_exit(static_cast<int>(setup::ending()));
}

}  // namespace palpa::viewer
