// A run that begins anew writes beside what the one before it has written, not over it.
#pragma once

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "session/links/link.hpp"
#include "setup/live_run.hpp"

namespace palpa::viewer {

class NextOutputs {
 public:
  /// The outputs of a run that is about to begin: where an earlier one of this program has written something under the
  /// same name, it gets the first free one of "take-2.csv", "take-3.csv", ... Streams, devices and pipes go on as they
  /// are. A line for each name that changed. `links` are all there are.
  std::vector<std::string> name(setup::LiveOptions& options, std::span<const session::LinkKind> links);

 private:
  std::set<std::filesystem::path> begun_;
};

}  // namespace palpa::viewer
