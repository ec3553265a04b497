#include "viewer/stopper.hpp"

#include <unistd.h>

#include <utility>

#include "base/error.hpp"

namespace palpa::viewer {

Stopper::Stopper(const ViewerOptions& options) {
  if (!options.is_live()) return;
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
