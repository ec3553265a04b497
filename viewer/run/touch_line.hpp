// The command line of `palpa-viewer --by-touch`.
#pragma once

#include <optional>
#include <string>

#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

struct TouchLine {
  ViewerOptions options;
  std::string out, json;
};

bool asks_for_touches(int argc, const char* const* argv);
/// nullopt for --help and --version. Throws bad_usage.
std::optional<TouchLine> read_touch_line(int argc, const char* const* argv);

/// Plays the foci that a person touches, in a window or with a script, and writes the rig with the cameras' poses.
/// `show` is run_window or run_scripted.
void run_by_touch(TouchLine line, LiveSession::Kinds kinds,
                  void (*show)(const ViewerOptions&, const LiveSession::Kinds&, TouchGuide*));

}  // namespace palpa::viewer
