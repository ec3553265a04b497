// The viewer's command line, and runs without a window.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {

/// Parses a line of palpa-viewer with these options, and applies its log level to this process. Prints the version, or
/// the page of `help`, and returns false if the line asks for it. Throws bad_usage.
bool parse_line(CLI::App& app, const setup::CommonOptions& common, int argc, const char* const* argv,
                const std::function<std::string()>& help);

/// Reads and checks the command line, and applies its log level and --allow-outside to this process. Prints the help or
/// the version and returns nothing if the line asks for it. Throws bad_usage.
std::optional<ViewerOptions> read_line(int argc, const char* const* argv);

/// Draws a picture, draws pictures of a live run, or does what a script says; see run.hpp.
void run_without_window(const ViewerOptions& options, const LiveSession::Kinds& kinds);

}  // namespace palpa::viewer
