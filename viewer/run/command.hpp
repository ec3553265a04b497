// The viewer's command line, and runs without a window.
#pragma once

#include <optional>

#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// Reads and checks the command line, and applies its log level and --allow-outside to this process. Prints the help or
/// the version and returns nothing if the line asks for it. Throws bad_usage.
std::optional<ViewerOptions> read_line(int argc, const char* const* argv);

/// Draws a picture, draws pictures of a live run, or does what a script says; see run.hpp.
void run_without_window(const ViewerOptions& options, const LiveSession::Kinds& kinds);

}  // namespace palpa::viewer
