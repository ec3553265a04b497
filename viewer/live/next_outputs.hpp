// A run that restarts writes new files beside those of the run before and does not overwrite them.
#pragma once

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "session/links/link.hpp"
#include "setup/sessions/live_run.hpp"

namespace palpa::viewer {

class NextOutputs {
 public:
  /// Names the outputs of a run that is about to begin. If an earlier run of this program has written something under
  /// the same name, the output gets the first free name of "take-2.csv", "take-3.csv", ... Streams, devices and pipes
  /// keep their names. Returns a line for each name that changed. `links`: all kinds of links.
  std::vector<std::string> name(setup::LiveOptions& options, std::span<const session::LinkKind> links);

 private:
  std::set<std::filesystem::path> begun_;
};

}  // namespace palpa::viewer
