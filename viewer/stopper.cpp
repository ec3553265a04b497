#include "viewer/stopper.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>
#include <utility>

#include "base/error.hpp"

namespace palpa::viewer {
namespace {

using namespace std::chrono_literals;

/// Within exit(): the threads of a run that is under way must neither sound on nor meet what exit() takes down.
void silence_at_exit() {
  if (!LiveSession::under_way()) return;
  setup::Interrupt::flag() = true;
  const auto until = std::chrono::steady_clock::now() + 1s;
  while (LiveSession::under_way() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(5ms);
  ::_exit(static_cast<int>(Exit::failed));
}

}  // namespace

Stopper::Stopper(const ViewerOptions& options) {
  if (!options.is_live()) return;
  [[maybe_unused]] static const int registered = std::atexit(silence_at_exit);
  relay_.emplace();
  interrupt_.emplace("ended without finishing, a second after the signal: what it waited for did not answer");
}

void Stopper::end(App& app) {
  constexpr double patience_s = 3;
  if (app.finish(patience_s)) return;
  const bool loading = app.desk().live_state == LiveState::loading;
  if (!loading) log::error("ended without finishing: what the run waited for did not answer; the array is silent");
  relay_.reset();
  ::_exit(static_cast<int>(loading ? Exit::ok : Exit::failed));
}

}  // namespace palpa::viewer
