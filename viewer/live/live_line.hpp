// The options of `palpa run` as the viewer takes, shows and changes them.
#pragma once

#include <string>
#include <vector>

#include "setup/live_run.hpp"
#include "setup/option_table.hpp"

namespace palpa::viewer {

/// All of them that say what runs, in the order of `palpa run --help`: not what a terminal is told of it.
const std::vector<setup::OptionInfo>& live_table();

/// Throws bad_usage for what cannot be.
setup::LiveOptions live_options(const setup::Given& given);

/// The command that runs the same without a window.
std::string run_command(const setup::Given& given);

}  // namespace palpa::viewer
