// The viewer's command line for a study: palpa-viewer --study PLAN. It has options of its own.
#pragma once

#include <optional>

#include "setup/options/study_options.hpp"

namespace palpa::viewer {

/// Whether the line has --study.
bool asks_for_study(int argc, const char* const* argv);
/// Reads and checks the line, and applies its log level to this process. Prints the help and returns nothing if the
/// line asks for it. Throws bad_usage.
std::optional<setup::StudyRunOptions> read_study_line(int argc, const char* const* argv);

}  // namespace palpa::viewer
