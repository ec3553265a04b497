// The viewer's command line, and what becomes of it where no window is asked for.
#pragma once

#include <optional>

#include "viewer/app/viewer_options.hpp"
#include "viewer/live/live_session.hpp"

namespace palpa::viewer {

/// What the line says, checked: the log and what files may name are as it has them from now on. Nothing where it asks
/// for help or for the version, which are printed. Throws bad_usage.
std::optional<ViewerOptions> read_line(int argc, const char* const* argv);

/// A picture, pictures of a live run, or what a script asks for; see run.hpp.
void run_without_window(const ViewerOptions& options, const LiveSession::Kinds& kinds);

}  // namespace palpa::viewer
