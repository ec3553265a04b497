// The options of `palpa run` as the viewer takes, shows and changes them.
#pragma once

#include <string>
#include <vector>

#include "setup/live_run.hpp"
#include "setup/option_table.hpp"

namespace palpa::viewer {

/// All of them that say what runs, in the order of `palpa run --help`.
const std::vector<setup::OptionInfo>& live_table();
/// The others: how long the command goes on, and what it tells. A viewer, which goes on until it is closed and has
/// panels, only copies them.
const std::vector<setup::OptionInfo>& told_table();

/// Throws bad_usage for what cannot be.
setup::LiveOptions live_options(const setup::Given& given);
/// The same for those of told_table().
void check_told(const setup::Given& told);

/// The command that runs the same without a window, and goes on and tells as `told` says.
std::string run_command(const setup::Given& given, const setup::Given& told = {});

}  // namespace palpa::viewer
